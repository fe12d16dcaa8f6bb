"""What an unexplained residual depends on: how much of it each thing that was measured accounts for, and how it sounds.

Source: correlation ratio, Pearson (1905); Welch, IEEE Trans. AU-15 (1967) 70 (spectrum).
"""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import numpy.typing as npt
from scipy.signal import welch

from logs.recording import FloatArray
from twin.choose.decide import Decision
from twin.choose.outside import outside_of
from twin.choose.stages import StageResult
from twin.fit.case import Case
from twin.fit.trial import Trial
from twin.judge.repeatable import Disturbance, repeated_share
from twin.judge.swing import Swing
from twin.judge.verdict import strays
from twin.where.regime import DIRECTIONS, REGIMES, classify

_BINS = 10


def residual_signature(
    case: Case, result: StageResult, loud: Disturbance | None, swing: Swing | None = None
) -> dict[str, object]:
    """What the best hypothesis leaves on the channel with the largest rest; names, shares and numbers for JSON.

    `depends_on`: share of the residual's square that the means within bins of each thing account for (0 to 1).
    """
    worst = max(result.decisions, key=lambda d: (loud is not None and _signal(d) == loud.signal, d.accepted.mse))
    residuals, trials = worst.accepted.residuals, worst.findings.channel.trials
    found: dict[str, object] = {
        "signal": _signal(worst),
        "rms_over_noise": float(np.sqrt(worst.accepted.mse)),
        "depends_on": _depends_on(case, worst),
        "repeats": repeated_share(residuals, trials),
        **_spectrum(trials, residuals),
    }
    rival = next((d for d in result.decisions if outside_of(d)), None)
    if rival is not None:
        found["looks_like"] = _looks_like(case, rival)
    elif strays(result):
        found["looks_like"] = {"what": _gauge(result)}
    if loud is not None:
        found["does_not_repeat"] = {
            "signal": loud.signal,
            "between_repeats": loud.repeats,
            "at_rest": loud.resting,
            "unit": loud.unit,
        }
    if swing is not None:
        unit = case.scales.position_unit if swing.signal == "position" else case.scales.pressure_unit
        found["swings"] = {**asdict(swing), "unit": unit}
    return found


def _gauge(result: StageResult) -> str:
    """What the pressure gauge itself did, in words."""
    if not result.denied:
        return "the pressure gauge itself strayed, because the stem did not follow it"
    causes = " and ".join(name.removeprefix("parameter:") for name in result.denied)
    return f"the pressure gauge itself does what {causes} would: the stem went as if the converter had none"


def _looks_like(case: Case, decision: Decision) -> dict[str, object]:
    """What explains the channel best and is none of the known effects, in words and numbers."""
    rival = outside_of(decision)
    assert rival is not None and rival.form is not None
    values = next(i.values for i in decision.accepted.plant.inserted if i.effect == rival.name)
    named = zip(rival.form.parameters, values, strict=True)
    return {"what": rival.form.outside, **{p.name: {"value": v, "unit": case.scales.unit(p.kind)} for p, v in named}}


def _signal(decision: Decision) -> str:
    return "pressure" if decision.findings.channel.name == "pressure" else "position"


def _depends_on(case: Case, decision: Decision) -> dict[str, float]:
    channel = decision.findings.channel
    residuals = decision.accepted.residuals
    labels: dict[str, list[FloatArray]] = {name: [] for name in ("position", "pressure", "time", "direction", "regime")}
    for trial in channel.trials:
        for name, values in _labels(case, trial).items():
            labels[name].append(values)
    use = channel.use
    return {name: _ratio(residuals[use], np.concatenate(parts)[use]) for name, parts in labels.items()}


def _labels(case: Case, trial: Trial) -> dict[str, FloatArray]:
    """Bin number of every row under each heading."""
    r = trial.recording
    pressure = r.command if trial.pressure is None else trial.pressure[trial.grid.offsets]
    reading = np.nan_to_num(r.position)
    noise = case.noise.position
    classes = classify(
        r.time_s, reading, reading, pressure, case.sigma_y, case.travel, correlation_samples=noise.correlation_samples
    )
    return {
        "position": _binned(reading),
        "pressure": _binned(pressure),
        "time": _binned(r.time_s),
        "direction": np.clip(classes.direction, 0, len(DIRECTIONS)).astype(np.float64),
        "regime": np.clip(classes.regime, 0, len(REGIMES)).astype(np.float64),
    }


def _binned(values: FloatArray) -> FloatArray:
    edges = np.quantile(values, np.linspace(0.0, 1.0, _BINS + 1)[1:-1])
    return np.searchsorted(edges, values).astype(np.float64)


def _ratio(residuals: FloatArray, labels: npt.NDArray[np.float64]) -> float:
    """Share of the squares that the means within the bins account for."""
    total = float(residuals @ residuals)
    if total <= 0.0:
        return 0.0
    parts = (residuals[labels == label] for label in np.unique(labels))
    return float(sum(part.size * part.mean() ** 2 for part in parts) / total)


def _spectrum(trials: tuple[Trial, ...], residuals: FloatArray) -> dict[str, object]:
    """The strongest frequency of the longest trial's residual [Hz], and the share of its power about that line."""
    at = np.cumsum([0, *(t.recording.n for t in trials)])
    k = int(np.argmax([t.recording.n for t in trials]))
    r = residuals[at[k] : at[k + 1]]
    if r.size < 64 or not r.any():
        return {}
    frequency, power = welch(r, fs=1.0 / trials[k].recording.period_s, nperseg=min(r.size, 2048))
    line = int(np.argmax(power))
    near = power[max(line - 1, 0) : line + 2].sum()
    return {"strongest_frequency_hz": float(frequency[line]), "share_at_it": float(near / power.sum())}
