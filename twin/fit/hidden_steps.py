"""Steps of simulation so coarse that they miss something, and so fine that the noise hides what they miss.

A historian's record lasts for hours and has a row every few seconds. Its commands change by little from row to row, and
so a model misses less in coarse steps than it would on a bench's staircase. How much is measured, on the record's own
commands.
"""

from __future__ import annotations

import numpy as np

from twin.fit.case import Case
from twin.fit.channel import chain_channel
from twin.fit.trial import make_trial

#: Steps are no longer than this share of the stem's lag, and miss no more than this share of the noise, RMS.
_LAG_SHARE, _HIDDEN = 0.2, 0.2


def hidden_step_s(case: Case, most_steps: int) -> float:
    """Length [s] of the steps, of which the whole case has `most_steps` or few more; 0.0 where they would be missed."""
    step_s = sum(r.duration_s for r in case.recordings) / most_steps
    short = step_s <= _LAG_SHARE * case.base.design.tau_s
    return step_s if short and _missed(case, step_s) <= _HIDDEN else 0.0


def _missed(case: Case, step_s: float) -> float:
    """What the design misses of its own reading in such steps: RMS over the rows, as a share of the noise."""
    coarse = [make_trial(t.recording, step_s, t.false, t.begun, t.fresh, t.vague) for t in case.trials]
    apart = [chain_channel(trials, case.sigma_y).prediction(case.base) for trials in (coarse, case.trials)]
    return float(np.sqrt(np.mean(np.square(apart[0] - apart[1])))) / case.sigma_y
