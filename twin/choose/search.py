"""The search over hypotheses on one channel: nothing, each cause alone, then pairs and triples of the promising ones.

Every hypothesis is fitted together with the design numbers; hypotheses of one size are fitted side by side in threads
(the kernels run without the interpreter's lock).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np

from twin.choose.candidates import effect_causes, number_causes
from twin.choose.score import Yardstick, make_yardstick
from twin.choose.screen import make_screen, prospects
from twin.effect import Scales
from twin.fit.channel import Channel
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import ACCUSED_SPREAD, Cause, make_space
from twin.plant import Plant

Progress = Callable[[str, float], None]


@dataclass(frozen=True, slots=True)
class SearchRules:
    """How far the search goes. `beam`: hypotheses that are extended by one more cause; `most`: causes at the most."""

    beam: int = 4
    most: int = 3
    rounds: int = 6
    polish: int = 8
    threads: int = 2
    screened: int = 6  # further causes (forms) per hypothesis of the beam that get a full fit
    enough: float = 1.25  # a mean squared residual (noise = 1) that leaves nothing to explain
    enough_share: float = 0.001  # likewise, as a share of what the design leaves


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
        same = [f for f in (self.none, *self.fits) if size_of(f) == size]
        return max(same, key=self.score) if same else None


@dataclass(slots=True)
class Searcher:
    """Fits hypotheses over a base plant on one channel."""

    channel: Channel
    base: Plant
    scales: Scales
    rules: SearchRules = field(default_factory=SearchRules)
    progress: Progress = lambda _what, _share: None
    tried: list[Fit] = field(default_factory=list)  # every cause alone in every form, to start larger hypotheses from

    def run(self) -> Findings:
        """The whole search."""
        none = fit(self.channel, make_space(self.base, (), (), self.scales), [np.zeros(0)])
        space = make_space(self.base, (), self.channel.numbers, self.scales, ACCUSED_SPREAD)
        retuned = fit(self.channel, space, starts_of(space), rounds=20)
        found = self._singles()
        level = list(found)
        for size in range(2, self.rules.most + 1):
            best = min(level, key=lambda f: f.mse, default=none)
            if best.mse - 1.0 <= max(self.rules.enough - 1.0, self.rules.enough_share * (none.mse - 1.0)):
                break
            level = self._extended(level, size)
            found += level
        everything = [none, *found]
        best = min(everything, key=lambda f: f.mse)
        return Findings(self.channel, none, retuned, tuple(found), make_yardstick(best.residuals, self.channel.use))

    def _singles(self) -> list[Fit]:
        causes = number_causes(self.channel) + effect_causes(self.channel, {i.effect for i in self.base.inserted})
        numbers = number_causes(self.channel)
        pairs = [(a, b) for k, a in enumerate(numbers) for b in numbers[k + 1 :]]
        fits = self._fit_all([*((c,) for c in causes), *pairs], [], self.rules.rounds, "one cause")
        self.tried[:] = [f for f in fits if len(f.names) == 1]
        fits = best_forms(fits, self.channel.rows)
        return self._polished(fits)

    def _extended(self, level: Sequence[Fit], size: int) -> list[Fit]:
        """Every hypothesis of the beam with one more cause, of those that promise something."""
        singles = number_causes(self.channel) + effect_causes(self.channel, {i.effect for i in self.base.inserted})
        fits: list[Fit] = []
        seen: set[tuple[str, ...]] = set()
        for parent in sorted(level, key=lambda f: f.mse)[: self.rules.beam]:
            more = [c for c in singles if c.name not in parent.names and not _same_claim(parent, c)]
            more = [c for c in more if tuple(sorted((*parent.names, c.name))) not in seen]
            todo = [(*parent.space.causes, c) for c in more]
            numbers = [causes for causes in todo if causes[-1].form is None]
            fits += self._fit_all(numbers, [parent, *self.tried], self.rules.rounds, f"{size} causes")
            fits += self._promising(parent, [causes for causes in todo if causes[-1].form is not None])
            seen |= {tuple(sorted((*parent.names, c.name))) for c in more}
        return self._polished(best_forms(fits, self.channel.rows))

    def _promising(self, parent: Fit, todo: Sequence[tuple[Cause, ...]]) -> list[Fit]:
        """Full fits of those of `todo` that a look from where `parent` ended finds most promising."""
        screen = make_screen(self.channel, self.base, parent)
        with ThreadPoolExecutor(self.rules.threads) as pool:
            best = prospects(screen, todo, self.tried, pool)[: self.rules.screened]
            return list(pool.map(lambda p: fit(self.channel, p.space, [p.start], rounds=self.rules.rounds), best))

    def _polished(self, fits: Sequence[Fit]) -> list[Fit]:
        ranked = sorted(fits, key=lambda f: f.mse)
        top, rest = ranked[: self.rules.polish], ranked[self.rules.polish :]
        with ThreadPoolExecutor(self.rules.threads) as pool:
            polished = pool.map(lambda f: fit(self.channel, f.space, [f.z], rounds=12), top)
            return sorted([*polished, *rest], key=lambda f: f.mse)

    def _fit_all(
        self, hypotheses: Iterable[tuple[Cause, ...]], known: Sequence[Fit], rounds: int, what: str
    ) -> list[Fit]:
        todo = list(hypotheses)

        def one(causes: tuple[Cause, ...]) -> Fit:
            space = make_space(self.base, causes, self._numbers(causes), self.scales)
            return fit(self.channel, space, starts_of(space, known, self.channel.trials[0].recording), rounds=rounds)

        with ThreadPoolExecutor(self.rules.threads) as pool:
            fits = []
            for done, result in enumerate(pool.map(one, todo), start=1):
                self.progress(f"{self.channel.name}: {what}", done / len(todo))
                fits.append(result)
        return fits

    def _numbers(self, causes: Sequence[Cause]) -> tuple[str, ...]:
        """Nuisance numbers ride along with effects only; accused numbers alone leave the others as designed."""
        if any(c.effect is not None for c in causes):
            return self.channel.numbers
        return tuple(c.name.removeprefix("parameter:") for c in causes)


def size_of(fit: Fit) -> int:
    """How much a hypothesis claims: its effects and accused numbers; wrong numbers alone are one claim together."""
    effects = sum(1 for c in fit.space.causes if c.effect is not None)
    return len(fit.space.causes) if effects else min(len(fit.space.causes), 1)


def best_forms(fits: Sequence[Fit], rows: int) -> list[Fit]:
    """Of the same causes in different forms only the best: a wrong form must not lose to a wrong cause."""
    plain = Yardstick(rows)
    best: dict[tuple[str, ...], Fit] = {}
    for one in fits:
        key = tuple(sorted(one.names))
        if key not in best or plain.score(one) > plain.score(best[key]):
            best[key] = one
    return list(best.values())


def _same_claim(parent: Fit, cause: Cause) -> bool:
    """Whether a cause has no meaning beside one of the parent: the same signature, or a number that it absorbs."""
    pairs = [(a, b) for one in parent.space.causes for a, b in ((one, cause), (cause, one))]
    return any(_takes(a, b) for a, b in pairs)


def _takes(a: Cause, b: Cause) -> bool:
    """Whether `b` beside `a` would only mend the form of `a`."""
    if a.effect is None:
        return False
    if b.effect is None:
        return b.name.removeprefix("parameter:") in a.effect.absorbs
    return any(b.name in names for names in a.effect.same_as.values())
