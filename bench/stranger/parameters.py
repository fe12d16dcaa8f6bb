"""Nothing is missing from the design, but one of its numbers is off; sizes are relative, or in psi."""

from __future__ import annotations

import numpy as np

from bench.stranger.form import Form, ep, sign, stem
from bench.stranger.valve import Valve


def deadband(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    half = 0.5 * sign(rng) * size
    return stem(valve, closing_psi=valve.stem.closing_psi + half, opening_psi=valve.stem.opening_psi - half)


def offset(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    shift = sign(rng) * size
    return stem(valve, closing_psi=valve.stem.closing_psi + shift, opening_psi=valve.stem.opening_psi + shift)


def compliance(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    factor = (1.0 + size) ** sign(rng)
    return stem(valve, k_closing=valve.stem.k_closing * factor, k_opening=valve.stem.k_opening * factor)


def tau(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    factor = (1.0 + size) ** sign(rng)
    return stem(valve, tau_closing_s=valve.stem.tau_closing_s * factor, tau_opening_s=valve.stem.tau_opening_s * factor)


def rate_limit(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """Slower only: a higher limit than the design's seldom binds."""
    return stem(valve, rate_limit_in_s=valve.stem.rate_limit_in_s / (1.0 + size))


def ep_tau(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    factor = (1.0 + size) ** sign(rng)
    return ep(valve, tau_fill_s=valve.ep.tau_fill_s * factor, tau_exhaust_s=valve.ep.tau_exhaust_s * factor)


PARAMETER_FORMS = (
    Form("parameter:deadband", "both_curves", "actuator", "psi", 0.005, 1.0, deadband),
    Form("parameter:offset", "both_curves", "actuator", "psi", 0.003, 1.0, offset),
    Form("parameter:compliance", "both_curves", "actuator", "1", 0.002, 0.3, compliance),
    Form("parameter:tau", "both_ways", "actuator", "1", 0.005, 1.5, tau),
    Form("parameter:rate_limit", "slower", "actuator", "1", 0.02, 4.0, rate_limit),
    Form("parameter:ep_tau", "both_ways", "ep", "1", 0.03, 4.0, ep_tau),
)
