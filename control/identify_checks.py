"""What a record must be, and what must be found in it, for numbers to be identified; else one sentence says why not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from control.design import DesignModel
from control.identify_readings import fast_noise
from control.identify_result import Estimate
from control.identify_track import ROUGH_S, Track
from control.identify_tracks import FEWEST_ROWS
from control.sparse_rows import refuse_sparse_motion
from hal.errors import BadInput, JobFailed
from logs.recording import FloatArray, Recording
from logs.spoken import of_its_file
from logs.units import PERCENT

LEAST_S = 10.0 * ROUGH_S  # a record that is over sooner has no time for a first guess
SLOW_S = 600.0  # for a stroke; the slowest actuators of large valves take some minutes
FALLS = -0.3  # correlation of position and pressure below which the position is the wrong way round
ONE_TO_ONE = 2.0  # percent: a stem that goes where it is told within this is told positions
_POSITIONER = (
    "positions for a positioner, whose pressure is its own affair: "
    "a1, a2 and the lags of the valve do not show; identify from a record whose commands are pressures"
)


def check_records(recordings: Sequence[Recording]) -> None:
    """Raises: `BadInput` when they are in different units, too short, or nothing moves."""
    if not recordings:
        raise BadInput("no recording to identify from; name at least one run or file")
    first = recordings[0]
    for each in recordings:
        if each.meta.get("positioner"):
            raise BadInput(f"{each.name}: its commands are {_POSITIONER}")
        if (each.pressure_unit, each.position_unit) != (first.pressure_unit, first.position_unit):
            raise BadInput(
                f"{each.name} has [{each.pressure_unit}, {each.position_unit}], {first.name} "
                f"[{first.pressure_unit}, {first.position_unit}]; bring them to the same units with --units"
            )
        if each.n < FEWEST_ROWS:
            raise BadInput(f"{each.name}: {each.n} rows are too few to identify anything; at least {FEWEST_ROWS}")
    if max(float(np.ptp(each.command)) for each in recordings) <= 0.0:
        raise BadInput(
            f"{first.name}: the command never changes; record a sweep, for example `lostmotion sweep staircase`"
        )
    moved = max(float(np.ptp(np.nanpercentile(each.position, (1, 99)))) for each in recordings)
    if moved <= 8.0 * max(fast_noise(each.position) for each in recordings):
        for each in recordings:
            refuse_sparse_motion(each, each.command)
        raise BadInput(
            f"{first.name}: the position never leaves its noise; identifying takes a record that moves over both curves"
        )


def check_motion(tracks: Sequence[Track], recordings: Sequence[Recording]) -> None:
    """Of the tracks, since a stretch that was left out may be the one that moved. Raises: `BadInput`."""
    first = recordings[0]
    longest_s = max(float(np.ptp(track.grid.time_s)) for track in tracks)
    if longest_s < LEAST_S:
        raise BadInput(
            f"{first.name}: {longest_s:.3g} s are too short to identify a valve; at least {LEAST_S:g} s. "
            "Is the time in another unit than s (--units time=UNIT)?"
        )
    if max(float(np.ptp(track.pressure)) for track in tracks) <= 0.0:
        raise BadInput(
            f"{first.name}: the pressure never changes while there are positions; record a sweep over both curves"
        )
    if max(float(np.ptp(track.position[track.good])) for track in tracks) <= 0.0:
        raise BadInput(
            f"{first.name}: the position never changes while there are positions; record a sweep over both curves"
        )


def check_fit(residual: FloatArray, tracks: Sequence[Track], recordings: Sequence[Recording]) -> None:
    """Raises: `BadInput` where the position falls as the pressure rises, `JobFailed` where it does something else."""
    position = np.concatenate([t.position[t.good] for t in tracks])
    if float(np.std(residual)) < 0.6 * float(np.std(position)):
        return
    _refuse_falling(tracks, recordings)
    raise JobFailed(
        f"{_names(recordings)}: the position does not follow the {_cause(recordings)} in any way that the model knows; "
        "check the columns"
    )


def check_found(estimates: Sequence[Estimate], tracks: Sequence[Track], recordings: Sequence[Recording]) -> None:
    """Raises: `BadInput` where the position falls as the pressure rises, `JobFailed` where no curve shows."""
    known = {each.name for each in estimates if each.interval is not None}
    if "compliance" in known or {"a1", "a2"} <= known:
        return
    _refuse_falling(
        tracks, recordings
    )  # a short record that is the wrong way round may pass for a play that is hardly left
    raise JobFailed(
        f"{_names(recordings)}: the curves do not show: the record moves too little to tell where the stem starts to "
        "close, where it is open again and how stiff it is between; sweep through both, as with `lostmotion sweep ramp`"
    )


def slow_note(design: DesignModel) -> list[str]:
    """What to say of a valve that takes longer for a stroke than any does."""
    stroke_s = design.travel / design.rate_limit + design.tau_s + design.ep_tau_s
    if stroke_s < SLOW_S:
        return []
    return [f"a stroke would take {stroke_s:.3g} s: is the time in another unit than s (--units time=ms)?"]


def told_positions(design: DesignModel, recordings: Sequence[Recording]) -> bool:
    """Whether `design` was identified from commands that a positioner was told.

    A file does not say so; but nothing else has a stem that goes, in percent, where it is told. Where the pressure was
    measured it is the actuator itself that does.
    """
    units = {design.pressure_unit, design.position_unit}
    if units != {PERCENT} or any(each.pressure is not None for each in recordings):
        return False
    return max(abs(design.a1), abs(design.a2), abs(100.0 * (design.compliance - 1.0))) < ONE_TO_ONE


def check_commands(design: DesignModel, recordings: Sequence[Recording]) -> None:
    """Raises: `BadInput` where `design` was identified from commands that a positioner was told."""
    if told_positions(design, recordings):
        raise BadInput(
            f"{_names(recordings)}: the position is the command, percent for percent, so the commands are {_POSITIONER}"
        )


def _refuse_falling(tracks: Sequence[Track], recordings: Sequence[Recording]) -> None:
    position = np.concatenate([t.position[t.good] for t in tracks])
    pressure = np.concatenate([t.pressure[t.grid.first][t.good] for t in tracks])
    if float(np.corrcoef(pressure, position)[0, 1]) < FALLS:
        file, ours = of_its_file(recordings[0]), recordings[0].position_unit
        unit, top = file.unit(ours), file.value(max(float(np.nanmax(each.position)) for each in recordings), ours)
        raise BadInput(
            f"{_names(recordings)}: the position falls as the {_cause(recordings)} rises; 0 must be the open end, so "
            f"turn it round, as in --units 'position={unit}(0..T=T..0 {unit})' with the travel, some {top:.3g}, for T"
        )


def _cause(recordings: Sequence[Recording]) -> str:
    return "command" if all(recording.pressure is None for recording in recordings) else "pressure"


def _names(recordings: Sequence[Recording]) -> str:
    return ", ".join(recording.name for recording in recordings)
