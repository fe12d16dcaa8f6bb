"""Breakaway friction above sliding friction: the stem sticks, then slips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from twin.kernels.slots import FOREVER
from twin.kernels.valve_slots import (
    V_AGING_S,
    V_BREAKAWAY,
    V_FADES_SQUARED,
    V_HELD,
    V_SHORT,
    V_STICK_SPEED,
    V_STRIBECK,
    V_STRIBECK_SPEED,
    V_TARGET_STICKS,
    V_TAU_AFTER_S,
)
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter

#: Speed of the target below which it rests where friction grows with the time at rest, as a share of the rate limit.
_REST = 2e-5

_BREAKAWAY = Parameter(
    name="breakaway",
    kind="pressure",
    lower=0.0,
    upper=4.0,
    starts=(0.03, 0.1, 0.2, 0.4, 0.8, 1.6),
    scale=0.6,
    doc="pressure above the sliding curve that is needed to start",
    smooth=False,
)
#: Whole jumps of this size make the way, so that a hundredth too much shifts the last of many by half a jump.
_JUMP = replace(_BREAKAWAY, looks=112)
_STICK_SPEED = Parameter(
    name="stick_speed",
    kind="position_rate",
    lower=1e-5,
    upper=0.05,
    starts=(3e-4, 2e-3, 8e-3),
    scale=4e-3,
    doc="below this speed the stem sticks again",
    neutral=2e-3,
    smooth=False,
    size=False,
)
_TARGET_SPEED = Parameter(
    name="stick_speed",
    kind="position_rate",
    lower=1e-5,
    upper=0.1,
    starts=(5e-4, 4e-3, 1.5e-2, 3e-2),
    scale=4e-3,
    doc="below this speed the target of the stem sticks again",
    neutral=2e-3,
    smooth=False,
    size=False,
)
_AGING = Parameter(
    name="aging",
    kind="time",
    lower=0.05,
    upper=100.0,
    starts=(1.0, 5.0, 15.0),
    scale=5.0,
    doc="time at rest after which 63 % of the breakaway is there",
    neutral=5.0,
    size=False,
)
_FALL_SPEED = Parameter(
    name="fall_speed",
    kind="position_rate",
    lower=1e-4,
    upper=0.1,
    starts=(2e-3, 1e-2),
    scale=1e-2,
    doc="speed at which the extra friction has fallen to 1/e",
    neutral=1e-2,
    size=False,
)

_SHORT = Parameter(
    name="breakaway",
    kind="pressure",
    lower=0.0,
    upper=4.0,
    starts=(0.01, 0.05, 0.2, 0.8),
    scale=0.6,
    doc="pressure by which friction at no speed exceeds that at full speed",
)
_INERTIA = Parameter(
    name="inertia",
    kind="time",
    lower=0.0,
    upper=0.06,
    starts=(0.02,),
    scale=0.03,
    doc="mass of the moving parts over their damping: how late the speed follows",
    neutral=0.02,
    size=False,
)


def _slip_until_slow(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_BREAKAWAY] = values[0]
    c.valve[V_STICK_SPEED] = values[1]


def _target_sticks(c: Coefficients, values: Sequence[float]) -> None:
    _slip_until_slow(c, values)
    c.valve[V_TARGET_STICKS] = 1.0


def _target_sticks_pressed(c: Coefficients, values: Sequence[float]) -> None:
    """What moves the stem has stops itself: pressed against one, it breaks away by what the stop holds, too."""
    _slip_until_slow(c, values)
    c.valve[V_TARGET_STICKS] = 2.0


def _grows_at_rest(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_BREAKAWAY] = values[0]
    c.valve[V_AGING_S] = values[1]
    c.valve[V_STICK_SPEED] = _REST * c.design.rate_limit
    c.valve[V_TARGET_STICKS] = 1.0


def _one_jump(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_BREAKAWAY] = values[0]
    c.valve[V_STICK_SPEED] = FOREVER


def _falling(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_STRIBECK] = values[0]
    c.valve[V_STRIBECK_SPEED] = values[1]


def _falling_squared(c: Coefficients, values: Sequence[float]) -> None:
    _falling(c, values)
    c.valve[V_FADES_SQUARED] = 1.0


def _held_stem(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_HELD] = values[0] * c.design.compliance
    c.valve[V_STICK_SPEED] = values[1]


def _pressed(c: Coefficients, values: Sequence[float]) -> None:
    """Friction holds the stem only, so what pulls it goes on where a stop would hold the stem, and gets it there."""
    _held_stem(c, values)
    c.press_beyond_stops(c.valve[V_HELD], c.valve[V_HELD])


def _short(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_SHORT] = values[0] * c.design.compliance
    c.valve[V_STRIBECK_SPEED] = values[1]
    if values[0] > 0.0:
        c.valve[V_TAU_AFTER_S] += values[2]


EFFECT = Effect(
    name="stiction",
    stage="actuator",
    claim="The stem sticks until the pressure exceeds sliding friction by the breakaway, then slips.",
    equations="stuck while o(p + s) >= w >= c(p - s); slipping: w = play(p); sticks again below the stick speed, and "
    "has to break away the other way in any case; target_sticks: the target w itself sticks below the stick speed, and "
    "what the stops keep it from does not pull at it; target_sticks_pressed: or does; grows_at_rest: as the first with "
    "s (1 - exp(-rest / aging)); held_stem: x stays while |w - x| <= k s; held_stem_pressed: likewise, and w goes k s "
    "beyond the stops of x at most; falling_with_speed: half deadband + s exp(-|dx/dt| / fall_speed); "
    "falling_with_speed_squared: likewise with exp(-(dx/dt / fall_speed)^2); "
    "short_of_target: what pulls the stem is |w - x| less k s exp(-|dx/dt| / fall_speed)",
    source="Karnopp, J. Dyn. Syst. Meas. Control 107 (1985) 100; He et al., Ind. Eng. Chem. Res. 46 (2007) 4549; "
    "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083 (Stribeck, growth at rest)",
    forms=(
        Form("slip_until_slow", (_BREAKAWAY, _STICK_SPEED), _slip_until_slow),
        Form("target_sticks", (_BREAKAWAY, _TARGET_SPEED), _target_sticks),
        Form("target_sticks_pressed", (_BREAKAWAY, _TARGET_SPEED), _target_sticks_pressed),
        Form("grows_at_rest", (_BREAKAWAY, _AGING), _grows_at_rest),
        Form("one_jump", (_JUMP,), _one_jump),
        Form("held_stem", (_BREAKAWAY, _STICK_SPEED), _held_stem),
        Form("held_stem_pressed", (_BREAKAWAY, _STICK_SPEED), _pressed),
        Form("falling_with_speed", (_BREAKAWAY, _FALL_SPEED), _falling),
        Form("falling_with_speed_squared", (_BREAKAWAY, _FALL_SPEED), _falling_squared),
        Form("short_of_target", (_SHORT, _FALL_SPEED, _INERTIA), _short),
    ),
    twins=("distributed_hysteresis", "position_dependent_friction"),
    absorbs=("deadband", "tau"),
    erratic=True,
)
