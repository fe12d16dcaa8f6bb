"""Where the valve is at the end, in words: safe, left, or unknown."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hal.bench_info import info_of
from hal.errors import BenchFault
from hal.profile import load_profile
from hal.whereabouts import whereabouts
from tests.hal.safety_rig import Rig

INFO = info_of(load_profile("virtual"))
HELD = replace(INFO, profile={**INFO.profile, "safe_direction": "hold"})


@pytest.mark.parametrize(
    ("info", "safe", "sent", "words"),
    [
        (INFO, True, 9.0, "the valve is at its safe command"),
        (INFO, False, 9.0, "the valve did NOT confirm its safe command, last sent 9 psi"),
        (INFO, False, None, "the valve did NOT confirm its safe command, nothing was sent to it"),
        (HELD, True, 8.25, "the valve is left where it is, last sent 8.25 psi"),
    ],
)
def test_words(info, safe, sent, words) -> None:
    assert whereabouts(info, safe, sent) == words


def test_a_safe_bench_knows_what_it_sent_last_and_how_it_was_left() -> None:
    rig = Rig(confirms_safe=False)
    with pytest.raises(BenchFault) as caught, rig.safe:
        rig.tick(7.0)
        rig.safe.exchange(float("nan"))
    said = (
        "is at fault; the valve did NOT confirm its safe command, last sent 7 psi. Shut off its supply and look at it"
    )
    assert str(caught.value).endswith(said)
    assert str(caught.value).count("did NOT confirm") == 1
    assert rig.safe.where == "the valve did NOT confirm its safe command, last sent 7 psi"
    good = Rig()
    with good.safe:
        good.tick(7.0)
    assert (good.safe.sent, good.safe.where) == (7.0, "the valve is at its safe command")
