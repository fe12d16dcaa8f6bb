"""The design equations for many plans of commands at once, from one estimate of the inside: the MPC's default model."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from control.exact import decay, lag
from control.observer import Inside, Observer

FloatArray = npt.NDArray[np.float64]


def predict_positions(observer: Observer, inside: Inside, commands_psi: FloatArray, dt_s: float) -> FloatArray:
    """Stem positions [in] at the ends of the ticks, for command plans of shape (plans, ticks); same shape out."""
    d, k, parts = observer.design, observer.design.compliance, 2
    part_s = dt_s / parts
    share = lag(part_s, d.ep_tau_s)
    fade = decay(part_s / d.tau_s) if d.tau_s > 0.0 else 0.0
    settled = commands_psi + inside.bias + inside.slope * (commands_psi - 9.0)
    p, w, x = (np.full(commands_psi.shape[0], value) for value in (inside.p, inside.w, inside.x))
    positions = np.empty_like(commands_psi)
    for tick in range(commands_psi.shape[1]):
        for _ in range(parts):
            p = p + share * (settled[:, tick] - p)
            pushed = np.clip(np.maximum(k * (p - inside.a1), np.minimum(k * (p - inside.a2), w)), 0.0, d.travel)
            step = (0.5 * (w + pushed) - x) * (1.0 - fade)
            x = x + np.clip(step, -d.rate_limit * part_s, d.rate_limit * part_s)
            w = pushed
        positions[:, tick] = x
    return positions
