"""Controller numbers from a design model, and the margins that the describing function predicts for them.

What the margins really are is measured by `control.robustness`; the describing function is a little optimistic.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from control.analysis.describing import play_describing_function
from control.analysis.loop import LinearLoop
from control.design import DesignModel, check_for_control

WANTED_MARGIN = 2.0
MOST = 50.0
_NOTHING = 1e-3  # of where a margin is first looked for: a smaller one is none
CAP = 5.0  # in 1 / compliance: an error of the reading's noise, 0.0006 in, then moves the thesis's pressure 0.016 psi


@dataclass(frozen=True, slots=True)
class Margins:
    """How far the loop is from hunting, by describing function. `gain`: factor on all gains until a limit cycle is
    predicted or the linear loop (play wide open) is unstable; `delay_s`: the same in additional dead time of the
    converter [s], `late_s`: in delay of the position reading [s]; `phase_deg`: of the linear loop with the play's full
    slope, at its gain crossover. Infinite where nothing happens."""

    gain: float
    delay_s: float
    late_s: float
    phase_deg: float


@dataclass(frozen=True, slots=True)
class Tuned:
    """Settings for `make_controller`, the predicted margins where frequency analysis applies, and why these numbers."""

    controller: str
    settings: dict[str, float]
    margins: Margins | None
    why: str


def tune(design: DesignModel, tick_s: float, dead_time_s: float = 0.0) -> list[Tuned]:
    """Numbers for every controller.

    Raises: `BadInput` for a design that is not in psi and inches, or without a deadband.
    """
    check_for_control(design)
    base = LinearLoop("p", 1.0, 0.0, design.ep_tau_s, design.tau_s, dead_time_s, tick_s)
    k, tau_s = design.compliance, max(design.tau_s, tick_s)
    p = _linear(lambda s: replace(base, law="p", kp=s / k), design, "P alone")
    accumulating = _linear(lambda s: replace(base, law="p_incremental", kp=s / k), design, "P on an accumulator")
    pi = _linear(lambda s: replace(base, law="pi", kp=s / k, ki=s / (k * tau_s)), design, "integral time = tau")
    wait_s = design.tau_s * math.log(30.0) + 3.0 * design.ep_tau_s + dead_time_s
    rule = {"g": _round(1.0 / k), "update_s": _round(wait_s)}
    rule_why = "g is the slope of the curves; 3 % of a move is still to come when the rule looks again"
    learned = {"kp": rule["g"], "ki": _round(0.25 / (k * wait_s)), "update_s": rule["update_s"]}
    return [
        Tuned("open_loop", {}, None, "nothing to tune: the line midway between the model's curves"),
        p,
        accumulating,
        pi,
        replace(pi, controller="pi_antiwindup"),
        Tuned("if_then_constant", rule, None, rule_why),
        Tuned("if_then_line", rule, None, rule_why),
        Tuned(
            "if_then_pi",
            learned | {"window_in": _round(0.053 * design.travel)},
            None,
            f"{rule_why}; the integral takes back a quarter of a small miss each time",
        ),
        *_rivals(design, dead_time_s),
    ]


def _rivals(design: DesignModel, dead_time_s: float) -> list[Tuned]:
    """Those that no frequency analysis covers: the numbers found on the thesis's valve, scaled to this one."""
    k, travel, tau_s = design.compliance, design.travel, design.tau_s
    scheduled = {"kp": _round(0.5 / k), "ki": _round(0.23 / k)}
    inverse = {
        "tolerance_in": _round(0.002 * travel),
        "window_in": _round(0.018 * travel),
        "patience_s": _round(1.5 * tau_s),
    }
    plays = {
        "spread_psi": _round(0.05 * design.deadband),
        "tolerance_in": _round(0.0021 * travel),
        "window_in": _round(0.18 * travel),
    }
    drive = {"approach_s": _round(1.7 * design.ep_tau_s + dead_time_s), "again_in": _round(0.009 * travel)}
    brake = {
        "tolerance_in": _round(0.00125 * travel),
        "band_in": _round(0.005 * travel),
        "again_in": _round(0.009 * travel),
        "short_in": _round(0.0009 * travel),
        "retreat_psi": _round(min(0.4, 0.5 * design.deadband)),
    }
    plans = {"horizon_s": _round(1.5 * tau_s + dead_time_s), "move_cost_in": _round(0.0021 * travel)}
    whys = {
        "scheduled_pi": (scheduled, "half the slope of the curves, and an integral that covers the other half in 2 s"),
        "inverse_pi": (inverse, "tolerances as shares of travel; patience 1.5 tau; the edges are learned"),
        "prandtl_ishlinskii": (plays, "half widths spread by 5 % of the deadband; tolerances as shares of travel"),
        "mpc": (plans, "plans ahead for 1.5 tau; a move costs 0.2 % of travel, so that small misses stay"),
        "overdrive": (drive, "drives at least as long as the converter needs to brake; small misses are not worth one"),
        "brake": (brake, "shares of travel; the pressure retreats to the middle of the gap at most; edges learned"),
    }
    return [Tuned(name, settings, None, why) for name, (settings, why) in whys.items()]


