"""The linear part of the position loop in the frequency domain, with or without converter lag, dead time and sampling.

A loop is cut at the play: `before_play` leads from the position error to the pressure at the play, `after_play` from
the play's output to the stem.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

ComplexArray = npt.NDArray[np.complex128]
FloatArray = npt.NDArray[np.float64]
LawName = Literal["p", "p_incremental", "pi"]


@dataclass(frozen=True, slots=True)
class LinearLoop:
    """Law and linear dynamics. `tick_s` of 0 is a continuous loop without delay; otherwise a reading is answered one
    tick later and held for a tick, as on the bench. Gains: kp in psi/in, ki in psi/(in s). `dead_time_s` is the
    converter's, before the pressure reading; `late_s` is the delay of the position reading (LVDT, its filter)."""

    law: LawName
    kp: float
    ki: float = 0.0
    ep_tau_s: float = 0.30
    stem_tau_s: float = 2.7
    dead_time_s: float = 0.0
    tick_s: float = 0.1
    late_s: float = 0.0

    def converter(self, omega: FloatArray) -> ComplexArray:
        """From command to pressure, sampled: answer after a tick, hold, dead time, lag. Shape as `omega` [rad/s]."""
        s = 1j * omega
        delay = np.exp(-s * (self.tick_s + self.dead_time_s))
        half = 0.5 * omega * self.tick_s
        hold = np.sinc(half / np.pi) * np.exp(-1j * half)
        return _complex(delay * hold / (self.ep_tau_s * s + 1.0))

    def before_play(self, omega: FloatArray) -> ComplexArray:
        """From position error [in] to the pressure at the play [psi].

        The incremental P law adds to the measured pressure: command = pressure + kp e, which closes an inner loop
        around the converter and makes an accumulator of it. A late position reading delays the error, and is not in
        that inner loop.
        """
        through, late = self.converter(omega), np.exp(-1j * omega * self.late_s)
        if self.law == "p_incremental":
            return _complex(late * self.kp * through / (1.0 - through))
        if self.law == "pi":
            return _complex(late * through * (self.kp + self.ki * self._integrator(omega)))
        return _complex(late * through * self.kp)

    def after_play(self, omega: FloatArray) -> ComplexArray:
        """From the play's output to the stem, without the rate limit."""
        return _complex(1.0 / (1j * omega * self.stem_tau_s + 1.0))

    def __call__(self, omega: FloatArray) -> ComplexArray:
        """The whole linear part [psi/in]; the play, with its slope in in/psi, closes the loop."""
        return self.before_play(omega) * self.after_play(omega)

    def frequencies(self, points: int) -> FloatArray:
        """A grid from 0.001 rad/s to where sampling ends, or to 1000 rad/s in continuous time, shape (points,)."""
        return np.geomspace(1e-3, np.pi / self.tick_s if self.tick_s else 1e3, points)

    def _integrator(self, omega: FloatArray) -> ComplexArray:
        if self.tick_s == 0.0:
            return _complex(1.0 / (1j * omega))
        z = np.exp(1j * omega * self.tick_s)
        return _complex(self.tick_s / (z - 1.0))


def _complex(values: npt.ArrayLike) -> ComplexArray:
    return np.asarray(values, dtype=np.complex128)


def thesis_loop() -> LinearLoop:
    """Figure 2-8: a first-order lag and nothing else."""
    return LinearLoop("p", kp=1.0, ep_tau_s=0.0, tick_s=0.0)
