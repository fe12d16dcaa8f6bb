"""The monitor is silent beside a valve that is its model, and speaks when the valve leaves it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from control.design import DesignModel
from hal.sample import Quality
from logs.recording import FloatArray, Recording
from twin.live.monitor import Monitor, Seen
from twin.live.sink import COLUMNS, TwinSink
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.replay.simulate import Start, simulate_recording

SIGMA = 0.0006


def record() -> Recording:
    """Strokes of all sizes for 5 minutes at 10 Hz from an open valve at rest."""
    time_s = 0.1 * np.arange(3000)
    levels = np.repeat(np.random.default_rng(7).uniform(4.0, 13.0, 30), 100)
    levels[:100] = 4.0
    return Recording("strokes", time_s, levels, np.zeros(3000))


def readings(plant: Plant) -> FloatArray:
    """What a valve that is `plant` reads on the record, with noise."""
    _, y = simulate_recording(plant, record(), start=Start(4.0, 0.0, 0.0))
    return y + SIGMA * np.random.default_rng(1).standard_normal(y.size)


def rows(position: FloatArray) -> list[dict[str, float]]:
    source = record()
    return [
        {"time_s": t, "command_psi": u, "position_in": y}
        for t, u, y in zip(source.time_s.tolist(), source.command.tolist(), position.tolist(), strict=True)
    ]


def watch(position: FloatArray) -> tuple[Monitor, list[Seen]]:
    monitor = Monitor(Plant(DesignModel()), "psi", 300.0)
    return monitor, [monitor.see(row) for row in rows(position)]


def test_is_silent_beside_its_own_model() -> None:
    monitor, seen = watch(readings(Plant(DesignModel())))
    residuals = np.array([one.residual for one in seen])
    assert np.std(residuals) == pytest.approx(SIGMA, rel=0.05)
    assert monitor.alarms == 0
    assert not any(one.say for one in seen)
    assert math.isnan(seen[0].statistic)
    assert math.isfinite(seen[-1].statistic)


def test_a_model_with_held_readings_waits_for_the_valves() -> None:
    position = readings(Plant(DesignModel()))
    held = position[np.arange(position.size) // 7 * 7]
    as_seen = Inserted("stale_samples", effect("stale_samples").form("as_seen"), ())
    spread = []
    for plant in (Plant(DesignModel()), Plant(DesignModel(), (as_seen,))):
        monitor = Monitor(plant, "psi", 300.0)
        spread.append(np.std([monitor.see(row).residual for row in rows(held)]))
    assert spread[0] > 5.0 * SIGMA
    assert spread[1] == pytest.approx(SIGMA, rel=0.15)


def test_says_when_and_where_a_sensor_has_slipped() -> None:
    position = readings(Plant(DesignModel()))
    position[1500:] += 0.03 * 0.5625
    monitor, seen = watch(position)
    first = next(k for k, one in enumerate(seen) if one.say)
    assert 150.0 < 0.1 * first < 155.0
    assert "above" in seen[first].say
    assert "150 s" in seen[first].say
    assert monitor.alarmed
    assert seen[first].statistic >= 1.0


def test_takes_the_alarm_back_when_the_valve_is_back() -> None:
    position = readings(Plant(DesignModel()))
    position[1500:1800] -= 0.03 * 0.5625
    monitor, seen = watch(position)
    said = [one.say for one in seen if one.say]
    assert [("below" in said[0]), ("back" in said[1]), len(said)] == [True, True, 2]
    assert not monitor.alarmed


def test_notices_a_valve_that_sticks() -> None:
    form = effect("stiction").forms[0]
    monitor, _ = watch(readings(Plant(DesignModel(), (Inserted("stiction", form, (0.6, 2e-3)),))))
    assert monitor.alarms >= 1


def test_leaves_out_readings_that_cannot_be_used() -> None:
    monitor = Monitor(Plant(DesignModel()), "psi", 300.0)
    first, *rest = rows(readings(Plant(DesignModel())))
    assert math.isnan(monitor.see({**first, "quality": float(Quality.MISSING)}).position)
    for row in rest[:400]:
        monitor.see(row)
    bad = monitor.see({**rest[400], "position_in": 5.0, "quality": float(Quality.IMPLAUSIBLE)})
    assert math.isnan(bad.residual)
    assert math.isfinite(bad.position)


def test_sink_adds_its_columns_and_passes_the_warning_on() -> None:
    position = readings(Plant(DesignModel()))
    position[1500:] += 0.03 * 0.5625
    kept, said = Kept(), list[str]()
    sink = TwinSink(Monitor(Plant(DesignModel()), "psi", 300.0), (kept,), said.append)
    for row in rows(position)[:1700]:
        sink.append(row)
    sink.note(1.0, "a note")
    sink.state(1.0, "running")
    assert set(COLUMNS) <= set(kept.rows[-1])
    assert kept.rows[-1]["twin_residual_in"] == pytest.approx(0.03 * 0.5625, abs=5 * SIGMA)
    assert len(said) == 1
    assert ("warning", said[0]) in kept.words
    assert ("note", "a note") in kept.words
    assert ("state", "running") in kept.words


class Kept:
    """A sink that keeps everything."""

    def __init__(self) -> None:
        self.rows: list[dict[str, float]] = []
        self.words: list[tuple[str, str]] = []

    def append(self, row: object) -> None:
        assert isinstance(row, dict)
        self.rows.append(row)

    def event(self, time_s: float | None, level: str, text: str) -> None:
        self.words.append((level, text))

    def note(self, time_s: float | None, text: str) -> None:
        self.words.append(("note", text))

    def state(self, time_s: float | None, text: str) -> None:
        self.words.append(("state", text))
