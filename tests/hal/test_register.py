from __future__ import annotations

import math

import pytest
from pydantic import ValidationError

from hal.register import Register, Transmitter


def test_counts_to_quantity_along_the_line() -> None:
    register = Register(address=1, raw=(0, 65535), eng=(-10, 10), unit="V")
    assert register.value(0) == pytest.approx(-10)
    assert register.value(65535) == pytest.approx(10)
    # Reported as checked on an ADAM-4017P: counts 34341 are 0.4803 V on +-10 V.
    assert register.value(34341) == pytest.approx(0.4803, abs=1e-3)


def test_a_transmitter_stands_between_terminal_and_quantity() -> None:
    register = Register(
        address=1, raw=(0, 4095), eng=(4, 20), transmitter=Transmitter(signal=(4, 20), value=(3, 15)), unit="psi"
    )
    assert register.value(0) == pytest.approx(3)
    assert register.value(4095) == pytest.approx(15)
    assert register.to_words(9.0, "ABCD") == (2048,)
    assert register.resolution() == pytest.approx(12 / 4095)


def test_the_registers_own_word_order_goes_before_the_devices() -> None:
    register = Register(address=1, type="f32", word_order="CDAB")
    assert register.to_words(123456.0, "ABCD") == (0x2000, 0x47F1)
    assert register.counts((0x2000, 0x47F1), "ABCD") == 123456.0


def test_sentinels_and_nan_mean_no_value() -> None:
    register = Register(address=1, sentinels=(0xFFFF,))
    assert register.is_sentinel(65535)
    assert not register.is_sentinel(65534)
    assert Register(address=1, type="f32").is_sentinel(math.nan)


def test_the_ends_of_the_converter_hide_what_lies_beyond() -> None:
    register = Register(address=1, type="i16")
    assert register.is_saturated(-32768)
    assert register.is_saturated(32767)
    assert not register.is_saturated(32766)
    assert not Register(address=1, type="f32").is_saturated(math.inf)


@pytest.mark.parametrize(
    ("bad", "sentence"),
    [
        ({"raw": (5, 5), "eng": (0, 1)}, "impossible scale"),
        ({"raw": (0, 1), "eng": (2, 2)}, "impossible scale"),
        ({"raw": (0, 1)}, "belong together"),
        ({"raw": (0, 65536), "eng": (0, 1)}, "does not fit into u16"),
        ({"raw": (-1, 5), "eng": (0, 1)}, "does not fit into u16"),
        ({"raw": (0, math.inf), "eng": (0, 1), "type": "f32"}, "must be finite"),
        ({"plausible": (2, 1)}, "must be \\[low, high\\]"),
        ({"typo": 1}, "typo"),
    ],
)
def test_impossible_registers_are_refused(bad, sentence) -> None:
    with pytest.raises(ValidationError, match=sentence):
        Register.model_validate({"address": 1, **bad})
