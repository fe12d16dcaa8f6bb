"""When it pays to stay awake."""

from __future__ import annotations

import pytest

from hal import vigil as watch
from hal.vigil import Vigil


def test_what_comes_is_found_and_the_next_vigil_is_kept_too() -> None:
    vigil, answers = Vigil(), iter([b"", b"", b"one", b"two"])
    assert vigil.keep(lambda: next(answers)) == b"one"
    assert vigil.keep(lambda: next(answers)) == b"two"


def test_vigils_in_vain_become_rare_and_one_that_pays_brings_them_back() -> None:
    vigil = Vigil()

    def kept(times: int, found: bytes) -> list[int]:
        looked: list[int] = []
        for number in range(times):
            vigil.keep(lambda number=number: looked.append(number) or found)
        return sorted(set(looked))

    assert kept(20, b"") == [0, 2, 5, 10, 19]
    assert len(kept(10_000, b"")) < 50
    assert len(kept(300, b"x")) > 40
    assert kept(5, b"x") == [0, 1, 2, 3, 4]


def test_each_look_in_vain_gives_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker of the kernel carries the bytes, and needs the processor for it."""
    happened: list[str] = []
    monkeypatch.setattr(watch, "_give_way", lambda: happened.append("way"))
    answers = iter([b"", b"", b"one"])

    def look() -> bytes:
        happened.append("look")
        return next(answers)

    assert Vigil().keep(look) == b"one"
    assert happened == ["look", "way", "look", "way", "look"]
