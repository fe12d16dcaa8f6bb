"""The converter's causes, each in the forms that a stranger could mean by its line in the vocabulary."""

from __future__ import annotations

import numpy as np

from bench.stranger.form import Form, ep, sign
from bench.stranger.valve import Valve

HIGHEST_PSI = 14.0  # no command of a bench goes higher


def dead_time(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return ep(valve, delay_s=size)


def zero_error(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return ep(valve, zero_psi=sign(rng) * size)


def gain_error(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """A span error of a converter whose zero was set at the low end of its 3..15 psi."""
    gain = 1.0 + sign(rng) * size
    return ep(valve, gain=gain, zero_psi=3.0 * (1.0 - gain))


def gain_and_zero_error(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    gain = 1.0 + sign(rng) * size
    return ep(valve, gain=gain, zero_psi=sign(rng) * 6.0 * size)


def hold_band(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """A new command is taken over, whole, only when it differs by more than the band."""
    return ep(valve, hold_psi=size)


def input_play(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return ep(valve, play_psi=size)


def pilot_overlap(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """The pilot shuts while the pressure is still `size` short of the command, on either side."""
    return ep(valve, overlap_psi=size)


def slow_exhaust(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return ep(valve, tau_exhaust_s=valve.ep.tau_exhaust_s * (1.0 + size))


def slow_fill(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return ep(valve, tau_fill_s=valve.ep.tau_fill_s * (1.0 + size))


def both_unequal(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    ratio = (1.0 + size) ** sign(rng)
    return ep(valve, tau_fill_s=valve.ep.tau_fill_s * ratio, tau_exhaust_s=valve.ep.tau_exhaust_s / ratio)


def flow_limit(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """Size is the time [s] that one psi takes at the limit."""
    return ep(valve, rise_limit_psi_s=1.0 / max(size, 1e-9), fall_limit_psi_s=1.0 / max(size, 1e-9))


def fill_limit(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return ep(valve, rise_limit_psi_s=1.0 / max(size, 1e-9))


def regulated_supply(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """Size is what is missing below the highest command [psi]."""
    return ep(valve, target_ceiling_psi=HIGHEST_PSI - size)


def cut_off_supply(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return ep(valve, pressure_ceiling_psi=HIGHEST_PSI - size)


def drooping_supply(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return ep(valve, soft_ceiling_psi=HIGHEST_PSI + 3.0 - size if size > 0.0 else 1e9)


EP_FORMS = (
    Form("dead_time", "pure", "ep", "s", 0.01, 4.0, dead_time),
    Form("ep_calibration", "zero", "ep", "psi", 0.003, 1.0, zero_error),
    Form("ep_calibration", "gain", "ep", "1", 0.0005, 0.12, gain_error),
    Form("ep_calibration", "both", "ep", "1", 0.0005, 0.12, gain_and_zero_error),
    Form("ep_deadband", "hold", "ep", "psi", 0.01, 1.2, hold_band),
    Form("ep_deadband", "play", "ep", "psi", 0.005, 1.2, input_play),
    Form("ep_deadband", "overlap", "ep", "psi", 0.003, 0.8, pilot_overlap),
    Form("fill_exhaust_asymmetry", "slow_exhaust", "ep", "1", 0.03, 6.0, slow_exhaust),
    Form("fill_exhaust_asymmetry", "slow_fill", "ep", "1", 0.03, 6.0, slow_fill),
    Form("fill_exhaust_asymmetry", "both", "ep", "1", 0.03, 4.0, both_unequal),
    Form("ep_rate_limit", "both_ways", "ep", "s/psi", 0.05, 10.0, flow_limit),
    Form("ep_rate_limit", "filling", "ep", "s/psi", 0.05, 10.0, fill_limit),
    Form("supply_saturation", "regulated", "ep", "psi", 0.5, 4.5, regulated_supply),
    Form("supply_saturation", "cut_off", "ep", "psi", 0.5, 4.5, cut_off_supply),
    Form("supply_saturation", "drooping", "ep", "psi", 0.5, 6.5, drooping_supply),
)
