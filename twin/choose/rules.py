"""What a cause has to be worth to be accepted."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DecisionRules:
    """Thresholds, chosen on the calibration bank and never on published blind trials (docs/calibration.md).

    Gains are in units of the noise variance: 1 means as large as the noise itself. `gain` is raised to what a healthy
    machine leaves, where that is known; `further` is what a cause beside others has to gain where they leave more.
    `believed`: how far (squares of their priors' deviations) design numbers nobody accuses may have moved, where more
    than the noise is left.
    `share` of the gap is what a further cause has to explain, or, if it explains nearly all of the rest, `trifle`.
    """

    gain: float = 0.15
    further: float = 0.15
    evidence: float = 12.0
    share: float = 0.02
    trifle: float = 0.0004
    thorough: float = 0.55
    complete: float = 0.8
    erratic: float = 0.7
    large_share: float = 0.2
    unexplained: float = 0.2
    nothing_left: float = 1.15
    believed: float = 30.0
    plain: float = 0.05
    plain_share: float = 0.005
    quiet: float = 2.0
    within: float = 0.0  # mean squared residual that the healthy machine leaves, where that is known (`Margin`)
