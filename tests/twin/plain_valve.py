"""The chain in plain Python, small Euler steps and nothing else: what the compiled passes are held against.

Written from the equations of the interfaces page and of the effects' own `equations`, not from the kernels.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import exp, inf, log, sqrt

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Shape = Callable[[float], float]


def _nothing(_: float) -> float:
    return 0.0


@dataclass(frozen=True)
class PlainValve:
    """Switches for single effects; the defaults are the thesis's valve."""

    ep_tau: float = 0.30
    rise: float = 1.0
    fall: float = 1.0
    gain: float = 1.0
    zero: float = 0.0
    delay: float = 0.0
    hold_band: float = 0.0
    pressure_rate: float = inf
    supply: float = inf
    knee: float = 0.0
    overlap: float = 0.0  # and the flow within it as a share of that outside
    leak: float = 0.0
    quick: float = 0.0  # further flow of an exhaust, and the error from which it flows
    crack: float = 0.0
    clog_rise: float = 0.0  # by what share of itself the converter's lag grows for each psi/s, rising and falling
    clog_fall: float = 0.0
    mixed: float = 0.0  # lag of the command as it comes out of the delay
    tank: float = inf  # a supply that sinks by 0.4 of every rise and comes back in 20 s
    tank_cuts: bool = False  # whether it cuts the pressure off, instead of being what the converter aims at
    cut_off: float = inf
    a1: float = 8.78
    a2: float = 5.82
    k1: float = 0.19
    k2: float = 0.19
    bend: Shape = _nothing  # extra pressure on both curves at position w
    push: Shape = _nothing  # ... where the stem is by now
    grip: Shape = _nothing  # extra half deadband where the stem is by now
    stretch: Shape = _nothing  # extra compliance where the stem is by now, as a share
    widen: Shape = _nothing  # extra half deadband at position w
    grow: Shape = _nothing  # extra half deadband at time t
    breaks_s: float = inf  # when the spring breaks, by how much more pressure it takes then, and the excess of its rate
    takes: float = 0.0
    stiffens: float = 0.0
    tau_close: float = 2.7
    tau_open: float = 2.7
    rate: float = 0.12
    low: float = 0.0
    high: float = 0.5625
    in_motion: bool = False
    breakaway: float = 0.0
    held: float = 0.0  # distance up to which a stem at rest stays, and the speed below which it rests
    stick_speed: float = 0.0
    pressed: float = 0.0  # how far beyond the stops of the stem what pulls it may go
    second_lag: float = 0.0
    creep: float = 0.0
    creep_tau: float = 30.0
    sensor_lag: float = 0.0
    sensor_play: float = 0.0
    reading: Callable[[float, float], float] = lambda x, _t: x

    def run(
        self, time_s: FloatArray, command: FloatArray, x0: float, step_s: float = 0.002
    ) -> tuple[FloatArray, FloatArray]:
        """Pressure and reading at the rows; `time_s` must be multiples of `step_s`."""
        rows = np.rint((time_s - time_s[0]) / step_s).astype(int)
        late = round(self.delay / step_s)
        fine = np.repeat(command[1:], np.diff(rows))
        fine = self._mixing(np.concatenate([np.full(late, command[0]), fine])[: rows[-1]], step_s)
        p = held = command[0]
        free, broken = replace(self, breakaway=0.0), self._broken()
        w = v = free._play(p - self.push(x0), x0, 0.0, self.grip(x0), self.stretch(x0))  # what the pressure allows
        x = slow = core = x0
        sunk = 0.0
        lagged = self.reading(x, 0.0)
        out_p, out_y = [p], [self.reading(x, 0.0)]
        wanted, rests = set(rows.tolist()), True
        for i, u in enumerate(fine.tolist(), start=1):
            t = i * step_s
            held = u if abs(u - held) > self.hold_band else held
            before = p
            aimed, cut = (inf, self.tank - sunk) if self.tank_cuts else (self.tank - sunk, inf)
            p = min(self._pressure(p, min(self._softly(self.zero + self.gain * held), aimed), step_s), cut)
            sunk += 0.4 * max(p - before, 0.0) - sunk * step_s / 20.0
            now, w = (self if t < self.breaks_s else broken), x if self.in_motion else w
            w = now._play(p - self.push(x), w, t, self.grip(x), self.stretch(x))
            v = w if self.second_lag == 0.0 else v + (w - v) * step_s / self.second_lag
            tau = self.tau_close if v > x else self.tau_open
            speed = min(max((v - x) / tau, -self.rate), self.rate)
            rests = self.held > 0.0 and (rests or abs(speed) < self.stick_speed) and abs(v - x) <= self.held
            x = x if rests else min(max(x + speed * step_s, self.low), self.high)
            slow += (x - slow) * step_s / self.creep_tau
            stem = (1.0 - self.creep) * x + self.creep * slow
            core = max(stem - self.sensor_play / 2, min(stem + self.sensor_play / 2, core))
            y = self.reading(core, t)
            lagged = y if self.sensor_lag == 0.0 else lagged + (y - lagged) * step_s / self.sensor_lag
            if i in wanted:
                out_p.append(p)
                out_y.append(lagged)
        return np.array(out_p), np.array(out_y)

    def _broken(self) -> PlainValve:
        k1, k2 = self.k1 / (1.0 + self.stiffens), self.k2 / (1.0 + self.stiffens)
        return replace(self, a1=self.a1 + self.takes, a2=self.a2 + self.takes, k1=k1, k2=k2)

    def _mixing(self, command: FloatArray, step_s: float) -> FloatArray:
        """The command behind a lag."""
        behind, out = float(command[0]), []
        for u in command.tolist():
            behind = u if self.mixed == 0.0 else behind + (u - behind) * step_s / self.mixed
            out.append(behind)
        return np.array(out)

    def _pressure(self, p: float, goal: float, step_s: float) -> float:
        tau = self.ep_tau * (self.rise if goal > p else self.fall)
        error = goal - p
        clog = self.clog_rise if error > 0.0 else self.clog_fall
        tau *= 0.5 + sqrt(0.25 + clog * abs(error) / tau)
        flow = error - max(-self.overlap, min(error, self.overlap)) + self.leak * error
        flow += self.quick * min(error + self.crack, 0.0)
        new = p + flow * (1.0 - exp(-step_s / tau))
        reach = self.pressure_rate * step_s
        return min(max(p - reach, min(p + reach, new)), self.cut_off)

    def _softly(self, goal: float) -> float:
        """-knee ln(exp(-goal / knee) + exp(-supply / knee))."""
        if self.knee == 0.0:
            return min(goal, self.supply)
        return -self.knee * log(exp(-goal / self.knee) + exp(-self.supply / self.knee))

    def _play(self, p: float, w: float, t: float, grip: float, stretch: float) -> float:
        """The next play output: on the closing curve at least, on the opening curve at most, else where it was."""
        wide = self.grow(t) + grip
        k1, k2 = self.k1 * (1.0 + stretch), self.k2 * (1.0 + stretch)
        need_close = self.a1 + w / k1 + self.bend(w) + self.widen(w) + wide  # pressure that would move it up
        need_open = self.a2 + w / k2 + self.bend(w) - self.widen(w) - wide
        if p > need_close + self.breakaway:
            w = self._solve(p - wide, self.a1, k1, +1.0)
        elif p < need_open - self.breakaway:
            w = self._solve(p + wide, self.a2, k2, -1.0)
        return min(max(w, self.low - self.pressed), self.high + self.pressed)

    def _solve(self, p: float, a: float, k: float, sign: float) -> float:
        """Position at which the curve needs pressure `p`."""
        w = k * (p - a)
        for _ in range(12 if self.bend is not _nothing or self.widen is not _nothing else 0):
            at = min(max(w, 0.0), 0.5625)
            w = k * (p - a - self.bend(at) - sign * self.widen(at))
        return w
