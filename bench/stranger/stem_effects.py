"""The actuator's causes that concern friction, play and motion, each in the forms that a stranger could mean."""

from __future__ import annotations

import numpy as np

from bench.stranger.form import Form, sign, stem, weather
from bench.stranger.valve import BAND_PSI, Valve


def karnopp(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """The standing stem needs `size` more than sliding friction to break away, and stands again near its target."""
    return stem(valve, stick_psi=size)


def slip_jump(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """Choudhury: whenever the stem has stood, it moves only after the band and `size`, with a jump."""
    return stem(valve, jump_psi=size)


def stick_stairs(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """Stenman: the stem goes on in jumps of `size`."""
    return stem(valve, stair_psi=size)


def slower_opening(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return stem(valve, tau_opening_s=valve.stem.tau_opening_s * (1.0 + size))


def slower_closing(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return stem(valve, tau_closing_s=valve.stem.tau_closing_s * (1.0 + size))


def unequal_damping(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    ratio = (1.0 + size) ** sign(rng)
    return stem(valve, tau_closing_s=valve.stem.tau_closing_s * ratio, tau_opening_s=valve.stem.tau_opening_s / ratio)


def friction_in_motion(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """`size` is the part of the deadband that acts as friction inside the force balance; the rest stays a play."""
    return stem(valve, friction_share=size)


def even_spread(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return stem(valve, spread=size)


def skewed_spread(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return stem(valve, spread=size, skewed=1.0)


def local_bump(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """A worn place in the packing: tighter or looser by `size` on either side [psi]."""
    way = sign(rng)
    place, width = float(rng.uniform(0.12, 0.42)), float(rng.uniform(0.06, 0.1))
    return stem(valve, bump_psi=way * size, bump_at_in=place, bump_width_in=width)


def wavy_friction(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return stem(valve, wave_psi=size, wave_length_in=float(rng.uniform(0.25, 0.45)))


def warm_up(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """The deadband goes exponentially to another width (smaller mostly: grease warms)."""
    way, tau_s = (-1.0 if rng.uniform() < 0.7 else 1.0), float(rng.uniform(100.0, 300.0))
    return weather(valve, BAND_PSI, lambda time_s: way * size * (1.0 - np.exp(-time_s / tau_s)))


def wear(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """The deadband changes in a straight line, by `size` psi in ten minutes."""
    way = sign(rng)
    return weather(valve, BAND_PSI, lambda time_s: way * size * time_s / 600.0)


def plug_lag(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return stem(valve, plug_tau_s=size)


def stem_lag(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return stem(valve, stem_tau_s=size)


def tubing_lag(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """The pressure at the diaphragm lags the pressure that the converter measures."""
    return stem(valve, tubing_tau_s=size)


STEM_FORMS = (
    Form("stiction", "karnopp", "actuator", "psi", 0.02, 2.0, karnopp),
    Form("stiction", "slip_jump", "actuator", "psi", 0.02, 2.0, slip_jump),
    Form("stiction", "stairs", "actuator", "psi", 0.02, 1.5, stick_stairs),
    Form("asymmetric_damping", "slower_opening", "actuator", "1", 0.005, 3.0, slower_opening),
    Form("asymmetric_damping", "slower_closing", "actuator", "1", 0.005, 3.0, slower_closing),
    Form("asymmetric_damping", "both", "actuator", "1", 0.005, 1.5, unequal_damping),
    Form("friction_in_motion", "share", "actuator", "1", 0.02, 1.0, friction_in_motion),
    Form("distributed_hysteresis", "even", "actuator", "1", 0.05, 0.95, even_spread),
    Form("distributed_hysteresis", "skewed", "actuator", "1", 0.05, 0.95, skewed_spread),
    Form("position_dependent_friction", "bump", "actuator", "psi", 0.01, 0.45, local_bump),
    Form("position_dependent_friction", "wave", "actuator", "psi", 0.01, 0.18, wavy_friction),
    Form("friction_drift", "warm_up", "actuator", "psi", 0.01, 1.5, warm_up),
    Form("friction_drift", "wear", "actuator", "psi", 0.01, 1.5, wear),
    Form("additional_lag", "plug", "actuator", "s", 0.02, 2.5, plug_lag),
    Form("additional_lag", "stem", "actuator", "s", 0.02, 2.5, stem_lag),
    Form("additional_lag", "tubing", "actuator", "s", 0.02, 2.5, tubing_lag),
)
