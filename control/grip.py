"""Whether a plate goes along with the pressure at the edge on which it landed: from the gauge and the readings alone.

After a long move the opposite edge has brought the plate back. If it slides, it goes as far from there as the measured
pressure goes on beyond what it was then, wherever the edges are thought to be; if it sticks, it stays. A converter with
hysteresis or dead time looks like sticking as long as commands are looked at; the gauge shows that nothing was pushed.
What is unknown: the stem, the plate, and the share of that way that it goes, 1 if it slides and 0 if it sticks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from control.controller import Seen
from control.design import DesignModel
from control.exact import considered, dot, lag, length
from control.play_filter import LOUD, NOISE_IN, Belief
from control.play_points import A1, A2, SIZE, W

STEM, PLATE, SHARE = range(3)
LEAD_IN = 0.05  # a drive that ran so far ahead of the target was surely brought back by the opposite edge
ARRIVED_PSI, SETTLED = 0.06, 4  # so near to its aim the pressure has arrived; so many readings later, this is where
SMOOTH = 0.3  # what a new reading of the pressure weighs
AWAY_PSI = 1.5  # so far back from there, the plate may have been moved by the other edge
LEAST, LEAST_IN = 15, 0.003  # readings, and how far a plate that slides had to go, before anything is said
STAYS, SURELY = 0.4, 2.5  # it stays if its share is smaller by so many standard deviations
PLACE_IN, SHARE_SD, CREEP_IN = 0.02, 1.0, 5e-5  # standard deviations at first; random walk of a plate per root second
KNOWN_IN, NONE_SD = 0.001, 0.001  # a place that is known so well teaches the edge; doubt of "none" as a share
LANDED_PSI = 0.004  # doubt of the pressure at which the plate stopped
_MEAN = (0.0, 0.0, 0.5)
_SPREAD = tuple(
    tuple(sd * sd if i == j else 0.0 for j in range(3)) for i, sd in enumerate((PLACE_IN, PLACE_IN, SHARE_SD))
)


@dataclass(frozen=True, slots=True)
class Grip:
    """While a drive lasts, its `way` (+1 closing), and how far ahead of the target it was at the most [in]. After it,
    the `side` of the edge on which it landed (0: nothing is watched), the pressure there, the one from which pushing
    counts and the smoothed one [psi]; readings since; whether the plate may be pushed by the other edge; how far one
    that slides was pushed on, and how far a stem has followed that [in]; what is `left` of where the stem was; means of
    stem and plate, less the target [in], and of the share, and their covariance."""

    way: int = 0
    lead_in: float = 0.0
    side: int = 0
    landed_psi: float = 0.0
    from_psi: float = 0.0
    psi: float = 0.0
    count: int = 0
    away: bool = False
    pushed_in: float = 0.0
    followed_in: float = 0.0
    left: float = 1.0
    means: tuple[float, ...] = _MEAN
    spread: tuple[tuple[float, ...], ...] = _SPREAD

    def driven(self, way: int, lead_in: float) -> Grip:
        """After a tick in which the valve is driven that way, 0 for none, so far ahead of the target."""
        if way:
            return Grip(way, max(self.lead_in, lead_in) if way == self.way else lead_in)
        if self.way:
            return Grip(side=-self.way) if self.lead_in > LEAD_IN else Grip()
        return self

    def read(self, seen: Seen, soon: Belief, goes: tuple[float, float], design: DesignModel, dt_s: float) -> Grip:
        """After the next readings; `goes`: the target [in] and where the pressure should go [psi]."""
        if not self.side:
            return self
        (target_in, aim_psi), psi = goes, seen.pressure_psi
        if self.count <= SETTLED:
            middle_psi = 0.5 * (soon.inside.a1 + soon.inside.a2) + target_in / soon.compliance
            return self._landing(psi, aim_psi, middle_psi)
        now = replace(self, psi=self.psi + SMOOTH * (psi - self.psi), count=self.count + 1)
        if self.side * (self.landed_psi - psi) > AWAY_PSI:
            return replace(now, away=True)
        return (now._afresh(soon) if now.away else now)._learned(seen.position_in - target_in, soon, design, dt_s)

    def _landing(self, psi: float, aim_psi: float, middle_psi: float) -> Grip:
        """Until the pressure has arrived on this side of the gap, and stayed for a moment; else nothing is watched."""
        if self.side * (aim_psi - middle_psi) < 0.0:
            return Grip()
        if self.side * (psi - middle_psi) < 0.0:
            return Grip() if self.count else self
        if not self.count:
            return replace(self, count=1, psi=psi) if abs(psi - aim_psi) < ARRIVED_PSI else self
        psi = self.psi + SMOOTH * (psi - self.psi)
        return replace(self, count=self.count + 1, psi=psi, landed_psi=psi, from_psi=psi)

    def _afresh(self, soon: Belief) -> Grip:
        """Back from the other edge, by which the plate may have been moved; to push it counts only beyond the furthest
        that it was pushed before."""
        from_psi = self.from_psi + self.side * self.pushed_in / soon.compliance
        side, count = self.side, self.count
        return Grip(side=side, landed_psi=self.landed_psi, from_psi=from_psi, psi=self.psi, count=count)

    def _learned(self, off_in: float, soon: Belief, design: DesignModel, dt_s: float) -> Grip:
        goes, variance = lag(dt_s, design.tau_s), 2.0 * soon.noise_in * soon.noise_in  # as in the filter: double
        pushed_in = max(self.pushed_in, soon.compliance * self.side * (self.psi - self.from_psi))
        row = ((STEM, self.left), (PLATE, 1.0 - self.left), (SHARE, self.side * self.followed_in))
        mean, cov = list(self.means), [list(line) for line in self.spread]
        mean, cov = considered(mean, cov, row, off_in - dot(row, mean), variance, 3)
        cov[PLATE][PLATE] += CREEP_IN * CREEP_IN * dt_s
        return replace(
            self,
            pushed_in=pushed_in,
            followed_in=self.followed_in + goes * (pushed_in - self.followed_in),
            left=(1.0 - goes) * self.left,
            means=tuple(mean),
            spread=tuple(tuple(line) for line in cov),
        )

    def stays(self, soon: Belief) -> bool:
        """Whether the plate has stayed where it was, beyond doubt, though it was pushed. The furthest of noisy
        pressures was not one, and nothing is said."""
        if soon.noise_in > LOUD * NOISE_IN:
            return False
        share = self.means[SHARE] + SURELY * math.sqrt(max(self.spread[SHARE][SHARE], 0.0))
        return self.count > LEAST and self.followed_in > LEAST_IN and share < STAYS

    def known(self, found: Belief, target_in: float, *beliefs: Belief) -> tuple[Belief, ...]:
        """What is known once a plate is seen to stick: the numbers as they were `found`, put right by where pressure
        and plate were when it stopped, if that is seen; then these beliefs with them."""
        mean, cov = list(self.means), [list(line) for line in self.spread]
        mean, cov = considered(mean, cov, ((SHARE, 1.0),), -mean[SHARE], NONE_SD * NONE_SD, 3)
        doubt_in, place_in = math.sqrt(max(cov[PLATE][PLATE], 0.0)), target_in + mean[PLATE]
        loud = any(belief.noise_in > LOUD * NOISE_IN for belief in beliefs)
        if loud or self.count <= LEAST or self.away or doubt_in > KNOWN_IN:
            return (found, *(belief.with_numbers(found) for belief in beliefs))
        edge, edge_psi = (A1 if self.side > 0 else A2), self.landed_psi - place_in / found.compliance
        inside = replace(found.inside, a1=edge_psi) if self.side > 0 else replace(found.inside, a2=edge_psi)
        doubt_psi = length(doubt_in / found.compliance, LANDED_PSI)
        found = _alone(replace(found, inside=inside), edge, doubt_psi)
        there = (belief.with_numbers(found) for belief in beliefs)
        return (found, *(_alone(replace(b, inside=replace(b.inside, w=place_in)), W, doubt_in) for b in there))


def _alone(belief: Belief, place: int, sd: float) -> Belief:
    """The belief with this standard deviation of the number at a place, and nothing that ties it to the others."""
    spread = list(belief.spread)
    for other in range(SIZE):
        spread[SIZE * place + other] = spread[SIZE * other + place] = 0.0
    spread[SIZE * place + place] = sd * sd
    return replace(belief, spread=tuple(spread))
