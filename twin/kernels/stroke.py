"""What the stroke of the stem takes from the pressure, until the converter has given it back."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.kernels.ep_slots import EP_STROKE
from twin.kernels.follow import follow


def struck(
    time_s: FloatArray, offsets: np.ndarray, stem: FloatArray, c: FloatArray, filled: float
) -> tuple[FloatArray, float]:
    """What the stroke has taken from the pressure and the converter not yet given back, shape of the fine `stem`.

    `filled`: the stem at which the air that came so far would be enough, at first; returned as it is at the end.
    """
    came = np.empty(stem.size)
    follow(time_s, offsets, np.append(stem[:1], 0.5 * (stem[1:] + stem[:-1])), c, filled, came)
    return c[EP_STROKE] * (stem - came), float(came[-1])
