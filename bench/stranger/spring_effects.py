"""The actuator's causes that concern its static curve and its slow tail, each in the forms that a stranger could mean.

A flow force that is linear in the opening is left out: it is another compliance and another offset, exactly.
"""

from __future__ import annotations

import numpy as np

from bench.stranger.form import Form, sign, stem
from bench.stranger.valve import Valve


def closing_spring(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return stem(valve, k_closing=valve.stem.k_closing * (1.0 + sign(rng) * size))


def both_springs(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    way = sign(rng)
    return stem(
        valve,
        k_closing=valve.stem.k_closing * (1.0 + 0.5 * way * size),
        k_opening=valve.stem.k_opening * (1.0 - 0.5 * way * size),
    )


def cubic_spring(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return stem(valve, cubic=sign(rng) * size)


def effective_area(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """The diaphragm's effective area falls with the stroke."""
    return stem(valve, area=size)


def bowed_spring(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """Softer or stiffer in the middle; both ends stay where the design has them."""
    return stem(valve, bow=sign(rng) * size)


def stem_creep(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return stem(valve, creep_share=size, creep_tau_s=float(rng.uniform(15.0, 90.0)))


def two_tails(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    fast_s, slow_s = float(rng.uniform(10.0, 25.0)), float(rng.uniform(80.0, 200.0))
    return stem(valve, creep_share=0.6 * size, creep_tau_s=fast_s, tail_share=0.4 * size, tail_tau_s=slow_s)


def diaphragm_creep(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """The diaphragm passes a part of the force on late: the tail goes through the play."""
    return stem(valve, diaphragm_share=size, diaphragm_tau_s=float(rng.uniform(15.0, 90.0)))


def upper_stop(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return stem(valve, high_stop_in=valve.stem.high_stop_in - size)


def lower_stop(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return stem(valve, low_stop_in=valve.stem.low_stop_in + size)


def square_flow(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return stem(valve, flow_square_psi=sign(rng) * size)


def seat_suction(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """Near its seat the plug is pulled in (flow to close) or pushed away (flow to open)."""
    return stem(valve, flow_seat_psi=sign(rng) * size)


def arched_flow(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return stem(valve, flow_arch_psi=sign(rng) * size)


SPRING_FORMS = (
    Form("spring_asymmetry", "closing", "actuator", "1", 0.003, 0.4, closing_spring),
    Form("spring_asymmetry", "both", "actuator", "1", 0.003, 0.5, both_springs),
    Form("nonlinear_spring", "cubic", "actuator", "1", 0.003, 0.3, cubic_spring),
    Form("nonlinear_spring", "area", "actuator", "1", 0.003, 0.5, effective_area),
    Form("nonlinear_spring", "bow", "actuator", "1", 0.003, 0.4, bowed_spring),
    Form("creep", "stem", "actuator", "1", 0.003, 0.3, stem_creep),
    Form("creep", "two_tails", "actuator", "1", 0.003, 0.3, two_tails),
    Form("creep", "diaphragm", "actuator", "1", 0.003, 0.3, diaphragm_creep),
    Form("reduced_travel", "upper", "actuator", "in", 0.002, 0.12, upper_stop),
    Form("reduced_travel", "lower", "actuator", "in", 0.002, 0.12, lower_stop),
    Form("flow_force", "square", "actuator", "psi", 0.01, 1.0, square_flow),
    Form("flow_force", "seat", "actuator", "psi", 0.01, 0.3, seat_suction),
    Form("flow_force", "arch", "actuator", "psi", 0.01, 0.55, arched_flow),
)
