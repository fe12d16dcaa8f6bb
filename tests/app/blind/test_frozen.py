"""A few sealed valves, through the wire and back: a diagnosis that gets worse fails here.

They were chosen by their labels, large and one of each sort, so that they say nothing about the hit rate; that is what
`lostmotion blind` is for. The records are short and unrepeated to keep the suite quick.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from app.blind.trial import Order, run_trial

VALVES = {8: "thesis", 9: "thesis", 17: "thesis", 21: "thesis", 23: "reference", 38: "thesis"}
RIGHT = 5  # of the six; all six when this was written


@pytest.fixture(scope="module")
def lines(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    folder: Path = tmp_path_factory.mktemp("frozen")
    return [
        run_trial(Order(number, f"frozen-{number}", family, folder / str(number), share=0.5, repeats=1))
        for number, family in VALVES.items()
    ]


@pytest.mark.thorough
def test_the_frozen_valves_are_diagnosed(lines: list[dict[str, Any]]) -> None:
    answers = {line["trial"]: (line["label"]["kind"], line["verdict"], line["causes"]) for line in lines}
    assert {kind for kind, _, _ in answers.values()} == {"none", "effect", "parameter"}  # the draw has not changed
    assert sum(line["mark"]["right"] for line in lines) >= RIGHT, answers
    assert not any(line["causes"] for line in lines if line["label"]["kind"] == "none"), answers
    closed = [line["closed_loop"]["closed"] for line in lines if line["mark"]["right"] and line["label"]["causes"]]
    assert sorted(closed)[len(closed) // 2] > 0.8, closed
