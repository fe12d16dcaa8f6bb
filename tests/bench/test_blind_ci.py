"""The frozen trials fail when fewer are right, or more healthy valves are accused, than the limits file allows."""

from __future__ import annotations

import tomllib

from app.blind.score import score
from bench.blind_ci import MORE, SLACK, counts, worse, written
from tests.app.blind.lines import some_lines


def test_what_was_measured_passes_its_own_limits() -> None:
    found = counts(score(some_lines()))
    assert found["least"]["right"] == 3 and found["most"] == {"false_cause_on_none": 1, "broken": 1}
    assert worse(found, tomllib.loads(written(found))) == []


def test_what_is_worse_by_more_than_the_slack_is_said() -> None:
    found = counts(score(some_lines()))
    limits = tomllib.loads(written(found))
    fewer = {"least": found["least"] | {"right": limits["least"]["right"] - 1}, "most": found["most"]}
    assert worse(fewer, limits) == [f"right: {3 - SLACK - 1}, at least {3 - SLACK}"]
    more = {"least": found["least"], "most": found["most"] | {"broken": 1 + MORE + 1}}
    assert worse(more, limits) == [f"broken: {2 + MORE}, at most {1 + MORE}"]
