"""How far what a converter's cause does to the pressure reaches the stem."""

from __future__ import annotations

import numpy as np

from twin.choose.decide import Decision
from twin.fit.channel import predict_reading


def moved_square(decision: Decision, sigma: float) -> float:
    """Mean square by which the accepted causes of the pressure move the reading of the stem, `sigma` [position] = 1.

    Both from the commands alone: with the converter as accepted and with the design's. A pressure gauge may be too
    noisy to show at a glance what moves the stem by several times the noise of its reading.
    """
    accepted, none = decision.accepted.plant, decision.findings.none.plant
    trials = decision.findings.channel.trials
    shifts = [(predict_reading(accepted, t) - predict_reading(none, t))[t.use_y] for t in trials]
    return float(np.mean(np.square(np.concatenate(shifts)))) / sigma**2
