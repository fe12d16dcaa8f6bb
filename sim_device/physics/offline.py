"""Records without the wire, for banks of labelled cases and for tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sim_device.valve import ValvePhysics

Array = NDArray[np.float64]


def record(
    physics: ValvePhysics, time_s: Array | Sequence[float], command: Array | Sequence[float]
) -> tuple[Array, Array]:
    """Plays `command` and returns pressure [psi] and position [in] read at `time_s`, arrays of the same length.

    The row convention is that of a record: `command[k]` is in force over the interval that ends at `time_s[k]`. A fresh
    plant starts at `time_s[0]`.
    """
    pressure_psi = np.empty(len(time_s))
    position_in = np.empty(len(time_s))
    for row, (now_s, value) in enumerate(zip(time_s, command, strict=True)):
        seen = physics.advance(float(now_s), float(value))
        pressure_psi[row], position_in[row] = seen.pressure_psi, seen.position_in
    return pressure_psi, position_in
