"""A Kalman filter through the play: stem, play output, edges and three design numbers, each with how sure it is.

The play decides what a reading tells. While an edge pushes, play output and edge are one thing, so that a dwell after
the move teaches the edge as well; inside the gap the play output is a constant, which a longer dwell knows better.
Which of them counts is itself uncertain at first, so that no derivative tells what a move does to the belief: points
that stand for it go through the play instead.
All of it is done on plain floats in a fixed order, so that a record replays to the last bit on any machine.
Source: cubature points, Arasaratnam and Haykin, "Cubature Kalman Filters", IEEE Transactions on Automatic Control 2009.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from control.controller import Seen
from control.design import DesignModel
from control.exact import Matrix, considered, dot, lag, length, times
from control.lateness import Lateness
from control.observer import Inside, Observer
from control.play_points import A1, A2, SIZE, K, R, T, W, X, moved

NOISE_IN = 0.0006
# standard deviations of what the design may be wrong by: edges [psi], three numbers as shares; and these at the most
EDGE_PSI, STIFFNESS, RATE, TRAVEL, MOST = 0.3, 0.015, 0.03, 0.02, 0.1
WALK_PSI, CREEP_IN = 0.03, 1.5e-4  # random walk of the edges per travel moved, of the play output per root second
LOUD, LOUD_WALK_PSI = 2.0, 0.012  # times the usual noise; then readings cannot teach an edge anew after every move
CALIBRATES, LOUD_CALIBRATES = 0.1, 0.03  # of the converter; what follows a loud gauge moves the plate by that noise
NOISE_PSI, STOP_IN = 0.004, 0.003
REMEMBERED, LATE_DOUBT = 30, 0.1  # ticks of motion; share of what the stem went since a late reading that is doubt
FIRST, LATER = 6, 0.02  # what the supposed noise weighs at the start, in readings; what a new reading weighs later


@dataclass(frozen=True, slots=True)
class Belief:
    """Means in `inside`, `compliance` [in/psi], `rate_limit` [in/s] and `travel`, where the play output stops [in];
    `spread` is the covariance of (x, rate limit, travel, w, a1, a2, compliance), row by row; `noise_in`, `noise_psi`
    the standard deviations of one reading; `doubt_psi` that of the pressure estimate; `missed` by how much the last
    readings of position and pressure were off; `heard`, how many there were; `went`, how far the stem went in each of
    the last ticks [in], the newest first."""

    inside: Inside
    compliance: float
    rate_limit: float
    travel: float
    spread: tuple[float, ...]
    noise_in: float = NOISE_IN
    noise_psi: float = NOISE_PSI
    doubt_psi: float = NOISE_PSI
    missed: tuple[float, float] = (0.0, 0.0)
    heard: int = 0
    went: tuple[float, ...] = ()

    @property
    def doubt_in(self) -> float:
        """Standard deviation of the play output [in]."""
        return math.sqrt(max(self.spread[SIZE * W + W], 0.0))

    @property
    def is_loud(self) -> bool:
        """Whether both gauges are far noisier than usual; one alone looks so where moves are not as predicted."""
        return self.noise_in > LOUD * NOISE_IN and self.noise_psi > LOUD * NOISE_PSI

    def edge_psi(self, position_in: float, side: int) -> float:
        """The pressure at which the edge on this side (+1 closing, -1 opening) holds the play output there."""
        return (self.inside.a1 if side > 0 else self.inside.a2) + position_in / self.compliance

    def with_numbers(self, known: Belief) -> Belief:
        """The same belief with another's edges and compliance, which have nothing to do with what the rest is."""
        mine, theirs = _square(self.spread), _square(known.spread)
        cov = [
            [mine[i][j] if max(i, j) < A1 else theirs[i][j] if min(i, j) >= A1 else 0.0 for j in range(SIZE)]
            for i in range(SIZE)
        ]
        inside = replace(self.inside, a1=known.inside.a1, a2=known.inside.a2)
        return replace(self, inside=inside, compliance=known.compliance, spread=_flat(cov))

    def edge_doubt_in(self, side: int) -> float:
        """How far off the play output may be that is put somewhere by the edge of this side [in]."""
        a = A1 if side > 0 else A2
        lever = self.inside.p - (self.inside.a1 if side > 0 else self.inside.a2)
        h = ((a, -self.compliance), (K, lever))
        return math.sqrt(max(dot(h, times(_square(self.spread), h)), 0.0))

    def landing_doubt_in(self, side: int) -> float:
        """The same of where the play output is now, whatever the pressure is at present [in]."""
        h = ((A1 if side > 0 else A2, -self.compliance), (K, self.inside.w / self.compliance))
        return math.sqrt(max(dot(h, times(_square(self.spread), h)), 0.0))

    def edge_doubt_psi(self, side: int) -> float:
        """`edge_doubt_in` as a pressure [psi]."""
        return self.edge_doubt_in(side) / self.compliance

    def went_in(self, ticks: float) -> float:
        """How far the stem went in the last so many ticks [in]."""
        whole = int(ticks)
        went_in = (ticks - whole) * self.went[whole] if whole < len(self.went) else 0.0
        for each_in in self.went[:whole]:
            went_in += each_in
        return went_in

    def mark(self, side: int) -> tuple[float, float, float]:
        """Where things stand when pushing begins: the edge of this side [psi], the play output [in], the edge's doubt
        [psi]."""
        return self.edge_psi(self.inside.w, side), self.inside.w, self.edge_doubt_psi(side)


