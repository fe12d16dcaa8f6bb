"""What changes in a valve as time goes by, whatever it does: the width of its play, and a spring that breaks."""

from __future__ import annotations

import numpy as np
from scipy.special import expit

from logs.recording import FloatArray
from twin.kernels.active import acts
from twin.kernels.slots import FOREVER
from twin.kernels.valve_slots import (
    V_BREAKS,
    V_BREAKS_S,
    V_DRIFT_AMP,
    V_DRIFT_RATE,
    V_DRIFT_TAU_S,
    V_HALF,
    V_MIDDLE,
    V_OUTER,
    V_STEP,
    V_STEP_EASES,
    V_STEP_EASES_S,
    V_STEP_TAKES_S,
    V_STEP_TIME_S,
    V_STIFFENS,
)

_WIDENING = np.array([V_DRIFT_RATE, V_DRIFT_AMP, V_STEP, V_STIFFENS])


def widens(c: FloatArray) -> bool:
    """Whether the play gets wider or narrower."""
    return acts(c, _WIDENING)


def widening_at(t: FloatArray, c: FloatArray) -> FloatArray:
    """How much wider the half deadband is than at the start [pressure], at times `t` [s] since then, shape of `t`.

    An outer play takes its width from that of the play behind it.
    """
    widening: FloatArray = c[V_DRIFT_RATE] * t - c[V_OUTER]
    if c[V_DRIFT_AMP] != 0.0:
        widening -= c[V_DRIFT_AMP] * np.expm1(-t / c[V_DRIFT_TAU_S])
    if c[V_STEP] != 0.0:
        since = t - c[V_STEP_TIME_S]
        gone = c[V_STEP_EASES] * -np.expm1(-np.maximum(since, 0.0) / c[V_STEP_EASES_S])
        come = expit(since / c[V_STEP_TAKES_S]) if c[V_STEP_TAKES_S] > 0.0 else since >= 0.0
        widening += c[V_STEP] * come * (1.0 - gone)
    if c[V_STIFFENS] != 0.0:  # the same friction is less of a stiffer spring
        widening += np.where(t >= c[V_BREAKS_S], c[V_HALF] * (1.0 / (1.0 + c[V_STIFFENS]) - 1.0), 0.0)
    return widening


def breaks(c: FloatArray) -> bool:
    """Whether the spring is another one from some time on."""
    return bool(c[V_BREAKS_S] < FOREVER)


def as_unbroken(force: FloatArray, t: FloatArray, c: FloatArray) -> FloatArray:
    """What the old spring takes as much of as the one that there is takes of `force` at times `t`, shape of both."""
    old = c[V_MIDDLE] + (force - c[V_MIDDLE] - c[V_BREAKS]) / (1.0 + c[V_STIFFENS])
    return np.where(t < c[V_BREAKS_S], force, old)
