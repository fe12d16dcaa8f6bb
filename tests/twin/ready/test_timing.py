"""Commands whose timing the file does not say: which is read, and what a delay is then worth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import UP_TO_TWO, a_record
from twin.diagnose import diagnose
from twin.diagnosis import Cause, Estimate
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.noise.model import estimate_noise
from twin.ready.timing import Slack, settled_timing
from twin.replay.simulate import simulate_recording

PLAIN = Plant(DesignModel())
LATE = Plant(DesignModel(), (Inserted("dead_time", effect("dead_time").form("pure_delay"), (0.6,)),))


def told_after(record: Recording) -> Recording:
    """The same record as a file has it whose commands take effect after their rows."""
    return replace(record, command=np.append(record.command[1:], record.command[-1]))


def unevenly(plant: Plant, n: int = 1500) -> Recording:
    """A record whose rows come 0.2 s apart, give or take."""
    dice = np.random.default_rng(3)
    even = a_record(plant, n=n)
    blank = replace(even, time_s=even.time_s + dice.uniform(-0.03, 0.03, n))
    pressure, position = simulate_recording(plant, blank)
    return replace(
        blank, pressure=pressure + dice.normal(0.0, 0.008, n), position=position + dice.normal(0.0, 0.0004, n)
    )


def settled(record: Recording) -> tuple[Recording, str, Slack]:
    unknown = replace(record, command_timing="unknown")
    [found], [note], slack = settled_timing([unknown], PLAIN, estimate_noise([unknown]))
    return found, note.handled, slack


@pytest.mark.parametrize("record", [a_record(PLAIN), unevenly(PLAIN), unevenly(LATE)], ids=["even", "uneven", "late"])
def test_each_timing_is_recognised_though_a_delay_looks_like_another_row(record: Recording) -> None:
    found, said, slack = settled(record)
    assert found.command_timing == "before"
    assert np.array_equal(found.command, record.command)
    assert "read as in force before its row" in said
    assert (slack.shorter_s, slack.longer_s) == pytest.approx((0.2, 0.0), abs=0.01)
    found, said, slack = settled(told_after(record))
    assert np.array_equal(found.command[1:-1], record.command[1:-1])
    assert "read as in force after its row" in said and "a delay holds one 0.2 s longer" in said
    assert (slack.shorter_s, slack.longer_s) == pytest.approx((0.0, 0.2), abs=0.01)


def test_what_is_known_is_left_alone() -> None:
    record = a_record(PLAIN, n=200)
    assert settled_timing([record], PLAIN, estimate_noise([record])) == ([record], [], Slack())


def test_the_interval_of_a_delay_holds_the_row_and_no_other_does() -> None:
    size = {"delay": Estimate(0.05, (0.04, 0.06), "s"), "spread": Estimate(0.1, (0.0, 0.2), "1")}
    causes = (Cause("dead_time", "ep", 0.9, None, size), Cause("sensor_lag", "sensor", 0.9, None, size))
    wide, other = Slack(shorter_s=0.1, longer_s=0.2).loosened(causes)
    assert wide.parameters["delay"].ci95 == pytest.approx((0.0, 0.26))
    assert wide.parameters["spread"] == size["spread"]
    assert other == causes[1]


@pytest.mark.thorough
@pytest.mark.parametrize("after", [False, True])
def test_a_delay_that_a_row_may_be_part_of_is_named_with_that_interval(after: bool) -> None:
    record = replace(told_after(a_record(LATE)) if after else a_record(LATE), command_timing="unknown")
    found = diagnose([record], DesignModel(), settings=UP_TO_TWO).diagnosis
    [cause] = found.causes
    low95, high95 = cause.parameters["delay"].ci95
    assert cause.name == "dead_time"
    assert low95 < 0.6 < high95
    assert high95 - low95 > 0.2
    assert any("command timing unknown" in note.what for note in found.data_quality)