@dataclass(frozen=True, slots=True)
class PlayFilter:
    """The design is where it starts."""

    design: DesignModel

    def start(self, seen: Seen) -> Belief:
        d = self.design
        sds = (NOISE_IN, RATE * d.rate_limit, TRAVEL * d.travel, 0.004, EDGE_PSI, EDGE_PSI, STIFFNESS * d.compliance)
        spread = _flat([[sd * sd if i == j else 0.0 for j in range(SIZE)] for i, sd in enumerate(sds)])
        return Belief(Observer(d).start(seen), d.compliance, d.rate_limit, d.travel, spread)

    def observer(self, belief: Belief) -> Observer:
        """The design equations with compliance, rate limit and travel as learned."""
        learned = replace(self.design, compliance=belief.compliance, rate_limit=belief.rate_limit, travel=belief.travel)
        return Observer(learned, bias_gain=LOUD_CALIBRATES if belief.is_loud else CALIBRATES)

    def track(self, belief: Belief, seen: Seen, dt_s: float, late: Lateness) -> tuple[Belief, Belief]:
        """The belief for the next tick, and for the instant at which the next command begins to act."""
        keep = self._correct(belief, seen, dt_s, late)
        x = keep.inside.x
        for command_psi, share in keep.inside.line.next_tick:
            keep = self.ahead(keep, command_psi, share * dt_s)
        keep = acts = replace(keep, went=(keep.inside.x - x, *keep.went[:REMEMBERED]))
        for command_psi, share in keep.inside.line.after_that:
            acts = self.ahead(acts, command_psi, share * dt_s)
        return keep, acts

    def _correct(self, belief: Belief, seen: Seen, dt_s: float, late: Lateness) -> Belief:
        inside, observer = belief.inside, self.observer(belief)
        since_in = belief.went_in(late.known_s / dt_s) if late.known_s else 0.0
        off_in, off_psi = seen.position_in - (inside.x - since_in), seen.pressure_psi - inside.p
        belief = self._noise(belief, off_in, off_psi)
        noise_psi = 4.0 * belief.noise_psi
        p = inside.p + max(0.3, off_psi * off_psi / (off_psi * off_psi + noise_psi * noise_psi)) * off_psi
        pushed = any(observer.contact(inside)) and not _stopped(belief, inside)
        w = inside.w + (belief.compliance * (p - inside.p) if pushed else 0.0)
        inside = observer.on_stop(replace(observer.learn_converter(inside, off_psi, seen, dt_s), p=p, w=w))
        doubt_in = LATE_DOUBT * since_in
        variance = 2.0 * belief.noise_in * belief.noise_in + doubt_in * doubt_in  # half of the noise is slow: double
        cov = _square(belief.spread)
        learns = W if _stopped(belief, inside) else SIZE if off_in * off_in < 9.0 * (cov[X][X] + variance) else K
        mean = _mean(inside, belief)
        if not late.awaited:
            mean, cov = considered(mean, cov, ((X, 1.0),), off_in, variance, learns)
        near = replace(inside, w=mean[W], a1=mean[A1], a2=mean[A2])
        w = observer.on_stop(near).w
        mean[W] = mean[T] if w >= belief.travel - 1e-9 else min(w, mean[T])
        mean, cov = self._consistent(mean, cov, p, belief.doubt_psi)
        d = self.design
        for place, design in ((K, d.compliance), (R, d.rate_limit), (T, d.travel)):
            mean[place] = min(max(mean[place], (1.0 - MOST) * design), (1.0 + MOST) * design)
        return _with(belief, replace(inside, p=p), mean, cov)

    def _noise(self, belief: Belief, off_in: float, off_psi: float) -> Belief:
        """The noise of both readings from how successive ones differ, over some 50; large differences are motion. The
        first ones at rest count more: the first move, by which the edges are learned, comes half a second later."""
        rests = abs(belief.inside.w - belief.inside.x) < STOP_IN
        new = max(1.0 / (belief.heard + FIRST), LATER) if rests else LATER

        def grown(sd: float, now: float, last: float, least: float) -> float:
            square, away = sd * sd, now - last
            return max(math.sqrt((1.0 - new) * square + new * min(0.5 * away * away, 9.0 * square)), least)

        return replace(
            belief,
            noise_in=grown(belief.noise_in, off_in, belief.missed[0], 0.5 * NOISE_IN),
            noise_psi=grown(belief.noise_psi, off_psi, belief.missed[1], 0.5 * NOISE_PSI),
            doubt_psi=length(0.4 * belief.noise_psi, 0.3 * off_psi),
            missed=(off_in, off_psi),
            heard=belief.heard + 1,
        )

    def _consistent(self, mean: list[float], cov: Matrix, p: float, doubt_psi: float) -> tuple[list[float], Matrix]:
        """The play output inside the gap: where it is not, it and the edge give way, the less sure one more."""
        if 0.0 < mean[W] < mean[T] - 1e-9:
            for a, side in ((A1, 1.0), (A2, -1.0)):
                beyond, doubt_in = side * (mean[K] * (p - mean[a]) - mean[W]), mean[K] * doubt_psi
                if beyond > 0.0:
                    h = ((W, -side), (a, -side * mean[K]), (K, side * (p - mean[a])))
                    mean, cov = considered(mean, cov, h, -beyond, doubt_in * doubt_in, K)
        return mean, cov

    def ahead(self, belief: Belief, command_psi: float, dt_s: float) -> Belief:
        """The belief `dt_s` later with this command in force."""
        d, before, cov = self.design, belief.inside, _square(belief.spread)
        if _stopped(belief, before):  # the play output is the stop, as sure as that is
            share = 1.0 if before.w > 0.0 else 0.0
            for other in range(SIZE):
                cov[W][other] = cov[other][W] = share * cov[T][T if other == W else other]
        after, x, w = self._moved(_mean(before, belief), cov, before, command_psi, dt_s)
        pushed_psi, moved_in = abs(after.p - before.p), abs(w - before.w)
        share = min(moved_in / (belief.compliance * pushed_psi), 1.0) if pushed_psi > 0.002 else 0.0
        after = replace(after, x=x, w=w)
        if min(w, belief.travel - w) < 1e-6:
            after = replace(after, w=0.0 if w < 0.5 * belief.travel else belief.travel)
            cov[W][W] += STOP_IN * STOP_IN
        doubt_in, lagged_in = belief.compliance * belief.doubt_psi * share, 0.03 * (after.x - before.x)
        walk_psi = LOUD_WALK_PSI if belief.is_loud else WALK_PSI
        walk = walk_psi * walk_psi * moved_in / d.travel
        cov[W][W] += CREEP_IN * CREEP_IN * dt_s + doubt_in * doubt_in
        cov[X][X] += lagged_in * lagged_in
        cov[A1][A1] += walk
        cov[A2][A2] += walk
        return replace(belief, inside=after, spread=_flat(cov))

    def _moved(
        self, mean: list[float], cov: Matrix, inside: Inside, command_psi: float, dt_s: float
    ) -> tuple[Inside, float, float]:
        """Pressure, mean stem and mean play output a little later; `cov` becomes that of then."""
        d = self.design
        parts = max(math.ceil(dt_s / 0.03 - 1e-9), 1)
        share, p, settles, pressures = lag(dt_s / parts, d.ep_tau_s), inside.p, inside.settles(command_psi), []
        for _ in range(parts):
            p += share * (settles - p)
            pressures.append(p)
        x, w = moved(mean, cov, pressures, d.tau_s, dt_s / parts)
        return replace(inside.turned(command_psi), p=p), x, w


def _square(spread: tuple[float, ...]) -> Matrix:
    return [list(spread[row : row + SIZE]) for row in range(0, SIZE * SIZE, SIZE)]


def _flat(cov: Matrix) -> tuple[float, ...]:
    return tuple(value for line in cov for value in line)


def _mean(inside: Inside, belief: Belief) -> list[float]:
    return [inside.x, belief.rate_limit, belief.travel, inside.w, inside.a1, inside.a2, belief.compliance]


def _with(belief: Belief, inside: Inside, mean: list[float], cov: Matrix) -> Belief:
    x, rate_limit, travel, w, a1, a2, compliance = mean
    inside, learned = replace(inside, x=x, w=w, a1=a1, a2=a2), _flat(cov)
    return replace(belief, inside=inside, compliance=compliance, rate_limit=rate_limit, travel=travel, spread=learned)


def _stopped(belief: Belief, inside: Inside) -> bool:
    return inside.w <= 0.0 or inside.w >= belief.travel - 1e-9
