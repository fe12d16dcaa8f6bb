"""All event tests on one recording: what the look of the readings says before any model is tried."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray, Recording
from twin.diagnosis import Estimate
from twin.events.dropouts import find_dropouts
from twin.events.evidence import Evidence, nothing
from twin.events.on_change import on_change
from twin.events.stale import stale_samples
from twin.events.tails import Tail
from twin.noise.lattice import lattice_step, missing_codes, rounding_error, step_doubt
from twin.noise.model import NoiseModel

ON_CHANGE = "sensor_quantization/on_change"
_MATERIAL = 0.25  # of the floor's variance


@dataclass(frozen=True, slots=True)
class Events:
    """Evidence per effect name, and the rows (shape (n,), True = false reading) that no fit should use.

    `quantization_share` is the part of the position floor's variance that the reading's step makes: every reading has
    a step, and only one that makes a good part of the floor is the effect `sensor_quantization`.
    `tail`: of the position.
    """

    evidence: dict[str, Evidence]
    false_position: npt.NDArray[np.bool_]
    false_pressure: npt.NDArray[np.bool_]
    tail: Tail
    quantization_share: float = 0.0


def scan_events(recording: Recording, noise: NoiseModel) -> Events:
    """Tests one recording for stale samples, drop-outs and quantization (two kinds)."""
    position, pressure = recording.position, recording.pressure
    sigma = noise.position.sigma
    step = lattice_step(position)
    drop = find_dropouts(position, max(sigma, _coarse(position, step)))
    clean = np.where(drop.rows, np.nan, position)
    step = lattice_step(clean) if drop.rows.any() else step
    quantization, share = _quantization(recording.position, step, sigma, recording.position_unit)
    evidence = {
        "sensor_dropouts": drop.evidence,
        "stale_samples": stale_samples(recording.time_s, clean, sigma, step),
        "sensor_quantization": quantization,
        ON_CHANGE: on_change(clean, step, recording.position_unit),
    }
    false_pressure = np.zeros(recording.n, dtype=bool)
    if pressure is not None and noise.pressure is not None:
        false_pressure = find_dropouts(pressure, noise.pressure.sigma).rows
    return Events(evidence, drop.rows, false_pressure, drop.tail, share)


def _coarse(position: FloatArray, step: float | None) -> float:
    """RMS error of a reading that lacks codes: from one that it has to the next is no false reading. 0 without."""
    if step is None or missing_codes(position, step)[0] == 0:
        return 0.0
    return step * float(np.sqrt(rounding_error(position, step)))


def _quantization(values: FloatArray, step: float | None, sigma: float, unit: str) -> tuple[Evidence, float]:
    if step is None or sigma <= 0.0:
        return nothing("sensor_quantization", "the readings lie on no lattice"), 0.0
    share = min(step**2 / 12.0 / sigma**2, 1.0)
    doubt = step_doubt(values, step)
    estimates = {"step": Estimate(step, (step - doubt, step + doubt), unit)}
    if share < _MATERIAL:
        note = f"the step makes {share:.0%} of the noise: fine enough"
        return Evidence("sensor_quantization", 0.0, 1.0, estimates, note), share
    # that the values lie on this lattice is beyond doubt; the ratio only orders coarse steps
    return Evidence("sensor_quantization", 50.0 * share, 1e-12, estimates), share
