"""Controller numbers from a design model, and the margins that they leave before the play makes the loop hunt."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from control.analysis.limit_cycle import predict
from control.analysis.loop import LinearLoop
from control.design import DesignModel

WANTED_MARGIN = 2.0
MOST = 50.0


@dataclass(frozen=True, slots=True)
class Margins:
    """How far the loop is from hunting. `gain`: factor on all gains until a limit cycle is predicted or the linear loop
    (play wide open) is unstable; `delay_s`: the same in additional dead time [s]; `phase_deg`: of the linear loop with
    the play's full slope, at its gain crossover. Infinite where nothing happens."""

    gain: float
    delay_s: float
    phase_deg: float


@dataclass(frozen=True, slots=True)
class Tuned:
    """Settings for `make_controller`, the margins where frequency analysis applies, and why these numbers."""

    controller: str
    settings: dict[str, float]
    margins: Margins | None
    why: str


def tune(design: DesignModel, tick_s: float, dead_time_s: float = 0.0) -> list[Tuned]:
    """Numbers for every controller whose numbers depend on the valve."""
    base = LinearLoop("p", 1.0, 0.0, design.ep_tau_s, design.tau_s, dead_time_s, tick_s)
    k = design.compliance
    pi = _largest(lambda s: replace(base, law="pi", kp=s / k, ki=s / (k * max(design.tau_s, tick_s))), design)
    accumulating = _largest(lambda s: replace(base, law="p_incremental", kp=s / k), design)
    proportional = _largest(lambda s: replace(base, law="p", kp=s / k), design)
    wait_s = design.tau_s * math.log(30.0) + 3.0 * design.ep_tau_s + dead_time_s
    left = math.exp(-(wait_s - 3.0 * design.ep_tau_s - dead_time_s) / design.tau_s) if design.tau_s else 0.0
    pi_why = f"integral time = tau; the largest gain that leaves a factor of {WANTED_MARGIN:g} before hunting"
    return [
        Tuned("p", {"kp": _round(proportional.kp)}, margins(proportional, design), "as above, without the integral"),
        Tuned("p_incremental", {"kp": _round(accumulating.kp)}, margins(accumulating, design), pi_why.split("; ")[1]),
        Tuned("pi", {"kp": _round(pi.kp), "ki": _round(pi.ki)}, margins(pi, design), pi_why),
        Tuned("pi_antiwindup", {"kp": _round(pi.kp), "ki": _round(pi.ki)}, margins(pi, design), pi_why),
        *(
            Tuned(name, {"g": _round(1.0 / k), "update_s": _round(wait_s)}, None, _rule_why(left))
            for name in ("if_then_constant", "if_then_line")
        ),
        *_rivals(design, dead_time_s),
    ]


def _rivals(design: DesignModel, dead_time_s: float) -> list[Tuned]:
    """Those that no frequency analysis covers."""
    k = design.compliance
    return [
        Tuned(
            "scheduled_pi",
            {"kp": _round(0.5 / k), "ki": _round(0.23 / k)},
            None,
            "half the slope of the curves, and an integral that covers the other half in 2 s",
        ),
        Tuned(
            "overdrive",
            {"approach_s": _round(1.7 * design.ep_tau_s + dead_time_s), "again_in": _round(0.009 * design.travel)},
            None,
            "the drive lasts at least as long as the converter needs to brake; small misses are not worth one",
        ),
        Tuned(
            "brake",
            {
                "tolerance_in": _round(0.00125 * design.travel),
                "band_in": _round(0.005 * design.travel),
                "again_in": _round(0.009 * design.travel),
                "short_in": _round(0.0009 * design.travel),
                "retreat_psi": _round(min(0.4, 0.5 * design.deadband)),
            },
            None,
            "shares of travel; the pressure retreats to the middle of the gap at most; the edges are learned",
        ),
    ]


def margins(loop: LinearLoop, design: DesignModel) -> Margins:
    """How far a loop is from hunting."""
    gain = _limit(lambda f: hunts(replace(loop, kp=f * loop.kp, ki=f * loop.ki), design), 1.0, MOST)
    delay = _limit(lambda d: hunts(replace(loop, dead_time_s=loop.dead_time_s + d), design), 0.05, 20.0)
    return Margins(gain, delay, phase_margin(loop, design))


def hunts(loop: LinearLoop, design: DesignModel) -> bool:
    """Whether a limit cycle is predicted, or the loop with the play wide open is unstable."""
    omega = np.geomspace(1e-3, np.pi / loop.tick_s if loop.tick_s else 1e3, 400)
    line = loop(omega) * design.compliance
    crossing = (np.diff(np.sign(line.imag)) != 0) & (line.real[:-1] < -1.0)
    return bool(crossing.any()) or any(cycle.stable for cycle in predict(loop, design, n=60, points=300))


def phase_margin(loop: LinearLoop, design: DesignModel) -> float:
    """Of the linear loop with the play's full slope [degrees]; infinite where the gain never reaches 1."""
    omega = np.geomspace(1e-3, np.pi / loop.tick_s if loop.tick_s else 1e3, 4000)
    line = loop(omega) * design.compliance
    crossing = np.nonzero((np.abs(line[:-1]) >= 1.0) & (np.abs(line[1:]) < 1.0))[0]
    if crossing.size == 0:
        return float("inf")
    phase = np.unwrap(np.angle(line))
    return float(180.0 + np.degrees(phase[crossing].min()))


def _largest(make: Callable[[float], LinearLoop], design: DesignModel) -> LinearLoop:
    """The largest scale at which WANTED_MARGIN times the gain does not hunt yet, at most 5."""
    return make(min(_limit(lambda s: hunts(make(s * WANTED_MARGIN), design), 0.02, 5.0), 5.0))


def _limit(bad: Callable[[float], bool], low: float, high: float) -> float:
    """Where `bad` begins, to 1 %, on the good side; infinite where it does not begin below `high`.

    Goes up in steps of at most 40 %: `bad` need not be monotonic far above the point where it begins.
    """
    good, step = low, 1.4
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


def _rule_why(left: float) -> str:
    return f"g is the slope of the curves; {100 * left:.0f} % of a move is still to come when the rule looks again"
