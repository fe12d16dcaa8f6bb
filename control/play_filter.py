"""A Kalman filter through the play: stem, play output, both edges and the compliance, each with how sure it is.

The play decides what a reading tells. While an edge pushes, play output and edge are one thing, so that a dwell after
the move teaches the edge as well; inside the gap the play output is a constant, which a longer dwell knows better.
Source: the extended Kalman filter; the moments of the larger of two normal variables (which edge or output it is that
counts, while that is uncertain) are Clark's, "The greatest of a finite set of random variables", 1961.
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
X, W, A1, A2, K = range(5)
NOISE_IN = 0.0006
EDGE_PSI, STIFFNESS, MOST_STIFFNESS = 0.3, 0.015, 0.1  # standard deviations of what the design may be wrong by
WALK_PSI, CREEP_IN = 0.03, 1.5e-4  # random walk of the edges per travel moved, of the play output per root second
NOISE_PSI, STOP_IN = 0.004, 0.003


@dataclass(frozen=True, slots=True)
class Belief:
    """Means in `inside` and `compliance` [in/psi]; `spread` is the covariance of (x, w, a1, a2, compliance), row by
    row; `noise_in`, `noise_psi` the standard deviations of one reading; `doubt_psi` that of the pressure estimate;
    `missed` by how much the last readings of position and pressure were off."""

    inside: Inside
    compliance: float
    spread: tuple[float, ...]
    noise_in: float = NOISE_IN
    noise_psi: float = NOISE_PSI
    doubt_psi: float = NOISE_PSI
    missed: tuple[float, float] = (0.0, 0.0)

    @property
    def doubt_in(self) -> float:
        """Standard deviation of the play output [in]."""
        return math.sqrt(max(self.spread[5 * W + W], 0.0))

    def edge_psi(self, position_in: float, side: int) -> float:
        """The pressure at which the edge on this side (+1 closing, -1 opening) holds the play output there."""
        return (self.inside.a1 if side > 0 else self.inside.a2) + position_in / self.compliance

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
        sds = (NOISE_IN, 0.004, EDGE_PSI, EDGE_PSI, STIFFNESS * d.compliance)
        return Belief(Observer(d).start(seen), d.compliance, tuple(np.diag(np.square(sds)).ravel()))

    def observer(self, belief: Belief) -> Observer:
        """The design equations with the compliance as learned."""
        return Observer(replace(self.design, compliance=belief.compliance), bias_gain=0.1)

    def track(self, belief: Belief, seen: Seen, dt_s: float) -> tuple[Belief, Belief]:
        """The belief for the next tick, and for the instant at which the next command begins to act."""
        keep = self._correct(belief, seen, dt_s)
        keep = self.ahead(keep, keep.inside.line.arriving, dt_s)
        acts = keep
        for command_psi in keep.inside.line.queued:
            acts = self.ahead(acts, command_psi, dt_s)
        newest_psi, share = keep.inside.line.rest
        return keep, self.ahead(acts, newest_psi, share * dt_s) if share else acts

    def _correct(self, belief: Belief, seen: Seen, dt_s: float) -> Belief:
        inside, observer = belief.inside, self.observer(belief)
        off_in, off_psi = seen.position_in - inside.x, seen.pressure_psi - inside.p
        belief = self._noise(belief, off_in, off_psi)
        p = inside.p + max(0.3, off_psi**2 / (off_psi**2 + (4.0 * belief.noise_psi) ** 2)) * off_psi
        closing, opening = observer.contact(inside)
        w = inside.w + (belief.compliance * (p - inside.p) if closing or opening else 0.0)
        inside = observer.on_stop(replace(observer.learn_converter(inside, off_psi, seen, dt_s), p=p, w=w))
        variance = 2.0 * belief.noise_in**2  # half of the noise is slow: counted double
        cov = _square(belief.spread)
        learns = 1 if self._stopped(inside) else 5 if off_in**2 < 9.0 * (cov[X, X] + variance) else K
        mean, cov = _updated(_mean(inside, belief.compliance), cov, _unit(X), off_in, variance, learns)
        near = replace(inside, w=float(mean[W]), a1=float(mean[A1]), a2=float(mean[A2]))
        mean[W] = observer.on_stop(near).w
        mean, cov = self._consistent(mean, cov, p, belief.doubt_psi)
        most = MOST_STIFFNESS * self.design.compliance
        mean[K] = min(max(mean[K], self.design.compliance - most), self.design.compliance + most)
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

    def _stopped(self, inside: Inside) -> bool:
        return inside.w <= 0.0 or inside.w >= self.design.travel

    def _consistent(
        self, mean: FloatArray, cov: FloatArray, p: float, doubt_psi: float
    ) -> tuple[FloatArray, FloatArray]:
        """The play output inside the gap: where it is not, it and the edge give way, the less sure one more."""
        if 0.0 < mean[W] < self.design.travel:
            for a, side in ((A1, 1.0), (A2, -1.0)):
                beyond = side * (mean[K] * (p - mean[a]) - mean[W])
                if beyond > 0.0:
                    h = side * _row(edge=a, slope=-mean[K], lever=p - mean[a]) - side * _unit(W)
                    mean, cov = _updated(mean, cov, h, -beyond, (mean[K] * doubt_psi) ** 2, K)
        return mean, cov

    def ahead(self, belief: Belief, command_psi: float, dt_s: float) -> Belief:
        """The belief `dt_s` later with this command in force."""
        d, before = self.design, belief.inside
        after = self.observer(belief).ahead(before, command_psi, dt_s)
        moved_in = abs(after.w - before.w)
        turn = np.eye(5)
        if abs(after.w - after.x) <= d.rate_limit * d.tau_s:
            turn[X, X] = math.exp(-dt_s / d.tau_s) if d.tau_s > 0.0 else 0.0
            turn[X, W] = 1.0 - turn[X, X]
        cov, side = _square(belief.spread), 1 if after.p > before.p else -1
        share, row = self._pushing(belief, after, side, cov)
        turn[W] = 0.0 if self._stopped(after) else share * row + (1.0 - share) * _unit(W)
        cov = turn @ cov @ turn.T
        cov[W, W] += STOP_IN**2 if self._stopped(after) else 0.0
        cov[W, W] += CREEP_IN**2 * dt_s + (belief.compliance * belief.doubt_psi * share) ** 2 * (moved_in > 1e-4)
        cov[X, X] += (0.1 * (after.x - before.x)) ** 2
        cov[A1, A1] += WALK_PSI**2 * moved_in / d.travel
        cov[A2, A2] += WALK_PSI**2 * moved_in / d.travel
        return replace(belief, inside=after, spread=tuple(cov.ravel()))

    def _pushing(self, belief: Belief, after: Inside, side: int, cov: FloatArray) -> tuple[float, FloatArray]:
        """The chance that the edge of this side pushes the play output now, and what that is then made of."""
        edge = after.a1 if side > 0 else after.a2
        row = _row(edge=A1 if side > 0 else A2, slope=-belief.compliance, lever=after.p - edge)
        if side * (after.p - belief.inside.p) < 0.002:
            return 0.0, row
        apart = row - _unit(W)
        spread_in = math.sqrt(max(float(apart @ cov @ apart), 1e-12))
        ahead_in = side * (belief.compliance * (after.p - edge) - belief.inside.w)
        return 0.5 * math.erfc(-ahead_in / spread_in / math.sqrt(2.0)), row


def _updated(
    mean: FloatArray, cov: FloatArray, h: FloatArray, off: float, variance: float, learns: int
) -> tuple[FloatArray, FloatArray]:
    """The first `learns` of the five after h times them was found to be larger by `off`; the others are only
    considered (Schmidt's filter), with Joseph's form of the covariance, which stays one whatever the gain."""
    toward = cov @ h
    gain = toward / (float(h @ toward) + variance)
    gain[learns:] = 0.0
    keep = np.eye(5) - np.outer(gain, h)
    return mean + gain * off, keep @ cov @ keep.T + variance * np.outer(gain, gain)


def _row(edge: int, slope: float, lever: float) -> FloatArray:
    """The derivative of compliance (p - edge) by the five."""
    row = np.zeros(5)
    row[edge], row[K] = slope, lever
    return row


def _unit(place: int) -> FloatArray:
    row = np.zeros(5)
    row[place] = 1.0
    return row


def _square(spread: tuple[float, ...]) -> FloatArray:
    return np.array(spread).reshape(5, 5)


def _mean(inside: Inside, compliance: float) -> FloatArray:
    return np.array([inside.x, inside.w, inside.a1, inside.a2, compliance])


def _with(belief: Belief, inside: Inside, mean: FloatArray, cov: FloatArray) -> Belief:
    x, w, a1, a2, compliance = (float(value) for value in mean)
    inside = replace(inside, x=x, w=w, a1=a1, a2=a2)
    return replace(belief, inside=inside, compliance=compliance, spread=tuple(cov.ravel()))
