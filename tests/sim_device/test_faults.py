"""Faults of the wire, as words."""

from __future__ import annotations

import pytest

from hal.errors import BadInput
from sim_device.faults import WireFaults, parse_faults


def test_words_of_the_command_line() -> None:
    faults = parse_faults(
        ("late=0.05:0.9-3.5", "bit-flip=0.03", "exception=0.01:4x20", "local-echo"), seed=3, timeout_s=0.2
    )
    assert faults == WireFaults(
        late=0.05, bit_flip=0.03, exception=0.01, exception_code=4, exception_burst=20, local_echo=True, seed=3,
        timeout_s=0.2,
    )  # fmt: skip


@pytest.mark.parametrize("word", ["rain=0.1", "late", "late=x", "drop=0.1:3", "late=0.1:3", "seed=4", "drop=1.5"])
def test_words_that_cannot_be_understood_are_named(word: str) -> None:
    with pytest.raises(BadInput, match=word.partition("=")[0]):
        parse_faults((word,))
