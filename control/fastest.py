"""The physical minimum of a step: how soon a valve with given numbers can be inside a band about a target, and stay."""

from __future__ import annotations

import math
from dataclasses import dataclass

from control.design import DesignModel
from control.observer import follow

STEP_S = 0.002


@dataclass(frozen=True, slots=True)
class Supply:
    """What the converter can do [psi]: where it settles for the highest and for the lowest command, the pressure that
    it never exceeds, and for how long it does not answer [s]."""

    full_psi: float = 20.0
    empty_psi: float = 0.0
    ceiling_psi: float = float("inf")
    dead_time_s: float = 0.0


@dataclass(slots=True)
class _Motion:
    """Pressure, play output, stem and time during one way there; closing is positive, whatever the valve does."""

    p: float
    w: float
    x: float
    t: float = 0.0


def fastest_s(
    valve: DesignModel, supply: Supply, start: tuple[float, float], target_in: float, band_in: float
) -> float:
    """The least time [s] from rest at `start` (pressure [psi], position [in]) until the stem is within `band_in` of
    `target_in` for good; 0 where it is already.

    Bang-bang, which is optimal because every stage is monotonic: full supply (or none) for as long as the opposite
    command can still bring the play output back to the far side of the band before the stem gets there; then that.
    The bound has the dead time, the converter's lag, the crossing of the deadband (and back again where the valve must
    brake), the rate limit and the lag of the stem in it; it knows the true state and no ticks. A target at a stop needs
    no braking. Solved in steps of 2 ms, the switching instant to the same.
    """
    if abs(target_in - start[1]) <= band_in:
        return 0.0
    closing = target_in > start[1]
    far_in = target_in + band_in if closing else target_in - band_in
    needs_brake = 0.0 < far_in < valve.travel
    low, high = 0, _first_inside(valve, supply, start, target_in, band_in, closing)
    if high is None:
        return math.inf
    if not needs_brake or _lands(valve, supply, start, far_in, closing, high):
        return supply.dead_time_s + high * STEP_S
    while high - low > 1:
        middle = (low + high) // 2
        if _lands(valve, supply, start, far_in, closing, middle):
            low = middle
        else:
            high = middle
    return supply.dead_time_s + _arrival_s(valve, supply, start, target_in, band_in, closing, low)


def _begin(valve: DesignModel, start: tuple[float, float]) -> _Motion:
    return _Motion(start[0], min(max(start[1], 0.0), valve.travel), start[1])


def _move(m: _Motion, valve: DesignModel, supply: Supply, to_full: bool) -> None:
    share = 1.0 - math.exp(-STEP_S / valve.ep_tau_s) if valve.ep_tau_s > 0.0 else 1.0
    m.p = min(m.p + share * ((supply.full_psi if to_full else supply.empty_psi) - m.p), supply.ceiling_psi)
    k = valve.compliance
    w = min(max(k * (m.p - valve.a1), min(k * (m.p - valve.a2), m.w), 0.0), valve.travel)
    m.x = follow(m.x, 0.5 * (m.w + w), valve.tau_s, valve.rate_limit, STEP_S)
    m.w, m.t = w, m.t + STEP_S


def _first_inside(
    valve: DesignModel,
    supply: Supply,
    start: tuple[float, float],
    target_in: float,
    band_in: float,
    closing: bool,
) -> int | None:
    """After how many steps of full drive the stem is inside the band; None where it never gets there."""
    m = _begin(valve, start)
    for count in range(30_000):
        if abs(target_in - m.x) <= band_in:
            return count
        _move(m, valve, supply, closing)
    return None


def _lands(
    valve: DesignModel, supply: Supply, start: tuple[float, float], far_in: float, closing: bool, driven: int
) -> bool:
    """Whether, after `driven` steps of full drive, braking gets the play output back before the stem is too far."""
    m, way = _begin(valve, start), 1.0 if closing else -1.0
    for count in range(30_000):
        if way * (m.x - far_in) > 0.0:
            return False
        if count >= driven and way * (m.w - far_in) <= 0.0:
            return True
        _move(m, valve, supply, closing if count < driven else not closing)
    return False


def _arrival_s(
    valve: DesignModel,
    supply: Supply,
    start: tuple[float, float],
    target_in: float,
    band_in: float,
    closing: bool,
    driven: int,
) -> float:
    """When the stem is inside, if the drive ends after `driven` steps and the brake at the far side of the band."""
    m, way = _begin(valve, start), 1.0 if closing else -1.0
    far_in = target_in + way * band_in
    for count in range(30_000):
        if abs(target_in - m.x) <= band_in:
            return m.t
        braked = count >= driven and way * (m.w - far_in) <= 0.0
        if braked:
            m.x = follow(m.x, m.w, valve.tau_s, valve.rate_limit, STEP_S)
            m.t += STEP_S
        else:
            _move(m, valve, supply, closing if count < driven else not closing)
    return math.inf