def margins(loop: LinearLoop, design: DesignModel) -> Margins:
    """How far a loop is from hunting, by describing function."""
    gain = _limit(lambda f: hunts(replace(loop, kp=f * loop.kp, ki=f * loop.ki), design), 1.0, MOST)
    delay = _limit(lambda d: hunts(replace(loop, dead_time_s=loop.dead_time_s + d), design), 0.05, 20.0)
    late = _limit(lambda d: hunts(replace(loop, late_s=loop.late_s + d), design), 0.05, 20.0)
    return Margins(gain, delay, late, phase_margin(loop, design))


def hunts(loop: LinearLoop, design: DesignModel) -> bool:
    """Whether the describing function predicts hunting: at some amplitude, L(jw) N(A) is real and below -1.

    N vanishes for small amplitudes, so that from there the loop goes to a stable limit cycle, or grows without end.
    """
    amplitudes = 0.5 * design.deadband * (1.0 + np.geomspace(1e-3, 1e3, 80))
    n = play_describing_function(amplitudes, design.deadband, design.compliance)
    turned = loop(loop.frequencies(600))[:, None] * n
    before, after = turned[:-1], turned[1:]
    crossing = np.sign(before.imag) != np.sign(after.imag)
    share = before.imag[crossing] / (before.imag[crossing] - after.imag[crossing])
    real = before.real[crossing] + share * (after.real[crossing] - before.real[crossing])
    return bool((real < -1.0).any())


def phase_margin(loop: LinearLoop, design: DesignModel) -> float:
    """Of the linear loop with the play's full slope [degrees]; infinite where the gain never reaches 1."""
    line = loop(loop.frequencies(4000)) * design.compliance
    crossing = np.nonzero((np.abs(line[:-1]) >= 1.0) & (np.abs(line[1:]) < 1.0))[0]
    if crossing.size == 0:
        return float("inf")
    phase = np.unwrap(np.angle(line))
    return float(180.0 + np.degrees(phase[crossing].min()))


def _linear(make: Callable[[float], LinearLoop], design: DesignModel, form: str) -> Tuned:
    """The largest gain that leaves WANTED_MARGIN before hunting is predicted, at most CAP / compliance."""
    found = _limit(lambda s: hunts(make(s * WANTED_MARGIN), design), 0.02, CAP)
    loop = make(min(found, CAP))
    settings = {"kp": _round(loop.kp)} | ({"ki": _round(loop.ki)} if loop.law == "pi" else {})
    if found < CAP:
        why = f"{form}; hunting is predicted at {WANTED_MARGIN:g} times this gain"
    else:
        why = f"{form}; the cap of {CAP:g} / compliance, for the noise; prediction would allow more"
    return Tuned(loop.law, settings, margins(loop, design), why)


def _limit(bad: Callable[[float], bool], low: float, high: float) -> float:
    """Where `bad` begins, to 1 %, on the good side; infinite where it does not begin below `high`, 0 where it is bad
    down to `_NOTHING` of `low`.

    Goes up in steps of at most 40 %: `bad` need not be monotonic far above the point where it begins. Where it is bad
    at `low` already, it first goes down.
    """
    good, step = low, 1.4
    while bad(good):
        good /= step
        if good < _NOTHING * low:
            return 0.0
    while good < high:
        if bad(good * step):
            if step < 1.01:
                return good
            step = 1.0 + 0.5 * (step - 1.0)
        else:
            good *= step
    return float("inf")


def _round(value: float) -> float:
    return float(f"{value:.3g}")
