"""What an event test reports: how strongly the readings speak for an effect, and its size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from twin.diagnosis import Estimate


@dataclass(frozen=True, slots=True)
class Evidence:
    """Evidence for one effect from the look of the readings alone, no valve model involved.

    `log_likelihood_ratio` [nats] is for the effect against its absence, each at its best parameters, at least 0;
    `p_value` is the chance of as much without the effect. A test that had nothing to judge says so in `note` and
    reports 0 and 1.
    """

    effect: str
    log_likelihood_ratio: float
    p_value: float
    estimates: Mapping[str, Estimate] = field(default_factory=dict)
    note: str = ""

    @property
    def found(self) -> bool:
        """A plain threshold for displays; a diagnosis weighs the ratio with its priors instead."""
        return self.p_value < 1e-3 and self.log_likelihood_ratio > 6.0


def nothing(effect: str, note: str) -> Evidence:
    """Evidence that could not be taken."""
    return Evidence(effect, 0.0, 1.0, {}, note)
