"""From recordings to the numbers of the design model, each with a 95 % interval, or with the default it was left at.

In stages: the converter's lag from command and pressure; the valve by an output-error fit given that pressure; then,
for comparison, the two curves from steady dwells and the time constant by the 63 % rule.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from control.characterize import Settling, characterize
from control.design import DesignModel
from control.identify_checks import check_fit, check_found, check_motion, check_records, slow_note
from control.identify_interval import Interval
from control.identify_kept import Facts, settle_numbers
from control.identify_pressure import PressureStage
from control.identify_result import Estimate, Identified, misfit, quality_of
from control.identify_slopes import slopes
from control.identify_spread import lag_shift, spread_of, with_lag_doubt
from control.identify_steps import time_constant_63
from control.identify_track import Track, reach_of
from control.identify_tracks import FEWEST_ROWS, cleaned, drive_of, tracks_of
from control.identify_valve import ValveFit, fit_valve
from hal.errors import BadInput
from logs.recording import FloatArray, Recording
from logs.spoken import spoken_by


def identify(recordings: Sequence[Recording], defaults: DesignModel | None = None) -> Identified:
    """The design model of the valve that made these recordings; `defaults` are kept where they do not tell.

    Raises: `BadInput` when they are in different units, too short, the valve does not move, or the position falls with
    rising pressure; `JobFailed` when it follows the pressure in no way that the model knows.
    """
    check_records(recordings)
    unit_p, unit_x = recordings[0].pressure_unit, recordings[0].position_unit
    base = replace(defaults or default_design(unit_p, unit_x), spoken=spoken_by(recordings))
    notes: list[str] = []
    recordings = [cleaned(each, notes) for each in recordings]
    given = _prepared(recordings, base.ep_tau_s, notes)
    if not (tracks := given.tracks):
        raise BadInput(f"{recordings[0].name}: no stretch of {FEWEST_ROWS} rows without a gap; nothing can be fitted")
    check_motion(tracks, recordings)
    fit, freedom = fit_valve(tracks)
    residual = fit.residual(tracks)
    check_fit(residual, tracks, recordings)
    tracks = with_lag_doubt(tracks, fit, freedom, base.ep_tau_s)
    lag = lag_shift(tracks, fit, freedom)
    facts = Facts(base, unit_p, unit_x, _ep_tau(given.stages), fit, freedom, tracks, _kept_lag(given.stages), lag)
    design, estimates = settle_numbers(facts, *spread_of(tracks, fit, freedom), notes)
    check_found(estimates, tracks, recordings)
    estimates += slopes(tracks, fit, freedom, f"{unit_x}/{unit_p}", design, notes)
    estimates += _other_ways(list(recordings), design, max(track.lag_doubt_s for track in tracks), notes)
    _say_zero(residual, tracks, fit, design, notes)
    quality = quality_of(residual, np.concatenate([t.position[t.good] for t in tracks]), design.travel)
    if given.commanded:
        missed = float(np.sqrt(np.mean(fit.residual(given.commanded) ** 2)))
        quality = replace(quality, commanded_percent_of_travel=100.0 * missed / design.travel)
    notes += misfit(quality, [recording.position for recording in recordings])
    return Identified(
        design,
        tuple(estimates),
        quality,
        tuple(recording.name for recording in recordings),
        int(residual.size),
        tuple(dict.fromkeys(notes)),
        tuple(fit.predict(tracks)),
    )


@dataclass(frozen=True, slots=True)
class _Prepared:
    """The records' tracks; the same driven by the command alone, none where a pressure is missing; the E/P stages."""

    tracks: list[Track]
    commanded: list[Track]
    stages: list[PressureStage]


