"""What the readings say about the inside of the valve: play output, stem, both edges of the play, converter bias.

A Luenberger observer around the design equations. The play decides what an innovation of the position means: in contact
it moves the edge that is in contact, inside the gap it moves the play output; at an end stop it says nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from control.controller import Seen
from control.dead_time import DeadTime, no_dead_time
from control.design import DesignModel
from control.exact import decay, lag

MIDDLE_PSI = 9.0
TURN_PSI = 0.15  # smaller changes of command do not turn the converter's hysteresis round


@dataclass(frozen=True, slots=True)
class Inside:
    """The estimate at one instant. Pressures in psi, positions in inches; `a1`, `a2` are the edges as learned so far.

    A command u settles at u + `bias` + `slope` (u - 9 psi) + `kink` `way`: the converter's zero error, gain error and
    hysteresis; `way` is the direction of the last change of command (+1, -1; 0 at first). `seen_psi` is the last
    pressure reading.
    """

    p: float
    w: float
    x: float
    a1: float
    a2: float
    seen_psi: float
    line: DeadTime
    bias: float = 0.0
    slope: float = 0.0
    kink: float = 0.0
    way: int = 0
    turned_psi: float = 0.0

    def settles(self, command_psi: float) -> float:
        """The pressure at which a command settles [psi]."""
        return command_psi + self.bias + self.slope * (command_psi - MIDDLE_PSI) + self.kink * self._way(command_psi)

    def command_for(self, pressure_psi: float) -> float:
        """The command that settles at this pressure [psi]."""
        away_psi = pressure_psi - self.p
        way = self.way if abs(away_psi) < TURN_PSI else (1 if away_psi > 0.0 else -1)
        return (pressure_psi - self.bias - self.kink * way + self.slope * MIDDLE_PSI) / (1.0 + self.slope)

    def turned(self, command_psi: float) -> Inside:
        """With the direction of this command; `turned_psi` is the furthest command in that direction."""
        way = self._way(command_psi)
        furthest = max if way > 0 else min
        kept_psi = furthest(self.turned_psi, command_psi) if way == self.way and way else command_psi
        return replace(self, way=way, turned_psi=kept_psi)

    def _way(self, command_psi: float) -> int:
        away_psi = command_psi - self.turned_psi
        return self.way if abs(away_psi) < TURN_PSI else (1 if away_psi > 0.0 else -1)


@dataclass(frozen=True, slots=True)
class Observer:
    """Frozen settings: the design, the gains of the pressure correction and of the converter's calibration."""

    design: DesignModel
    pressure_gain: float = 0.3
    bias_gain: float = 0.05

    def start(self, seen: Seen) -> Inside:
        """At rest at the reading; edges from the design, moved where the reading contradicts them."""
        d = self.design
        w = min(max(seen.position_in, 0.0), d.travel)
        return self._consistent(self.on_stop(self._first(seen, w)))

    def _first(self, seen: Seen, w: float) -> Inside:
        d, line = self.design, no_dead_time(seen.commanded_psi)
        p, command_psi = seen.pressure_psi, seen.commanded_psi
        return Inside(p, w, seen.position_in, d.a1, d.a2, p, line, turned_psi=command_psi)

    def track(self, inside: Inside, seen: Seen, dt_s: float, omega: float) -> tuple[Inside, Inside]:
        """The estimate for the next tick, and the one for the instant at which the next command begins to act.

        `inside` is what this gave for the instant of the reading; `omega` is the bandwidth of the correction [rad/s].
        """
        keep = self.correct(inside, seen, dt_s, omega)
        for command_psi, share in keep.line.next_tick:
            keep = self.ahead(keep, command_psi, share * dt_s)
        acts = keep
        for command_psi, share in keep.line.after_that:
            acts = self.ahead(acts, command_psi, share * dt_s)
        return keep, acts

    def correct(self, inside: Inside, seen: Seen, dt_s: float, omega: float) -> Inside:
        """The estimate for the instant of the reading, after looking at it."""
        d, k = self.design, self.design.compliance
        pressure_error = seen.pressure_psi - inside.p
        p = inside.p + self.pressure_gain * pressure_error
        innovation = seen.position_in - inside.x
        tau_s = d.tau_s or dt_s  # of a stem that is said to have no lag no more is seen than that it follows in a tick
        x = inside.x + min(dt_s * max(1.6 * omega - 1.0 / tau_s, 0.3), 0.8) * innovation
        push = min(dt_s * tau_s * omega * omega, 0.8 / dt_s * tau_s) * innovation
        running = abs(inside.w - inside.x) > d.rate_limit * tau_s
        if running and push * (inside.w - inside.x) > 0.0:
            push = 0.0  # faster than the limit says nothing of how far the play output is ahead
        moved = self.on_stop(replace(self.learn_converter(inside, pressure_error, seen, dt_s), p=p, x=x))
        if moved.w <= 0.0 or moved.w >= d.travel:
            return self._at_stop(moved, push)
        closing, opening = self.contact(inside)
        if closing:
            moved = replace(moved, w=inside.w + k * (p - inside.p) + push, a1=inside.a1 - push / k)
        elif opening:
            moved = replace(moved, w=inside.w + k * (p - inside.p) + push, a2=inside.a2 - push / k)
        else:
            moved = replace(moved, w=inside.w + push)
        return self._consistent(moved)

    def learn_converter(self, inside: Inside, pressure_error: float, seen: Seen, dt_s: float) -> Inside:
        """Dead time, and (by normalized least mean squares, near the command) zero and gain error, as learned."""
        tau_s = self.design.ep_tau_s
        share, pace = lag(dt_s, tau_s), dt_s / tau_s if tau_s > 0.0 else math.inf
        before_psi, command_psi = inside.seen_psi, inside.line.arriving
        line = replace(inside.line, pace=pace).judged(
            seen.pressure_psi, lambda u: before_psi + share * (inside.settles(u) - before_psi)
        )
        moved = replace(inside, line=line.and_sent(seen.commanded_psi), seen_psi=seen.pressure_psi)
        if abs(inside.settles(command_psi) - inside.p) > 0.7:
            return moved
        lever = (command_psi - MIDDLE_PSI) / 2.0
        way = inside.way
        step = self.bias_gain * pressure_error / share / (1.0 + lever * lever + way * way)
        slope = min(max(inside.slope + step * lever / 2.0, -0.1), 0.1)
        return replace(moved, bias=inside.bias + step, slope=slope, kink=inside.kink + step * way)

    def contact(self, inside: Inside) -> tuple[bool, bool]:
        """Whether the play is in contact on its closing and on its opening side."""
        k, slack_in = self.design.compliance, 1e-9
        return inside.w <= k * (inside.p - inside.a1) + slack_in, inside.w >= k * (inside.p - inside.a2) - slack_in

    def ahead(self, inside: Inside, command_psi: float, dt_s: float) -> Inside:
        """The estimate `dt_s` later with this command in force, by the design equations."""
        d, k = self.design, self.design.compliance
        parts = max(math.ceil(dt_s / 0.03 - 1e-9), 1)
        part_s = dt_s / parts
        share = lag(part_s, d.ep_tau_s)
        p, w, x, settles = inside.p, inside.w, inside.x, inside.settles(command_psi)
        for _ in range(parts):
            p += share * (settles - p)
            w_next = min(max(k * (p - inside.a1), min(k * (p - inside.a2), w), 0.0), d.travel)
            x = follow(x, 0.5 * (w + w_next), d.tau_s, d.rate_limit, part_s)
            w = w_next
        return replace(inside.turned(command_psi), p=p, w=w, x=x)

    def on_stop(self, inside: Inside) -> Inside:
        """The play output on an end stop, where it is next to it and the pressure does not hold it off."""
        d, near_in = self.design, 0.01 * self.design.travel
        if inside.w <= near_in and inside.p <= inside.a2 + inside.w / d.compliance:
            return replace(inside, w=0.0)
        if inside.w >= d.travel - near_in and inside.p >= inside.a1 + inside.w / d.compliance:
            return replace(inside, w=d.travel)
        return inside

    def _consistent(self, inside: Inside) -> Inside:
        """Edges moved out of the way of the play output: it cannot be outside of the gap."""
        if inside.w <= 0.0 or inside.w >= self.design.travel:
            return inside
        k = self.design.compliance
        a1 = max(inside.a1, inside.p - inside.w / k)
        a2 = min(inside.a2, inside.p - inside.w / k)
        return replace(inside, a1=max(a1, a2 + 0.05), a2=a2)

    def _at_stop(self, inside: Inside, push: float) -> Inside:
        """At an end stop only an innovation away from the stop means something: the edge is nearer than thought."""
        d, k = self.design, self.design.compliance
        if inside.w <= 0.0 and push > 0.02 * d.travel:
            return replace(inside, w=push, a1=inside.p - push / k)
        if inside.w >= d.travel and push < -0.02 * d.travel:
            return replace(inside, w=d.travel + push, a2=inside.p - (d.travel + push) / k)
        return inside


def follow(x: float, w: float, tau_s: float, rate: float, dt_s: float) -> float:
    """The rate-limited first-order lag with a constant input, exactly: straight while too far behind, then a decay."""
    gap = w - x
    far = abs(gap) - rate * tau_s
    if far > 0.0:
        straight_s = min(far / rate, dt_s)
        x += math.copysign(rate * straight_s, gap)
        dt_s -= straight_s
    return w - (w - x) * decay(dt_s / tau_s) if tau_s > 0.0 else w
