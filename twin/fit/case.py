"""A case for diagnosis: recordings, the design they are held against, and what the readings' noise is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from control.design import DesignModel
from logs.recording import DataNote, Recording
from twin.events.refresh import freshness
from twin.fit.beginning import beginning
from twin.fit.trial import Trial, make_trial
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.model.timegrid import make_grid
from twin.noise.coarse import Coarse, coarse
from twin.noise.model import NoiseModel, estimate_noise
from twin.record.places import places

#: Travel over compliance, and travel, of the thesis's valve: the units in which effects state their sizes.
_REFERENCE_SPAN_PSI = 0.5625 / 0.19
_REFERENCE_TRAVEL_IN = 0.5625
#: Noise is never believed to be below this share of the span: numbers in a file have finite digits.
_LEAST_NOISE = 1e-5


@dataclass(frozen=True, slots=True)
class Margin:
    """RMS by which a healthy machine is known to depart from its design: no gap means no more than this on top of the
    noise. In the recordings' units; measured on a healthy twin or golden runs, 0 where the design is believed."""

    position: float = 0.0
    pressure: float = 0.0


@dataclass(frozen=True, slots=True)
class Span:
    """Rows `start`..`stop`-1 of recording number `record`; what happened before is known from row `history` on."""

    record: int
    start: int
    stop: int
    history: int


@dataclass(frozen=True, slots=True)
class Case:
    """Everything a diagnosis starts from. `sigma_p` is None without a measured pressure.

    `coarse`: the steps of the position reading, where they are sharp.
    A look at a large case (`twin/ready/thin.py`) knows the `whole`, and which `spans` its recordings are cut from.
    """

    recordings: tuple[Recording, ...]
    base: Plant
    scales: Scales
    noise: NoiseModel
    sigma_y: float
    sigma_p: float | None
    trials: tuple[Trial, ...]
    whole: Case | None = None
    spans: tuple[Span, ...] = ()
    coarse: Coarse | None = None

    @property
    def everything(self) -> Case:
        """The case with all rows."""
        return self.whole or self

    @property
    def travel(self) -> float:
        return self.base.design.travel

    @property
    def signals(self) -> frozenset[str]:
        """What is measured besides command and position, as `twin/where/isolability.py` names it."""
        return frozenset() if self.sigma_p is None else frozenset({"pressure"})

    @property
    def notes(self) -> tuple[DataNote, ...]:
        """What was found in the files, all recordings in turn."""
        return tuple(note for recording in self.recordings for note in recording.notes)


def make_case(
    recordings: Sequence[Recording],
    design: DesignModel,
    inserted: Sequence[Inserted] = (),
    bad_rows: Sequence[npt.NDArray[np.bool_] | None] | None = None,
    noise: NoiseModel | None = None,
    step: float = 0.0,
    held: bool = False,
    sharp: bool = False,
    doubt: float = Scales().doubt,
) -> Case:
    """Prepares recordings against a design; `inserted` are effects that the design already has.

    `step` is the resolution of the position reading: still readings on one step show no noise, and have some. `held`:
    readings are seen to be refreshed more slowly than they are polled. `sharp`: the steps are seen to be coarse, so
    that a reading may be an interval (`twin/noise/coarse.py`). `doubt`: see `Scales`.
    """
    noise = noise or estimate_noise(recordings)
    span = design.travel / design.compliance
    scales = Scales(
        pressure=span / _REFERENCE_SPAN_PSI,
        position=design.travel / _REFERENCE_TRAVEL_IN,
        pressure_unit=design.pressure_unit,
        position_unit=design.position_unit,
        doubt=doubt,
        spoken=design.spoken,
    )
    bad = bad_rows or [None] * len(recordings)
    base = Plant(design, tuple(inserted))
    triples = zip(recordings, bad, places(recordings), strict=True)
    steps = coarse(recordings, step) if sharp else None
    trials = tuple(replace(_trial(base, r, b, held, steps), place=place) for r, b, place in triples)
    sigma_p = None if noise.pressure is None else max(noise.pressure.sigma, _LEAST_NOISE * span)
    sigma_y = max(noise.position.sigma, step / np.sqrt(12.0), _LEAST_NOISE * design.travel)
    return Case(tuple(recordings), base, scales, noise, float(sigma_y), sigma_p, trials, coarse=steps)


def widened(case: Case, margin: Margin) -> tuple[Case, float]:
    """The case with the margin as part of the noise, and the largest share of the margin in a channel's variance."""
    sigma_y = float(np.hypot(case.sigma_y, margin.position))
    shares = [margin.position / sigma_y]
    sigma_p = case.sigma_p
    if sigma_p is not None:
        sigma_p = float(np.hypot(sigma_p, margin.pressure))
        shares.append(margin.pressure / sigma_p)
    steps = None if case.coarse is None else case.coarse.with_margin(margin.position)
    return replace(case, sigma_y=sigma_y, sigma_p=sigma_p, coarse=steps), max(shares) ** 2


def _trial(
    base: Plant, recording: Recording, bad: npt.NDArray[np.bool_] | None, held: bool, steps: Coarse | None
) -> Trial:
    step_s = fine_step_s(base.design, recording)
    begun = beginning(base, recording, make_grid(recording.time_s, step_s, recording.command), steps)
    return make_trial(recording, step_s, bad, begun, freshness(recording) if held else None)


def fine_step_s(design: DesignModel, recording: Recording) -> float:
    """Step of the fine grid [s]: short against the lags, but no more than about 4,000,000 steps in all."""
    # a lag far shorter than the sampling period cannot be told from a jump: no finer than a twentieth of the period
    shortest = max(0.01, min(0.05, recording.period_s / 20.0))
    coarsest = max(0.1, recording.period_s / 10.0)  # rows that come slowly are of a slow machine
    wanted = min(coarsest, max(min(design.tau_s, 4.0 * design.ep_tau_s) / 25.0, shortest))
    return max(wanted, recording.duration_s / 4_000_000.0)