def _prepared(recordings: Sequence[Recording], ep_tau_s: float, notes: list[str]) -> _Prepared:
    tracks, commanded, stages = list[Track](), list[Track](), list[PressureStage]()
    for recording in recordings:
        stage, fine_s, fine = drive_of(recording, ep_tau_s, notes)
        if stage is not None:
            stages.append(stage)
            commanded += tracks_of(recording, fine_s, stage.commanded, None, [])
        tracks += tracks_of(recording, fine_s, fine, stage, notes)
    return _Prepared(tracks, commanded if len(stages) == len(recordings) else [], stages)


def default_design(pressure_unit: str, position_unit: str) -> DesignModel:
    """The thesis's numbers, with travel and rate limit brought to percent where positions are in percent."""
    plain = DesignModel()
    if position_unit == "in":
        return DesignModel(pressure_unit=pressure_unit, position_unit=position_unit)
    scale = 100.0 / plain.travel
    return DesignModel(
        compliance=plain.compliance * scale,
        rate_limit=plain.rate_limit * scale,
        travel=100.0,
        pressure_unit=pressure_unit,
        position_unit=position_unit,
    )


def _ep_tau(stages: Sequence[PressureStage]) -> Interval | None:
    """The E/P lag over all recordings, weighted by what each knows of it."""
    known = [stage.tau_s for stage in stages if stage.tau_s is not None]
    if not known:
        return None
    weights = np.array([1.0 / max(each.half_width, 1e-9) ** 2 for each in known])
    value = float(weights @ [each.value for each in known] / weights.sum())
    reach = float(weights.sum() ** -0.5)
    return Interval(value, value - reach, value + reach)


def _kept_lag(stages: Sequence[PressureStage]) -> float | None:
    """The E/P lag that was used where pressures do not tell it; the median of several."""
    return float(np.median([stage.lag_s for stage in stages])) if stages else None


def _other_ways(
    recordings: list[Recording], design: DesignModel, lag_doubt_s: float, notes: list[str]
) -> list[Estimate]:
    """What steady dwells and the 63 % rule say, for comparison with the fit; `lag_doubt_s`: of the converter's lag."""
    unit_p, unit_x = design.pressure_unit, design.position_unit
    settling = Settling(design.tau_s, design.ep_tau_s, design.rate_limit)
    curves = characterize(recordings, settling)
    estimates = []
    for curve, onset, slope in ((curves.closing, "a1", "k1"), (curves.opening, "a2", "k2")):
        if curve is not None:
            k = curve.compliance
            estimates.append(Estimate(f"{onset} (curves)", curve.onset.value, curve.onset, unit_p, "curves"))
            estimates.append(Estimate(f"{slope} (curves)", k.value, k, f"{unit_x}/{unit_p}", "curves"))
    steps = time_constant_63(recordings, settling, design.travel, lag_doubt_s)
    if steps.tau_s is not None:
        said = f"{steps.raw_s.size} steps, {np.median(steps.raw_s):.2f} s with the E/P lag"
        estimates.append(Estimate("tau (63 %)", steps.tau_s.value, steps.tau_s, "s", "63 % rule", said))
    notes += curves.notes
    return estimates


def _say_zero(
    residual: FloatArray, tracks: Sequence[Track], fit: ValveFit, design: DesignModel, notes: list[str]
) -> None:
    """What no valve is: off at the open stop, closed without any pressure, on its way for ages."""
    notes += slow_note(design)
    if design.a1 < 0.0 and not reach_of(tracks).away:
        a1 = design.spoken.text(design.a1, design.pressure_unit, 4)
        notes.append(
            f"with a1 = {a1} the stem would close without any pressure: is the "
            "command a position, told to a positioner? Then this is no open-loop record, and no number is the valve's"
        )
    predicted = np.concatenate([x[t.good] for t, x in zip(tracks, fit.predict(tracks), strict=True)])
    open_rows = predicted <= 1e-6 * design.travel
    if open_rows.sum() >= FEWEST_ROWS:
        zero = float(np.median(residual[open_rows]))
        if abs(zero) > 0.005 * design.travel:
            said = design.spoken.text(zero, design.position_unit, 3)
            notes.append(f"fully open it reads {said}, not 0: check the LVDT's zero")
