"""What a record must be before it is diagnosed: long enough, in motion, the right columns, units and direction.

A record that fails here is refused with one sentence: no verdict would be honest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from control.design import DesignModel
from control.sparse_rows import refuse_sparse_motion
from hal.errors import BadInput
from logs.recording import DataNote, FloatArray, Recording
from logs.spoken import of_its_file
from twin.model.plant import Plant
from twin.noise.model import NoiseModel
from twin.replay.simulate import simulate_recording

#: Fewer readings, or a shorter time in lags of the valve, say nothing.
LEAST_ROWS = 50
LEAST_LAGS = 4.0
SHORT_S = 60.0
#: Rows further apart than so many times what the valve takes for anything show it at rest only; a slow log is forgiven.
_MOST_STROKES = 10.0
_FORGIVEN_S = 30.0
#: A stem that stays within so many sigmas of its noise has not moved; one predicted to do so by this share has.
STILL_SIGMAS = 8.0
PREDICTED = 0.1
#: Readings or commands this far from anything the design knows are of another column or unit.
_ABSURD = 3.0
#: Of the travel: what goes over less than that may be one from another zero.
_ABOUT = 1.2
_CONTRARY = -0.5
_STEP_S = 0.1
_PARTS = 64


@dataclass(frozen=True, slots=True)
class _Motion:
    """How far the readings go, how far the design says they should, whether the two go together (-1..1), and the
    design's stem, shape (n,)."""

    reading: float
    predicted: float
    together: float
    model: FloatArray


def admit(recordings: Sequence[Recording], plant: Plant, noise: NoiseModel) -> list[DataNote]:
    """Notes on what limits the answer. `plant` is the design, in the recordings' units.

    Raises: `BadInput` when the recordings cannot carry a diagnosis against this design.
    """
    names = ", ".join(r.name for r in recordings[:3]) + (", ..." if len(recordings) > 3 else "")
    notes = _long_enough(recordings, plant, names)
    _refuse_sparse(recordings, plant)
    _refuse_undriven(recordings, plant)
    motions = [_motion(r, plant) for r in recordings]
    still = max(m.reading for m in motions) <= STILL_SIGMAS * noise.position.sigma
    if still:
        _refuse_still(recordings, motions, plant, names)
    else:
        _refuse_absurd(recordings, plant, names)
    largest = max(motions, key=lambda m: m.predicted)
    if not still and largest.predicted > PREDICTED * plant.design.travel and largest.together < _CONTRARY:
        file, unit = of_its_file(recordings[0]), plant.design.position_unit
        travel, unit = file.value(plant.design.travel, unit), file.unit(unit)
        raise BadInput(
            f"{names}: the position falls as the command rises, but 0 must be the open end; turn it round, "
            f"as in --units 'position={unit}(0..{travel:.6g}={travel:.6g}..0 {unit})'"
        )
    return notes


def _long_enough(recordings: Sequence[Recording], plant: Plant, names: str) -> list[DataNote]:
    if not recordings:
        raise BadInput("no recording to diagnose; name at least one run or file")
    rows = sum(int(np.isfinite(r.position).sum()) for r in recordings)
    duration_s = sum(r.duration_s for r in recordings)
    least_s = LEAST_LAGS * (plant.design.tau_s + plant.design.ep_tau_s)
    if rows < LEAST_ROWS:
        raise BadInput(f"{names}: {rows} readings of the position are too few to diagnose; at least {LEAST_ROWS}")
    if duration_s < least_s:
        raise BadInput(
            f"{names}: {duration_s:.3g} s are too short to diagnose a valve with a lag of {plant.design.tau_s:.3g} s; "
            f"at least {least_s:.3g} s"
        )
    if duration_s >= SHORT_S:
        return []
    what = f"the record is short: {duration_s:.3g} s"
    return [DataNote(what, "only large effects can show: see what was testable, with its detection limits", rows)]


def _refuse_sparse(recordings: Sequence[Recording], plant: Plant) -> None:
    """Rows so far apart that no motion lies between two of them: nothing could be told, and simulating takes ages."""
    d = plant.design
    stroke_s = d.ep_tau_s + d.tau_s + d.travel / d.rate_limit
    most_s = max(_MOST_STROKES * stroke_s, _FORGIVEN_S)
    for one in recordings:
        if one.period_s > most_s:
            raise BadInput(
                f"{one.name}: a row every {one.period_s:.4g} s shows nothing of a valve that is through with a stroke "
                f"within {stroke_s:.3g} s; at most {most_s:.3g} s: check the unit of the time (--units time=ms), or "
                "record more often"
            )


