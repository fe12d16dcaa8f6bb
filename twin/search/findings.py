"""What a search found on a channel, and how its hypotheses compare."""

from __future__ import annotations

from dataclasses import dataclass

from twin.fit.channel import Channel
from twin.fit.fitting import Fit
from twin.search.claims import hollow, size_of
from twin.search.score import Yardstick


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """All hypotheses fitted on a channel, and what they are measured with."""

    channel: Channel
    none: Fit
    retuned: Fit
    fits: tuple[Fit, ...]
    yardstick: Yardstick

    @property
    def phi(self) -> float:
        """Residual samples of the best hypothesis that are worth one independent one."""
        return self.yardstick.phi

    def score(self, fit: Fit) -> float:
        """Tempered log-evidence of one of the hypotheses."""
        return self.yardstick.score(fit)

    def scored(self) -> list[tuple[float, Fit]]:
        """All hypotheses with their scores, best first; `none` is among them."""
        pairs = [(self.score(f), f) for f in (self.none, *self.fits)]
        return sorted(pairs, key=lambda pair: -pair[0])

    def best_of_size(self, size: int) -> Fit | None:
        """The hypothesis of `size` (see `size_of`) with the highest score, or None."""
        same = [f for f in (self.none, *self.fits) if size_of(f) == size and not hollow(f, self.phi)]
        return max(same, key=self.score) if same else None
