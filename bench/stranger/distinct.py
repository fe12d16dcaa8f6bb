"""How much of what a cause changes is its own: what no other numbers of the design, and no gain or zero, would do too.

A curve is mostly a gain and an asymmetry mostly another compliance; a case that shows hardly anything else would ask
for a name that the record does not hold.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.stranger.excite import Session
from bench.stranger.form import Form
from bench.stranger.noise import POSITION_IN
from bench.stranger.parameters import PARAMETER_FORMS
from bench.stranger.record import noise_free_reading
from bench.stranger.valve import HEALTHY

_NUDGE = 0.02  # of a number, or psi: small enough to be linear, large enough to bind the rate limit differently

#: Causes that are nothing else than what is taken away here, or that the pressure tells whatever the position says.
_PLAIN_CAUSES, _PLAIN_STAGES = ("lvdt_calibration",), ("ep",)


def plain_directions(session: Session, seed: list[int]) -> NDArray[np.float64]:
    """An orthonormal basis of what the plain numbers can change in the reading: shape (rows, at most 8)."""
    healthy_in = noise_free_reading(HEALTHY, session, seed)
    columns = [np.ones_like(healthy_in), healthy_in]
    for form in PARAMETER_FORMS:
        valve = form.build(HEALTHY, _NUDGE, np.random.default_rng(0))
        columns.append(noise_free_reading(valve, session, seed) - healthy_in)
    felt = [
        column / np.linalg.norm(column) for column in columns if column.any()
    ]  # a limit that is never reached is not
    return np.asarray(np.linalg.svd(np.column_stack(felt), False)[0])


def own_ratio(form: Form, changed_in: NDArray[np.float64], plain: NDArray[np.float64]) -> float:
    """RMS of a change [in], shape (rows,), without its plain part, over the sensor's noise."""
    left = changed_in
    if form.cause not in _PLAIN_CAUSES and form.stage not in _PLAIN_STAGES and not form.cause.startswith("parameter:"):
        left = changed_in - plain @ (plain.T @ changed_in)
    return float(np.sqrt(np.mean(left**2))) / POSITION_IN
