"""A stem whose speed follows what pulls it: mass against damping, so that it may swing about its target."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray

_SAME = 1e-9


@njit(cache=True, nogil=True, error_model="numpy")
def inertia_pass(
    time_s: FloatArray,
    offsets: np.ndarray,
    target: FloatArray,
    lags_s: FloatArray,
    rates: FloatArray,
    stops: FloatArray,
    inertia_s: float,
    eases: tuple[float, float, float],
    state: FloatArray,
    out: FloatArray,
) -> None:
    """Fills `out` (fine) with the stem and moves `state` (stem, speed) on; `lags_s`, `rates`: (closing, opening).

    The speed goes to what a stem without mass would have, (target - stem) / lag within its rates and with what `eases`
    adds (see `twin.kernels.check_valve`), with time constant `inertia_s`; exact for a pull that is constant within a
    fine step. At a stop it is lost.
    """
    x, speed = max(stops[0], min(stops[1], state[0])), state[1]
    out[0] = x
    last_h, stays = -1.0, 0.0
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        if abs(h - last_h) > _SAME * h:
            last_h, stays = h, np.exp(-h / inertia_s)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            away = 0.5 * (target[f - 1] + target[f]) - x - 0.5 * h * speed
            pulled, way = (away / lags_s[0], 0) if away > 0.0 else (away / lags_s[1], 1)
            beyond = eases[way] * max(abs(pulled) - eases[2], 0.0)
            pulled = max(-rates[1], min(rates[0], pulled + (beyond if way == 0 else -beyond)))
            x += pulled * h + (speed - pulled) * inertia_s * (1.0 - stays)
            speed = pulled + (speed - pulled) * stays
            if x <= stops[0] or x >= stops[1]:
                x, speed = max(stops[0], min(stops[1], x)), 0.0
            out[f] = x
    state[0], state[1] = x, speed
