"""From a recording to what can be fitted: false readings out, a pressure that may drive the play, cut at the gaps."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np

from control.identify_model import held, lagged, make_grid
from control.identify_pressure import PressureStage, fit_pressure
from control.identify_readings import false_readings
from control.identify_track import Track, first_position
from logs.recording import FloatArray, Recording
from logs.spoken import spoken_by

FEWEST_ROWS = 30
_UNIT_TOLERANCE = 0.01
_UNITS_KPA = {"psi": 6.894757, "kPa": 1.0, "bar": 100.0}  # those that a pneumatic signal is given in


def cleaned(recording: Recording, notes: list[str]) -> Recording:
    """The recording with plainly false readings made missing, and said."""
    values = {"position": recording.position}
    if recording.pressure is not None:
        values["pressure"] = recording.pressure
    for name, signal in values.items():
        false = false_readings(signal)
        if false.any():
            notes.append(f"{recording.name}: {int(false.sum())} false readings of the {name} are left out")
            values[name] = np.where(false, np.nan, signal)
    return replace(recording, **values)  # type: ignore[arg-type]


def drive_of(
    recording: Recording, ep_tau_s: float, notes: list[str]
) -> tuple[PressureStage | None, FloatArray, FloatArray]:
    """The stage (None without pressure), the fine times and the pressure that drives the play there."""
    grid = make_grid(recording.time_s)
    if recording.pressure is None:
        notes.append(
            f"{recording.name}: no measured pressure: the E/P and actuator stages cannot be separated; only the play "
            "between them tells their lags apart"
        )
        return None, grid.fine_time_s, lagged(grid, recording.command, ep_tau_s, float(recording.command[0]))
    stage = fit_pressure(grid, recording.command, recording.pressure, ep_tau_s)
    if recording.command_timing == "unknown":
        later = np.concatenate((recording.command[:1], recording.command[:-1]))
        shifted = fit_pressure(grid, later, recording.pressure, ep_tau_s)
        if shifted.rms < stage.rms:
            stage = shifted
            notes.append(f"{recording.name}: the commands fit the pressure better when they count from their row on")
    if stage.tau_s is None:
        notes.append(
            f"{recording.name}: the pressure does not show the E/P lag: {_lag_range(stage)} all agree with readings "
            f"every {recording.period_s:.3g} s; it is kept at {stage.lag_s:.3g} s"
        )
    if not stage.is_calibrated:
        spoken, unit = spoken_by([recording]), recording.pressure_unit
        notes.append(
            f"{recording.name}: pressure = {stage.gain:.4f} x command {spoken.value(stage.zero, unit):+.3g}, up to "
            f"{spoken.text(stage.off, unit, 2)} off: {unit_doubt(stage.gain)}the design model has no place for that; "
            "a1 and a2 are what the gauge reads, not what is commanded"
        )
    return stage, grid.fine_time_s, stage.fine


def _lag_range(stage: PressureStage) -> str:
    return f"{max(0.0, stage.lag_s - stage.doubt_s):.2g} to {stage.lag_s + stage.doubt_s:.2g} s"


def unit_doubt(gain: float) -> str:
    """What is to be said of a `gain` from command to pressure that should be 1: whether two units would make it."""
    for of, per in permutations(_UNITS_KPA, 2):
        if abs(gain * _UNITS_KPA[of] / _UNITS_KPA[per] - 1.0) < _UNIT_TOLERANCE:
            return (
                f"that is {of} per {per}, so one of the two is in another unit than it is read in; "
                "give both (--units command=UNIT,pressure=UNIT): "
            )
    return "the E/P transducer and its transmitter disagree; "


def tracks_of(
    recording: Recording,
    fine_s: FloatArray,
    fine: FloatArray,
    stage: PressureStage | None,
    notes: list[str],
) -> list[Track]:
    """The record cut at its gaps: what the valve did meanwhile nobody knows. `stage` tells how sure its pressure is."""
    doubts = () if stage is None else tuple(stage.doubts)
    breaks = [] if recording.gap_before is None else np.flatnonzero(recording.gap_before).tolist()
    tracks = []
    for start, stop in zip([0, *breaks], [*breaks, recording.n], strict=True):
        position = recording.position[start:stop]
        good = np.isfinite(position)
        if good.sum() < FEWEST_ROWS:
            notes.append(f"{recording.name}: a stretch of {stop - start} rows between gaps is too short and left out")
            continue
        grid = make_grid(recording.time_s[start:stop])
        pressure = np.interp(grid.fine_time_s, fine_s, fine)
        doubt = tuple(np.interp(grid.fine_time_s, recording.time_s, each) for each in doubts)
        position = np.where(good, position, 0.0)
        begin = first_position(grid.time_s, position, good)
        command = held(grid, recording.command[start:stop]) if recording.pressure is None else None
        track = Track(grid, pressure, position, good, begin, doubt, command)
        if stage is not None and stage.doubt_s > 0.0:
            later = np.interp(grid.fine_time_s, fine_s, stage.later)
            track = replace(track, later=later, lag_doubt_s=stage.doubt_s)
        tracks.append(track)
    return tracks
