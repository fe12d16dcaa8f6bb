"""The drift alarm: a two-sided CUSUM on the whitened residual of the bench, with a stated false-alarm rate.

It answers a lasting shift of the residual, not a short one: the reference value is half of the smallest shift that
matters. A model error adds up from there on, and with noise on it somewhat earlier: at the half itself the sum is a
walk without drift, which reaches any limit. Up to where the stated rate holds is told by `Cusum.forgives`.
Source: Page, Biometrika 41 (1954) 100; Siegmund, Sequential Analysis (Springer 1985), ch. 2 (average run length).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

#: Excess over the boundary of a Gaussian walk, Siegmund's correction of its continuous approximation.
_OVERSHOOT = 1.166
#: Whitened shift above which Siegmund's formula is no longer good to a few percent.
_LARGEST_SHIFT = 1.5
#: Noise this small against what innovations are scaled to is none.
_QUIET = 1e-3


@dataclass(frozen=True, slots=True)
class AlarmRules:
    """`shift` is the smallest lasting shift that matters, as a share of travel; it shall be noticed within `within_s`
    unless noise forbids it; without any shift an alarm comes once in `false_alarm_s` on average, or less often."""

    shift: float = 0.02
    within_s: float = 5.0
    false_alarm_s: float = 360_000.0


@dataclass(frozen=True, slots=True)
class Cusum:
    """`scale` makes innovations unit or less, `phi` is the noise's memory from sample to sample, `reference` what is
    subtracted at each step, `limit` where the alarm is. `delay_s`: mean time to notice the smallest shift. `forgives`:
    lasting error of the model [unit of the residual] up to which false alarms are as rare as stated."""

    phi: float
    scale: float
    reference: float
    limit: float
    delay_s: float
    forgives: float

    def step(self, state: CusumState, residual: float, time_s: float) -> CusumState:
        """The state after one more residual; NaN holds it."""
        if not math.isfinite(residual):
            return CusumState(state.high, state.low, None, state.since_high_s, state.since_low_s)
        # after a gap the last residual is unknown: its expectation under a lasting shift is this one
        before = residual if state.last is None else state.last
        value = (residual - self.phi * before) / self.scale
        high = min(max(state.high + value - self.reference, 0.0), 2.0 * self.limit)
        low = min(max(state.low - value - self.reference, 0.0), 2.0 * self.limit)
        since_high_s = time_s if state.high == 0.0 else state.since_high_s
        since_low_s = time_s if state.low == 0.0 else state.since_low_s
        return CusumState(high, low, residual, since_high_s, since_low_s)

    def statistic(self, state: CusumState) -> float:
        """The larger sum in units of the limit, with the sign of the shift: an alarm from +1 up and from -1 down."""
        return state.high / self.limit if state.high >= state.low else -state.low / self.limit


@dataclass(frozen=True, slots=True)
class CusumState:
    """Sums for a shift up and down, the last residual, and when each sum left zero [s]."""

    high: float = 0.0
    low: float = 0.0
    last: float | None = None
    since_high_s: float = 0.0
    since_low_s: float = 0.0


def design_cusum(shift: float, sigma: float, phi: float, period_s: float, rules: AlarmRules) -> Cusum:
    """The alarm for residuals with noise of standard deviation `sigma` and lag-one correlation `phi`.

    `shift` is in the unit of the residual. Where the noise is small the innovations are scaled down until the shift
    takes `within_s` to be noticed, which makes false alarms rarer than stated and short misses harmless.
    """
    innovation = sigma * math.sqrt(1.0 - phi**2)
    most = shift * (1.0 - phi) / innovation if innovation > 0.0 else _LARGEST_SHIFT
    samples = max(rules.false_alarm_s / period_s, 10.0)
    patient = _shift_noticed_in(rules.within_s / period_s, samples)
    whitened = min(most, patient)
    reference = 0.5 * whitened
    limit = limit_for(reference, samples)
    scale = shift * (1.0 - phi) / whitened
    loud = max(innovation / scale, _QUIET)  # the whitened noise's own standard deviation
    forgives = loud * scale / (1.0 - phi) * _forgiven(limit / loud, reference / loud, samples)
    return Cusum(phi, scale, reference, limit, period_s * limit / reference, forgives)


def _forgiven(limit: float, reference: float, samples: float) -> float:
    """The largest shift with which an alarm still comes once in `samples` on average, or less often; 0 for none."""
    low, high = 0.0, reference
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if run_length(limit, reference, middle) >= samples else (low, middle)
    return low


def run_length(limit: float, reference: float, shift: float = 0.0) -> float:
    """Mean samples to the alarm of a two-sided CUSUM on independent unit Gaussians of mean `shift` (Siegmund)."""
    up, down = (_one_sided(limit, reference, sign * shift) for sign in (1.0, -1.0))
    return 1.0 / (1.0 / up + 1.0 / down)


def limit_for(reference: float, samples: float) -> float:
    """The limit at which a false alarm comes once in `samples` on average; at least a small positive one."""
    low, high = 1e-6, 1.0
    while run_length(high, reference) < samples:
        high *= 2.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if run_length(middle, reference) < samples else (low, middle)
    return high


def _one_sided(limit: float, reference: float, shift: float) -> float:
    drift, reach = shift - reference, limit + _OVERSHOOT
    if abs(drift) * reach < 1e-4:
        return reach**2
    return (math.exp(min(-2.0 * drift * reach, 600.0)) + 2.0 * drift * reach - 1.0) / (2.0 * drift**2)


def _shift_noticed_in(steps: float, samples: float) -> float:
    """The whitened shift that the alarm tuned to it notices in `steps` samples on average."""
    low, high = 1e-3, _LARGEST_SHIFT
    for _ in range(50):
        middle = math.sqrt(low * high)
        slow = limit_for(0.5 * middle, samples) / (0.5 * middle) > steps
        low, high = (middle, high) if slow else (low, middle)
    return high
