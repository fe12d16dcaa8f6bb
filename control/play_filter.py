"""A Kalman filter through the play: stem, play output, edges and three design numbers, each with how sure it is.

The play decides what a reading tells. While an edge pushes, play output and edge are one thing, so that a dwell after
the move teaches the edge as well; inside the gap the play output is a constant, which a longer dwell knows better.
Which of them counts is itself uncertain at first, so that no derivative tells what a move does to the belief: points
that stand for it go through the play instead.
Source: cubature points, Arasaratnam and Haykin, "Cubature Kalman Filters", IEEE Transactions on Automatic Control 2009.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from control.controller import Seen
from control.design import DesignModel
from control.observer import Inside, Observer

FloatArray = npt.NDArray[np.float64]
X, R, T, W, A1, A2, K = range(7)
SIZE = 7
NOISE_IN = 0.0006
# standard deviations of what the design may be wrong by: edges [psi], three numbers as shares; and these at the most
EDGE_PSI, STIFFNESS, RATE, TRAVEL, MOST = 0.3, 0.015, 0.03, 0.02, 0.1
WALK_PSI, CREEP_IN = 0.03, 1.5e-4  # random walk of the edges per travel moved, of the play output per root second
NOISE_PSI, STOP_IN = 0.004, 0.003


@dataclass(frozen=True, slots=True)
class Belief:
    """Means in `inside`, `compliance` [in/psi], `rate_limit` [in/s] and `travel`, where the play output stops [in];
    `spread` is the covariance of (x, rate limit, travel, w, a1, a2, compliance), row by row; `noise_in`, `noise_psi`
    the standard deviations of one reading; `doubt_psi` that of the pressure estimate; `missed` by how much the last
    readings of position and pressure were off."""

    inside: Inside
    compliance: float
    rate_limit: float
    travel: float
    spread: tuple[float, ...]
    noise_in: float = NOISE_IN
    noise_psi: float = NOISE_PSI
    doubt_psi: float = NOISE_PSI
    missed: tuple[float, float] = (0.0, 0.0)

    @property
    def doubt_in(self) -> float:
        """Standard deviation of the play output [in]."""
        return math.sqrt(max(self.spread[SIZE * W + W], 0.0))

    def edge_psi(self, position_in: float, side: int) -> float:
        """The pressure at which the edge on this side (+1 closing, -1 opening) holds the play output there."""
        return (self.inside.a1 if side > 0 else self.inside.a2) + position_in / self.compliance

    def with_numbers(self, known: Belief) -> Belief:
        """The same belief with another's edges and compliance, which have nothing to do with what the rest is."""
        cov = _square(self.spread).copy()
        cov[A1:, :] = cov[:, A1:] = 0.0
        cov[A1:, A1:] = _square(known.spread)[A1:, A1:]
        inside = replace(self.inside, a1=known.inside.a1, a2=known.inside.a2)
        return replace(self, inside=inside, compliance=known.compliance, spread=tuple(cov.ravel()))

    def edge_doubt_in(self, side: int) -> float:
        """How far off the play output may be that is put somewhere by the edge of this side [in]."""
        a = A1 if side > 0 else A2
        lever = self.inside.p - (self.inside.a1 if side > 0 else self.inside.a2)
        h = _row(edge=a, slope=-self.compliance, lever=lever)
        return math.sqrt(max(float(h @ _square(self.spread) @ h), 0.0))


