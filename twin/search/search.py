"""The search over hypotheses on one channel: nothing, each cause alone, then pairs and triples of the promising ones.

Every hypothesis is fitted together with the design numbers; hypotheses of one size are fitted side by side in threads
(the kernels run without the interpreter's lock).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor
from dataclasses import dataclass, field
from threading import Event
from typing import TypeVar

import numpy as np

from twin.fit.channel import Channel
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.larger_steps import Look, in_larger_steps
from twin.fit.retuning import retuned
from twin.fit.space import Cause, make_space
from twin.model.effect import Scales
from twin.model.plant import Plant
from twin.search.candidates import effect_causes, number_causes
from twin.search.claims import best_forms, same_claim, some_of_each, suspected, together
from twin.search.findings import Findings
from twin.search.likeliest import by_score, likeliest
from twin.search.needless import without_needless
from twin.search.nested import beyond_retuning, nested
from twin.search.pairs import Pair, promising_pairs
from twin.search.polish import polished
from twin.search.reform import Beyond, bent_by, better_of_each, exactly, in_laws, in_other_forms, least_left
from twin.search.score import yardstick_for
from twin.search.screen import Prospect, make_screen, prospects
from twin.search.search_rules import SearchRules
from twin.search.slips import several_slips

Progress = Callable[[str, float], None]
_T = TypeVar("_T")
_R = TypeVar("_R")


@dataclass(slots=True)
class Searcher:
    """Fits hypotheses over a base plant on one channel."""

    channel: Channel
    base: Plant
    scales: Scales
    rules: SearchRules = field(default_factory=SearchRules)
    progress: Progress = lambda _what, _share: None
    resting: float = 1.0  # mean squared error of a reading at rest: below 1 where the noise is that of repeats
    origins: list[Fit] = field(default_factory=list)  # hypotheses without a cause, from where pairs are looked for
    tried: list[Fit] = field(default_factory=list)  # every cause alone in every form, to start larger hypotheses from
    stopped: Event = field(default_factory=Event)
    look: Look = field(init=False)  # the channel as further causes are looked for

    def __post_init__(self) -> None:
        self.look = in_larger_steps(self.channel)

    def run(self) -> Findings:
        """The whole search."""
        none = fit(self.channel, make_space(self.base, (), (), self.scales), [np.zeros(0)])
        tuned = retuned(self.channel, self.base, self.scales)
        self.origins[:] = [none, tuned]
        level = self._singles(tuned)
        slips = number_causes(self.channel)
        found = [*level, *several_slips(slips, none, tuned, self._fit_from, self.rules.scant)]
        for size in range(2, self.rules.most + 1):
            if self._nothing_left(level, none):
                found += self._drifting(level) if size == 2 else []
                break
            if size > 2 and self._idle(level, none, tuned):
                break
            level = self._extended(level, size)
            found += level
        found = without_needless(better_of_each([*found, *self._neighbours(found)]), none)
        return Findings(self.channel, none, tuned, tuple(found), yardstick_for([none, *found], self.channel.use))

    def _nothing_left(self, level: Sequence[Fit], none: Fit) -> bool:
        """Whether the likeliest leaves nothing to explain. One that bends all numbers may, and is no answer.

        Nothing further is behind a pressure that passes for healthy anyway.
        """
        if self.channel.name == "pressure" and none.mse < self.rules.slight:
            return True
        likely = likeliest(level, self.channel.use)[0] if level else none
        if any(c.form is not None for c in likely.space.causes) and bent_by(likely) > self.rules.bent:
            return False
        return likely.mse - 1.0 <= max(self.rules.enough - 1.0, self.rules.enough_share * (none.mse - 1.0))

    def _idle(self, pairs: Sequence[Fit], none: Fit, retuned: Fit) -> bool:
        """Whether a third cause is not worth looking for."""
        # Of three causes that explain all, the best two explain two thirds, or more.
        if min(f.mse for f in pairs) - 1.0 > self.rules.hopeless * (retuned.mse - 1.0):
            return True
        return likeliest(pairs, self.channel.use)[0].mse - 1.0 < self.rules.scant * (none.mse - 1.0)

    def _singles(self, retuned: Fit) -> list[Fit]:
        numbers = number_causes(self.channel)
        causes = numbers + effect_causes(self.channel, self.base)
        pairs = [(a, b) for k, a in enumerate(numbers) for b in numbers[k + 1 :]]
        fits = self._each(lambda some: self._fit(some, []), [*((c,) for c in causes), *pairs], "one cause")
        with ThreadPoolExecutor(self.rules.threads) as pool:
            fits = nested(self.channel, fits, self.rules.rounds, pool)
            fits = beyond_retuning(self.channel, fits, retuned, self.rules.rounds, pool)
        self.tried[:] = [f for f in fits if len(f.names) == 1]
        return self._polished(best_forms(fits, self.channel.use, self.origins[0]))

    def _extended(self, level: Sequence[Fit], size: int) -> list[Fit]:
        """Every hypothesis of the beam with one more cause, of those that promise something."""
        singles = number_causes(self.channel) + effect_causes(self.channel, self.base)
        fits = self._each(lambda p: self._beyond(*p), self._further(level, singles), f"{size} causes")
        found = [f for some in fits for f in some]
        if size == 2:
            found += self._paired([c for c in singles if c.form is not None])
            found += self._reformed(best_forms(found, self.channel.use, self.origins[0]))
        return self._polished(best_forms(found, self.channel.use, self.origins[0]))

    def _further(self, level: Sequence[Fit], singles: Sequence[Cause]) -> list[Beyond]:
        """The hypotheses of the beam, each with what one more cause makes of it; no causes twice."""
        found = []
        seen: set[tuple[str, ...]] = set()
        for parent in likeliest(level, self.channel.use)[: self.rules.beam]:
            more = [c for c in singles if c.name not in parent.names and not same_claim(parent, c)]
            more = [c for c in more if tuple(sorted((*parent.names, c.name))) not in seen]
            found.append((parent, [(*parent.space.causes, c) for c in more]))
            seen |= {tuple(sorted((*parent.names, c.name))) for c in more}
        return found

    def _beyond(self, parent: Fit, todo: Sequence[tuple[Cause, ...]]) -> list[Fit]:
        """Fits of those of `todo`, `parent` with one more cause: every number, and the effects that promise most."""
        numbers = [causes for causes in todo if causes[-1].form is None]
        fits = [self._fit(causes, [parent, *self.tried]) for causes in self._wanted(numbers)]
        effects = [causes for causes in todo if causes[-1].form is not None]
        return fits + [self._fit_prospect(p) for p in self._wanted(self._looked([(parent, effects)]))]

    def _reformed(self, pairs: Sequence[Fit]) -> list[Fit]:
        """The best pairs with the first effect in its other forms, where what they leave or bend asks for it."""
        least = max(self.rules.enough - 1.0, self.rules.reform_share * (self.origins[0].mse - 1.0))
        best = likeliest(pairs, self.channel.use)[0] if pairs else None
        if best is None or (best.mse - 1.0 <= least and bent_by(best) < self.rules.bent):
            return []
        todo = in_other_forms(pairs, self.tried, self.rules.reformed)
        looked = [p for some in self._each(self._looked, todo, "other forms") for p in some]
        return self._each(self._fit_prospect, least_left(looked, self.rules.other_forms), "other forms")

    def _drifting(self, level: Sequence[Fit]) -> list[Fit]:
        """What drifts beside the likeliest cause, where it may hide in the noise: more is not to be found there."""
        if self.resting > self.rules.restless:
            return []
        causes = [c for c in effect_causes(self.channel, self.base) if c.effect is not None and c.effect.drifts]
        likely = [f for f in likeliest(level, self.channel.use)[:2] if f.mse > self.resting]
        pairs = [(*f.space.causes, c) for f in likely for c in causes if c.name not in f.names and not same_claim(f, c)]
        fits = self._each(lambda some: self._fit(some, [*likely, *self.tried]), pairs, "drifts")
        return best_forms(fits, self.channel.use, self.origins[0])

    def _neighbours(self, found: Sequence[Fit]) -> list[Fit]:
        """What stands beside the likeliest hypotheses and was not fitted on the way up.

        With the numbers accused that they had to move far; and without each one of the causes, which may have been
        needed only as long as another was missing, was alone in another form, or had stopped far from its best alone.
        """
        todo: dict[frozenset[tuple[str, str]], tuple[tuple[Cause, ...], Fit]] = {}
        effects = effect_causes(self.channel, self.base)
        for one in by_score(found, self.channel.use)[: self.rules.beam] if found else []:
            causes = one.space.causes
            beside = [(*causes, *some) for some in suspected(one)]
            if len(causes) > 1:
                beside += [causes[:k] + causes[k + 1 :] for k in range(len(causes))]
            beside += in_laws(one, effects)
            todo = {exactly(some): (some, one) for some in beside} | todo  # from the likeliest that has it
        known = {exactly(f.space.causes): f.mse for f in found}
        new = [p for key, p in todo.items() if p[1].mse < self.rules.stuck * known.get(key, np.inf)]
        return self._each(lambda p: self._fit_from(*p), new, "neighbours")

    def _fit_from(self, causes: tuple[Cause, ...], parent: Fit) -> Fit:
        space = make_space(self.base, causes, self._numbers(causes), self.scales)
        return fit(self.channel, space, starts_of(space, [parent]), rounds=self.rules.rounds, look=self.look)

    def _looked(self, beyond: Sequence[Beyond]) -> list[Prospect]:
        """Beyond each of a few hypotheses, those that a look from where it ended finds most promising."""
        seen: list[Prospect] = []
        best: list[Prospect] = []
        for parent, todo in beyond:
            screen = make_screen(self.look, self.base, parent)
            ranked = prospects(screen, self._wanted(todo), self.tried, seen)
            seen += ranked
            best += some_of_each(ranked, self.rules.screened, self.rules.forms)
        return best

    def _fit_prospect(self, one: Prospect | Pair) -> Fit:
        return fit(self.channel, one.space, [one.start], rounds=self.rules.rounds, look=self.look)

    def _paired(self, causes: Sequence[Cause]) -> list[Fit]:
        """Full fits of the pairs of effects whose moves of the residual add up best."""

        def best(origin: Fit) -> list[Pair]:
            screen = make_screen(self.look, self.base, origin)
            return promising_pairs(screen, self._wanted(causes), self.tried, together)[: self.rules.paired]

        todo = [pair for some in self._each(best, self.origins, "pairs") for pair in some]
        return self._each(self._fit_prospect, todo, "pairs")

    def _polished(self, fits: Sequence[Fit]) -> list[Fit]:
        with ThreadPoolExecutor(self.rules.threads) as pool:
            return polished(self.channel, fits, self.rules.polish, pool)

    def _fit(self, causes: tuple[Cause, ...], known: Sequence[Fit]) -> Fit:
        space = make_space(self.base, causes, self._numbers(causes), self.scales)
        starts = starts_of(space, known, self.channel.recordings)
        return fit(self.channel, space, starts, rounds=self.rules.rounds, look=self.look)

    def _each(self, function: Callable[[_T], _R], items: Sequence[_T], what: str) -> list[_R]:
        """`function` of each of the items, side by side in threads; in their order."""
        results = []
        with ThreadPoolExecutor(self.rules.threads) as pool:
            try:
                for done, result in enumerate(pool.map(function, items), start=1):
                    self.progress(f"{self.channel.name}: {what}", done / len(items))
                    results.append(result)
            except KeyboardInterrupt:
                self.stopped.set()
                raise
        return results

    def _wanted(self, items: Iterable[_T]) -> Iterator[_T]:
        """The items one by one, as long as nobody has stopped the search: the threads would finish their portions."""
        for item in items:
            if self.stopped.is_set():
                raise CancelledError
            yield item

    def _numbers(self, causes: Sequence[Cause]) -> tuple[str, ...]:
        """Nuisance numbers ride along with effects only; accused numbers alone leave the others as designed."""
        if any(c.effect is not None for c in causes):
            return self.channel.numbers
        return tuple(c.name.removeprefix("parameter:") for c in causes)