def _motion(recording: Recording, plant: Plant) -> _Motion:
    predicted = simulate_recording(plant, recording, max(_STEP_S, recording.duration_s / 1e6))[1]
    seen = np.isfinite(recording.position)
    reading, model = recording.position[seen], predicted[seen]
    if reading.size < 3:
        return _Motion(0.0, _reach(predicted), 0.0, predicted)
    together = float(np.corrcoef(reading, model)[0, 1]) if np.ptp(reading) > 0.0 and np.ptp(model) > 0.0 else 0.0
    return _Motion(_reach(reading), _reach(model), together, predicted)


def _reach(values: FloatArray) -> float:
    low, high = np.percentile(values, (1.0, 99.0))
    return float(high - low)


def _refuse_still(recordings: Sequence[Recording], motions: Sequence[_Motion], plant: Plant, names: str) -> None:
    if max(float(np.ptp(r.command)) for r in recordings) <= 0.0:
        raise BadInput(
            f"{names}: nothing moves, neither command nor position, so nothing can be said of the valve; record a "
            "sweep, for example `lostmotion sweep nested`"
        )
    expected = max(m.predicted for m in motions)
    if expected > PREDICTED * plant.design.travel:
        for one, motion in zip(recordings, motions, strict=True):
            if motion.reading > PREDICTED * plant.design.travel:
                refuse_sparse_motion(one, motion.model)
        share = 100.0 * expected / plant.design.travel
        raise BadInput(
            f"{names}: the position never leaves its noise while the command should move it by {share:.0f} % of "
            "travel; the stem is stuck, the position sensor is not read, or --map names the wrong column"
        )


def _refuse_undriven(recordings: Sequence[Recording], plant: Plant) -> None:
    """A stem that comes and goes while it is told one thing: none of the effects does that, so none could be tested."""
    travel = plant.design.travel
    for one in recordings:
        share = _to_and_fro(one.position[np.isfinite(one.position)]) / travel
        if float(np.ptp(one.command)) <= 0.0 and share > PREDICTED:
            raise BadInput(
                f"{one.name}: the command never changes while the stem goes to and fro over {100.0 * share:.0f} % of "
                "travel, so what moved it is not in the record; check the column (--map command=...), or record a sweep"
            )


def _to_and_fro(reading: FloatArray) -> float:
    """How far the reading goes both up and down again, in medians of parts of the record: false readings are none, nor
    is a quick swing, which has an answer of its own."""
    parts = np.array([np.median(part) for part in np.array_split(reading, _PARTS) if part.size])
    if parts.size == 0:
        return 0.0
    rise = np.max(parts - np.minimum.accumulate(parts))
    return float(min(rise, np.max(np.maximum.accumulate(parts) - parts)))


def _refuse_absurd(recordings: Sequence[Recording], plant: Plant, names: str) -> None:
    """Readings many travels away, or commands many spans beyond the curves: a wrong column or unit."""
    d = plant.design
    readings = np.concatenate([r.position[np.isfinite(r.position)] for r in recordings])
    x, p = (d.spoken.unit(unit) for unit in (d.position_unit, d.pressure_unit))
    low, middle, high = np.percentile(readings, (5.0, 50.0, 95.0))
    if high - low > _ABSURD * d.travel or abs(middle) > _ABSURD * d.travel:
        low, high, travel = (d.spoken.value(float(v), d.position_unit) for v in (low, high, d.travel))
        raise BadInput(
            f"{names}: positions of {low:.3g} to {high:.3g} {x} do not belong to a travel of {travel:.3g} {x}; check "
            f"the column (--map position=...), its unit (--units position=mm) and the design{_zero_hint(recordings, d)}"
        )
    closed = d.a1 + d.travel / d.compliance
    low, middle, high = np.percentile(np.concatenate([r.command for r in recordings]), (5.0, 50.0, 95.0))
    if middle > _ABSURD * closed > 0.0 or high < d.a2 / _ABSURD:
        low, high, opens, closed = (d.spoken.value(v, d.pressure_unit) for v in (low, high, d.a2, closed))
        raise BadInput(
            f"{names}: commands of {low:.3g} to {high:.3g} {p} do not belong to curves between {opens:.3g} and "
            f"{closed:.3g} {p}; check the column (--map command=...), its unit (--units command=kPa) and the design"
        )


def _zero_hint(recordings: Sequence[Recording], design: DesignModel) -> str:
    """How to take off another zero, where the positions go over no more than a travel."""
    low, high = np.nanpercentile(np.concatenate([r.position for r in recordings]), (0.5, 99.5))
    if high - low > _ABOUT * design.travel:
        return ""
    file, ours = of_its_file(recordings[0]), design.position_unit
    zero, full, travel = (file.value(float(v), ours) for v in (low, low + design.travel, design.travel))
    unit = file.unit(ours)
    return (
        f"; if it is their zero that is elsewhere, take that off, as in --units 'position={unit}({zero:.4g}.."
        f"{full:.4g}=0..{travel:.4g} {unit})'"
    )
