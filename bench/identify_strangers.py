"""How well `identify` does on valves and experiments of any kind, in percent and without a pressure.

    python bench/identify_strangers.py --first 0 --count 80

Valves are drawn at random: lags of 0.3 to 15 s, a converter's of 5 to 30 % of that, no play or one of 2 to 30 % of
command, some with a rate limit; so are rows (0.02 to 2 s), the part of the travel that is visited, the noise (0.02 to
0.2 %) and the experiment: steps, stairs, ramps, sines, a closed loop. They are solved here in small steps of the
interface document's equations. A record is missed where what identification leaves is more than 1.3 times the noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import click
import numpy as np
from numba import njit

from control.identify import identify
from hal.errors import BadInput, JobFailed
from logs.recording import FloatArray, Recording

_KINDS = ("loop", "stairs", "ramp", "steps", "sine")
_MOST_ROWS, _LONGEST_S, _MISSED = 20_000, 3000.0, 1.3
_ROOM_PERCENT = 0.05  # beyond its interval that a deadband may be off: rows are up to a lag apart


@dataclass(frozen=True, slots=True)
class Stranger:
    """A valve in percent; `deadband` and `a2` of command, `rate` in percent of travel per second."""

    deadband: float
    a2: float
    compliance: float
    tau_s: float
    ep_tau_s: float
    rate: float

    def vector(self, gain: float) -> FloatArray:
        """The numbers in the order of the loop, with a controller's `gain`; 0 without one."""
        a1 = self.a2 + self.deadband
        return np.array([self.ep_tau_s, a1, self.a2, self.compliance, self.tau_s, self.rate, gain])


@njit(nogil=True)
def _runs(v: FloatArray, command: FloatArray, wanted: FloatArray, steps: tuple[float, int], out: FloatArray) -> None:
    """Fills `out` with the stem, and `command` with what a PI controller makes of `wanted`, if there is one.

    `steps`: how long they are, and how many there are between rows.
    """
    ep_tau, a1, a2, k, tau, rate, gain = v
    h, per = steps
    p = command[0]
    w = min(max(k * (p - 0.5 * (a1 + a2)), 0.0), 100.0)
    x, integral = w, p
    for i in range(out.size):
        out[i] = x
        if gain != 0.0:
            error = wanted[i] - x
            integral += gain / tau * error * h * per
            command[i] = integral + gain * error
        u = command[i] if gain != 0.0 or i + 1 == out.size else command[i + 1]
        for _ in range(per):
            p = u + (p - u) * np.exp(-h / ep_tau)
            before = w
            w = min(max(k * (p - a1), min(k * (p - a2), w), 0.0), 100.0)
            move = (0.5 * (before + w) - x) * (1.0 - np.exp(-h / tau))
            x = min(max(x + min(max(move, -rate * h), rate * h), 0.0), 100.0)


def drawn(seed: int) -> tuple[Recording, Stranger, str, float]:
    """A recording, its valve, the kind of experiment and the noise [percent]."""
    dice = np.random.default_rng(seed)
    tau_s = float(np.exp(dice.uniform(np.log(0.3), np.log(15.0))))
    band = float(dice.choice([0.0, 0.0, 2.0, 5.0, 10.0, 20.0, 30.0]))
    rate = float(dice.choice([1e6, 1e6, 20.0 / tau_s]))
    place, compliance, share = dice.uniform(-20.0, 20.0), dice.uniform(0.9, 3.0), dice.uniform(0.05, 0.3)
    valve = Stranger(band, place, compliance, tau_s, share * tau_s, rate)
    period_s = min(float(dice.choice([0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0])), tau_s)
    rows = min(_MOST_ROWS, int(np.clip(tau_s * dice.uniform(80.0, 300.0), 120.0, _LONGEST_S) / period_s))
    kind, noise = str(dice.choice(_KINDS)), float(dice.uniform(0.02, 0.2))
    time_s = np.asarray(period_s * np.arange(rows), dtype=np.float64)
    wanted = _wanted(kind, time_s / tau_s, dice)
    middle = wanted / valve.compliance + valve.a2 + 0.5 * band
    command = middle + 0.5 * band * np.where(np.gradient(wanted) > 0.0, 1.0, -1.0) if kind != "loop" else middle.copy()
    per = max(4, int(np.ceil(20.0 * period_s / min(tau_s, 4.0 * valve.ep_tau_s))))
    stem = np.empty(rows)
    gain = 0.3 / valve.compliance if kind == "loop" else 0.0
    _runs(valve.vector(gain), command, wanted, (period_s / per, per), stem)
    if kind == "loop":  # what is commanded at a row counts from there on
        command = np.concatenate((command[:1], command[:-1]))
    reading = stem + dice.normal(0.0, noise, rows)
    name = f"stranger {seed}"
    recording = Recording(name, time_s, command, reading, pressure_unit="percent", position_unit="percent")
    return recording, valve, kind, noise


def _wanted(kind: str, lags: FloatArray, dice: np.random.Generator) -> FloatArray:
    """Where the stem is to go [percent], over time in lags of the valve."""
    half, middle = 0.5 * dice.uniform(0.05, 0.9), dice.uniform(0.1, 0.9)
    low, high = 100.0 * max(0.0, middle - half), 100.0 * min(1.0, middle + half)
    if kind == "sine":
        wave = 0.6 * np.sin(2.0 * np.pi * lags / 20.0) + 0.4 * np.sin(2.0 * np.pi * lags / 7.3 + 1.0)
        return 0.5 * (low + high) + 0.5 * (high - low) * wave
    if kind == "ramp":
        return low + (high - low) * np.abs((lags / 40.0) % 2.0 - 1.0)
    number = np.floor(lags / 6.0).astype(int)
    if kind == "stairs":
        return np.asarray(low + (high - low) * (8 - np.abs(8 - number % 16)) / 8.0)
    return np.asarray(dice.uniform(low, high, number.max() + 1)[number])


@click.command()
@click.option("--first", default=0, show_default=True)
@click.option("--count", default=80, show_default=True)
def main(first: int, count: int) -> None:
    """Draws valves, identifies them and counts."""
    told, missed, bands, held = 0, 0, 0, 0
    for seed in range(first, first + count):
        recording, valve, kind, noise = drawn(seed)
        label = f"{seed:4d} {kind:6s} deadband {valve.deadband:4.1f} lag {valve.tau_s:5.2f} s"
        try:
            found = identify([recording])
        except (BadInput, JobFailed) as error:
            click.echo(f"{label}  not told: {str(error)[:90]}")
            continue
        told += 1
        times, interval = found.quality.rms / noise, found["deadband"].interval
        missed += times > _MISSED
        if interval is not None:
            bands += 1
            held += interval.low - _ROOM_PERCENT <= valve.deadband <= interval.high + _ROOM_PERCENT
        click.echo(f"{label}  {found['deadband'].value:6.2f}  leaves {times:.2f} x noise")
    click.echo(f"told {told} of {count}; missed {missed}; deadband held by its interval {held} of {bands}")


if __name__ == "__main__":
    main()