@dataclass(frozen=True, slots=True)
class PlayFilter:
    """The design is where it starts."""

    design: DesignModel

    def start(self, seen: Seen) -> Belief:
        d = self.design
        sds = (NOISE_IN, RATE * d.rate_limit, TRAVEL * d.travel, 0.004, EDGE_PSI, EDGE_PSI, STIFFNESS * d.compliance)
        spread = tuple(np.diag(np.square(sds)).ravel())
        return Belief(Observer(d).start(seen), d.compliance, d.rate_limit, d.travel, spread)

    def observer(self, belief: Belief) -> Observer:
        """The design equations with compliance, rate limit and travel as learned."""
        learned = replace(self.design, compliance=belief.compliance, rate_limit=belief.rate_limit, travel=belief.travel)
        return Observer(learned, bias_gain=0.1)

    def track(self, belief: Belief, seen: Seen, dt_s: float) -> tuple[Belief, Belief]:
        """The belief for the next tick, and for the instant at which the next command begins to act."""
        keep = self._correct(belief, seen, dt_s)
        for command_psi, share in keep.inside.line.next_tick:
            keep = self.ahead(keep, command_psi, share * dt_s)
        acts = keep
        for command_psi, share in keep.inside.line.after_that:
            acts = self.ahead(acts, command_psi, share * dt_s)
        return keep, acts

    def _correct(self, belief: Belief, seen: Seen, dt_s: float) -> Belief:
        inside, observer = belief.inside, self.observer(belief)
        off_in, off_psi = seen.position_in - inside.x, seen.pressure_psi - inside.p
        belief = self._noise(belief, off_in, off_psi)
        p = inside.p + max(0.3, off_psi**2 / (off_psi**2 + (4.0 * belief.noise_psi) ** 2)) * off_psi
        pushed = any(observer.contact(inside)) and not _stopped(belief, inside)
        w = inside.w + (belief.compliance * (p - inside.p) if pushed else 0.0)
        inside = observer.on_stop(replace(observer.learn_converter(inside, off_psi, seen, dt_s), p=p, w=w))
        variance = 2.0 * belief.noise_in**2  # half of the noise is slow: counted double
        cov = _square(belief.spread)
        learns = W if _stopped(belief, inside) else SIZE if off_in**2 < 9.0 * (cov[X, X] + variance) else K
        mean, cov = _updated(_mean(inside, belief), cov, _unit(X), off_in, variance, learns)
        near = replace(inside, w=float(mean[W]), a1=float(mean[A1]), a2=float(mean[A2]))
        w = observer.on_stop(near).w
        mean[W] = mean[T] if w >= belief.travel - 1e-9 else min(w, mean[T])
        mean, cov = self._consistent(mean, cov, p, belief.doubt_psi)
        d = self.design
        for place, design in ((K, d.compliance), (R, d.rate_limit), (T, d.travel)):
            mean[place] = min(max(mean[place], (1.0 - MOST) * design), (1.0 + MOST) * design)
        return _with(belief, replace(inside, p=p), mean, cov)

    def _noise(self, belief: Belief, off_in: float, off_psi: float) -> Belief:
        """The noise of both readings from how successive ones differ, over some 100; large differences are motion."""

        def grown(sd: float, now: float, last: float, least: float) -> float:
            square = 0.5 * (now - last) ** 2
            return max(math.sqrt(0.98 * sd**2 + 0.02 * min(square, 9.0 * sd**2)), least)

        return replace(
            belief,
            noise_in=grown(belief.noise_in, off_in, belief.missed[0], 0.5 * NOISE_IN),
            noise_psi=grown(belief.noise_psi, off_psi, belief.missed[1], 0.5 * NOISE_PSI),
            doubt_psi=math.hypot(0.4 * belief.noise_psi, 0.3 * off_psi),
            missed=(off_in, off_psi),
        )

    def _consistent(
        self, mean: FloatArray, cov: FloatArray, p: float, doubt_psi: float
    ) -> tuple[FloatArray, FloatArray]:
        """The play output inside the gap: where it is not, it and the edge give way, the less sure one more."""
        if 0.0 < mean[W] < mean[T] - 1e-9:
            for a, side in ((A1, 1.0), (A2, -1.0)):
                beyond = side * (mean[K] * (p - mean[a]) - mean[W])
                if beyond > 0.0:
                    h = side * _row(edge=a, slope=-mean[K], lever=p - mean[a]) - side * _unit(W)
                    mean, cov = _updated(mean, cov, h, -beyond, (mean[K] * doubt_psi) ** 2, K)
        return mean, cov

    def ahead(self, belief: Belief, command_psi: float, dt_s: float) -> Belief:
        """The belief `dt_s` later with this command in force."""
        d, before, cov = self.design, belief.inside, _square(belief.spread)
        if _stopped(belief, before):  # the play output is the stop, as sure as that is
            share = 1.0 if before.w > 0.0 else 0.0
            cov[W], cov[:, W] = share * cov[T], share * cov[:, T]
            cov[W, W] = share * cov[T, T]
        points = _points(_mean(before, belief), cov)
        after = self._moved(points, before, command_psi, dt_s)
        mean = points.mean(axis=1)
        apart = points - mean[:, None]
        cov = apart @ apart.T / points.shape[1]
        pushed_psi = abs(after.p - before.p)
        moved_in = abs(float(mean[W]) - before.w)
        share = min(moved_in / (belief.compliance * pushed_psi), 1.0) if pushed_psi > 0.002 else 0.0
        after = replace(after, x=float(mean[X]), w=float(mean[W]))
        if min(mean[W], belief.travel - mean[W]) < 1e-6:
            after = replace(after, w=0.0 if mean[W] < 0.5 * belief.travel else belief.travel)
            cov[W, W] += STOP_IN**2
        cov[W, W] += CREEP_IN**2 * dt_s + (belief.compliance * belief.doubt_psi * share) ** 2
        cov[X, X] += (0.03 * (after.x - before.x)) ** 2
        cov[A1, A1] += WALK_PSI**2 * moved_in / d.travel
        cov[A2, A2] += WALK_PSI**2 * moved_in / d.travel
        return replace(belief, inside=after, spread=tuple(cov.ravel()))

    def _moved(self, points: FloatArray, inside: Inside, command_psi: float, dt_s: float) -> Inside:
        """Moves all points, in place; the pressure is the same for all."""
        d, (x, rate, travel, w, a1, a2, k) = self.design, points
        parts = max(math.ceil(dt_s / 0.03 - 1e-9), 1)
        part_s = dt_s / parts
        share = 1.0 - math.exp(-part_s / d.ep_tau_s) if d.ep_tau_s > 0.0 else 1.0
        p, settles = inside.p, inside.settles(command_psi)
        for _ in range(parts):
            p += share * (settles - p)
            w_next = np.clip(np.maximum(k * (p - a1), np.minimum(k * (p - a2), w)), 0.0, travel)
            x[:] = _follow(x, 0.5 * (w + w_next), d.tau_s, rate, part_s)
            w[:] = w_next
        return replace(inside.turned(command_psi), p=p)


