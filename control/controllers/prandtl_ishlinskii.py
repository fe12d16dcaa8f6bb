"""Inverse of a Prandtl-Ishlinskii model (a spread of plays instead of one), with an integral part for what is left."""

from __future__ import annotations

import math
from dataclasses import dataclass

from control.controller import Law, Seen
from control.exact import lag


@dataclass(frozen=True, slots=True)
class PlaysState:
    """The output of each play [psi], the filtered pressure [psi], the integral part [in] and the command [psi]."""

    plays_psi: tuple[float, ...]
    filtered_psi: float
    integral_in: float
    command_psi: float


@dataclass(frozen=True)
class PrandtlIshlinskii(Law[PlaysState]):
    """w = k mean_i play_i(P - offset), half widths (a1 - a2) / 2 + `spread_psi` (-1 ... 1); the command is the pressure
    nearest to the present one at which the plays give target + I, with dI/dt = ki e [ki in 1/s].

    Errors within `tolerance_in` are left alone. Source: Kuhnen, "Modeling, identification and compensation of complex
    hysteretic nonlinearities: a modified Prandtl-Ishlinskii approach", European J. of Control 9 (2003); his inverse is
    in closed form, this one is found by bisection, because a pure deadband has no closed-form inverse.
    """

    spread_psi: float = 0.15
    count: float = 7.0
    ki: float = 0.08
    tolerance_in: float = 0.0012
    window_in: float = 0.1

    def start(self, seen: Seen, target_in: float) -> PlaysState:
        x_psi = min(max(seen.position_in, 0.0), self.design.travel) / self.design.compliance
        away_psi = seen.pressure_psi - self.design.offset
        plays = tuple(min(max(x_psi, away_psi - r), away_psi + r) for r in self._widths())
        room_in = abs(self.spread_psi) * self.design.compliance
        spread_in = min(max(self._output(plays) - x_psi * self.design.compliance, -room_in), room_in)
        return PlaysState(plays, seen.pressure_psi, spread_in, seen.commanded_psi)

    def law(self, state: PlaysState, seen: Seen, target_in: float, dt_s: float) -> tuple[PlaysState, float]:
        share = lag(dt_s, 0.2)
        filtered_psi = state.filtered_psi + share * (seen.pressure_psi - state.filtered_psi)
        plays = self._moved(state.plays_psi, filtered_psi)
        error_in = target_in - seen.position_in
        integral_in = state.integral_in
        if abs(error_in) < self.window_in:
            integral_in = min(max(integral_in + self.ki * error_in * dt_s, -self.window_in), self.window_in)
        wish_in = self._beyond_stops(target_in, target_in + integral_in)
        command_psi = state.command_psi
        if abs(wish_in - self._output(plays)) > self.tolerance_in:
            command_psi = self.clamp(self._inverse(plays, filtered_psi, wish_in))
        return PlaysState(plays, filtered_psi, integral_in, command_psi), command_psi

    def _widths(self) -> list[float]:
        n = max(int(self.count), 1)
        half = 0.5 * self.design.deadband
        return [max(half + self.spread_psi * (2.0 * i / (n - 1) - 1.0 if n > 1 else 0.0), 0.0) for i in range(n)]

    def _moved(self, plays: tuple[float, ...], pressure_psi: float) -> tuple[float, ...]:
        away_psi = pressure_psi - self.design.offset
        return tuple(min(max(z, away_psi - r), away_psi + r) for z, r in zip(plays, self._widths(), strict=True))

    def _output(self, plays: tuple[float, ...]) -> float:
        return self.design.compliance * math.fsum(plays) / len(plays)

    def _beyond_stops(self, target_in: float, wish_in: float) -> float:
        """At an end stop the wish goes beyond it: a stop forgives."""
        margin = 0.1 * self.design.travel
        if target_in <= 0.0:
            return min(wish_in, -margin)
        return max(wish_in, self.design.travel + margin) if target_in >= self.design.travel else wish_in

    def _inverse(self, plays: tuple[float, ...], pressure_psi: float, wish_in: float) -> float:
        """The pressure nearest to `pressure_psi` at which the plays give the wish [psi], to 1e-4 psi."""
        rising = wish_in > self._output(plays)
        near, far = pressure_psi, (self.max_psi if rising else self.min_psi)
        while abs(far - near) > 1e-4:
            middle = 0.5 * (near + far)
            short = self._output(self._moved(plays, middle)) < wish_in
            near, far = (middle, far) if short == rising else (near, middle)
        return far


CONTROLLER = PrandtlIshlinskii
