"""A reading that swings by itself: noise that is mostly one line, or one narrow band, of the spectrum.

The noise of a reading is measured where nothing happens, so a swing of constant amplitude (interference on the cable, a
beat with the mains) hides in it: the design then misses by no more than the noise, and yet noise it is not. Where the
swing comes and goes (a pipe that vibrates), its line is a band.
Source: Fisher, Proc. R. Soc. A 125 (1929) 54 (the largest line of a periodogram).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from logs.recording import DataNote, FloatArray
from logs.spoken import HOUSE, Spoken
from twin.choose.stages import StageResult
from twin.fit.trial import Trial

#: Of the squared error of the design, for white noise the chance of this in one line is nil; and of the squared
#: command, above which the swing may be an answer to it.
_SHARE, _COMMANDED = 0.6, 0.1
#: Half the width of a band, as a share of its frequency.
_BAND = 0.1
#: Fewer swings than this in the record are a drift, or a model's error.
_SWINGS = 20.0
_LEAST_ROWS = 200


@dataclass(frozen=True, slots=True)
class Swing:
    """One sine of `frequency_hz` (as sampled: it may be folded) and `amplitude` is a `share` of the squared error."""

    frequency_hz: float
    amplitude: float
    share: float
    signal: str = "position"


def swing_in(result: StageResult) -> Swing | None:
    """The swing of the design's error of the position, else of the pressure, in what was measured of it."""
    for decision in reversed(result.decisions):
        channel = decision.findings.channel
        swing = swing_of(decision.findings.none.residuals * channel.sigma, channel.trials)
        if swing is not None:
            return replace(swing, signal="pressure" if channel.name == "pressure" else "position")
    return None


def swing_note(swing: Swing, unit: str, spoken: Spoken = HOUSE) -> DataNote:
    """What an operator should look at; `unit`: the amplitude's, `spoken`: the units that it is said in."""
    look = "cable, screen and supply of the sensor" if swing.signal == "position" else "air supply, regulator and tube"
    size = spoken.text(swing.amplitude, unit, 2)
    return DataNote(
        f"the {swing.signal} swings by itself, {size} at {swing.frequency_hz:.3g} Hz as sampled: "
        f"{100.0 * swing.share:.0f} % of what the design misses",
        f"taken for noise, or for unexplained where nothing else is; look at {look}",
        0,
    )


def swing_of(error: FloatArray, trials: tuple[Trial, ...]) -> Swing | None:
    """The swing that makes up most of the longest trial's `error`, or None.

    `error`: shape (sum of rows,), 0 where a row does not count.
    """
    at = np.cumsum([0, *(t.recording.n for t in trials)])
    k = int(np.argmax(np.diff(at)))
    r, time_s = error[at[k] : at[k + 1]], trials[k].recording.time_s - trials[k].recording.time_s[0]
    use = r != 0.0
    if np.count_nonzero(use) < _LEAST_ROWS:
        return None
    size = 4 * r.size
    power = np.abs(np.fft.rfft(r - r[use].mean() * use, size))
    frequency = np.asarray(np.fft.rfftfreq(size, float(time_s[-1]) / (r.size - 1)), dtype=np.float64)
    power[frequency < _SWINGS / time_s[-1]] = 0.0
    near = frequency[int(np.argmax(power))] + np.linspace(-0.5, 0.5, 41) / time_s[-1]
    line = max((_fitted(r[use], time_s[use], f) for f in near), key=lambda s: s.share)
    best = line if line.share >= _SHARE else _banded(r - r[use].mean() * use, power, frequency)
    command = trials[k].recording.command
    commanded = max(
        _fitted(command[use], time_s[use], best.frequency_hz).share,
        _share_near(command - command.mean(), frequency, best.frequency_hz) if best is not line else 0.0,
    )
    return best if best.share >= _SHARE and commanded < _COMMANDED else None


def _banded(r: FloatArray, power: FloatArray, frequency: FloatArray) -> Swing:
    """The band about the largest line, whose amplitude is that of a sine as strong."""
    top = float(frequency[int(np.argmax(power))])
    share = _share_near(r, frequency, top)
    return Swing(top, float(np.sqrt(2.0 * share * np.mean(r**2))), share)


def _share_near(r: FloatArray, frequency: FloatArray, centre_hz: float) -> float:
    """Share of the square of `r` in the band about a frequency."""
    power = np.abs(np.fft.rfft(r, 2 * (frequency.size - 1))) ** 2
    inside = np.abs(frequency - centre_hz) <= _BAND * centre_hz
    return float(np.sum(power[inside]) / max(float(np.sum(power)), 1e-300))


def _fitted(r: FloatArray, time_s: FloatArray, frequency_hz: float) -> Swing:
    """The sine of one frequency, by least squares."""
    phase = 2.0 * np.pi * frequency_hz * time_s
    basis = np.column_stack([np.cos(phase), np.sin(phase), np.ones_like(phase)])
    best, *_ = np.linalg.lstsq(basis, r, rcond=None)
    rest = r - basis @ best
    whole = r - r.mean()
    share = 1.0 - float(rest @ rest) / max(float(whole @ whole), 1e-300)
    return Swing(float(frequency_hz), float(np.hypot(best[0], best[1])), share)