def _points(mean: FloatArray, cov: FloatArray) -> FloatArray:
    """Fourteen points, shape (7, 14), with this mean and covariance."""
    values, vectors = np.linalg.eigh(cov)
    root = vectors * np.sqrt(SIZE * np.maximum(values, 0.0))
    points: FloatArray = mean[:, None] + np.hstack([root, -root])
    return points


def _follow(x: FloatArray, w: FloatArray, tau_s: float, rate: FloatArray, dt_s: float) -> FloatArray:
    """The rate-limited lag of `observer.follow`, for many."""
    gap = w - x
    straight_s = np.clip((np.abs(gap) / rate - tau_s), 0.0, dt_s)
    x = x + np.copysign(rate * straight_s, gap)
    moved: FloatArray = w - (w - x) * np.exp(-(dt_s - straight_s) / tau_s) if tau_s > 0.0 else w
    return moved


def _updated(
    mean: FloatArray, cov: FloatArray, h: FloatArray, off: float, variance: float, learns: int
) -> tuple[FloatArray, FloatArray]:
    """The first `learns` of the five after h times them was found to be larger by `off`; the others are only
    considered (Schmidt's filter), with Joseph's form of the covariance, which stays one whatever the gain."""
    toward = cov @ h
    gain = toward / (float(h @ toward) + variance)
    gain[learns:] = 0.0
    keep = np.eye(SIZE) - np.outer(gain, h)
    return mean + gain * off, keep @ cov @ keep.T + variance * np.outer(gain, gain)


def _row(edge: int, slope: float, lever: float) -> FloatArray:
    """The derivative of compliance (p - edge) by the five."""
    row = np.zeros(SIZE)
    row[edge], row[K] = slope, lever
    return row


def _unit(place: int) -> FloatArray:
    row = np.zeros(SIZE)
    row[place] = 1.0
    return row


def _square(spread: tuple[float, ...]) -> FloatArray:
    return np.array(spread).reshape(SIZE, SIZE)


def _mean(inside: Inside, belief: Belief) -> FloatArray:
    return np.array([inside.x, belief.rate_limit, belief.travel, inside.w, inside.a1, inside.a2, belief.compliance])


def _with(belief: Belief, inside: Inside, mean: FloatArray, cov: FloatArray) -> Belief:
    x, rate_limit, travel, w, a1, a2, compliance = (float(value) for value in mean)
    inside, learned = replace(inside, x=x, w=w, a1=a1, a2=a2), tuple(cov.ravel())
    return replace(belief, inside=inside, compliance=compliance, rate_limit=rate_limit, travel=travel, spread=learned)


def _stopped(belief: Belief, inside: Inside) -> bool:
    return inside.w <= 0.0 or inside.w >= belief.travel - 1e-9
