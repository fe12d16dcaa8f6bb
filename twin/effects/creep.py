"""A slow tail after the fast response: diaphragm and packing give way gradually."""

from __future__ import annotations

from collections.abc import Sequence

from twin.kernels.tails import PRESSED
from twin.kernels.valve_slots import (
    V_CREEP1,
    V_CREEP1_TAU_S,
    V_CREEP2,
    V_CREEP2_TAU_S,
    V_FORCE_CREEP,
    V_FORCE_CREEP_TAU_S,
    V_RELAX,
    V_RELAX_TARGET,
    V_RELAX_TAU_S,
    V_STRETCHED,
    V_STRETCHES,
    V_TARGET_CREEPS,
)
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter

#: The second time constant of the two-tail form is this many times the first.
RATIO = 6.0

_SHARE = Parameter(
    name="share",
    kind="fraction",
    lower=0.0,
    upper=0.7,
    starts=(0.01, 0.06, 0.2),
    scale=0.1,
    doc="share of the motion that comes late",
)

_APART = Parameter(
    name="apart",
    kind="fraction",
    lower=1.0,
    upper=60.0,
    starts=(6.0, 15.0),
    scale=10.0,
    doc="the longer time constant over the shorter",
    neutral=RATIO,
    size=False,
)

_LONG = Parameter(
    name="long",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.5,),
    scale=0.3,
    doc="part of the share that goes with the longer",
    neutral=0.5,
    size=False,
)

_BEGUN = Parameter(
    name="begun",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.2,),
    scale=0.5,
    doc="how much of it there is at the start of each recording",
    neutral=1.0,
    size=False,
)


def _tail(lower: float, starts: tuple[float, ...], doc: str) -> Parameter:
    return Parameter(
        name="tail",
        kind="time",
        lower=lower,
        upper=900.0,
        starts=starts,
        scale=30.0,
        doc=doc,
        neutral=30.0,
        size=False,
    )


def _one_tail(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_CREEP1] = values[0]
    c.valve[V_CREEP1_TAU_S] = values[1]


def _two_tails(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[[V_CREEP1, V_CREEP2]] = 0.5 * values[0]
    c.valve[V_CREEP1_TAU_S] = values[1]
    c.valve[V_CREEP2_TAU_S] = RATIO * values[1]


def _pull(c: Coefficients, values: Sequence[float]) -> None:
    _one_tail(c, values)
    c.valve[V_TARGET_CREEPS] = 1.0


def _pull_twice(c: Coefficients, values: Sequence[float]) -> None:
    _two_tails(c, values)
    c.valve[V_TARGET_CREEPS] = 1.0


def _pull_apart(c: Coefficients, values: Sequence[float]) -> None:
    share, tail_s, apart, long = values
    c.valve[[V_CREEP1, V_CREEP2]] = share * (1.0 - long), share * long
    c.valve[[V_CREEP1_TAU_S, V_CREEP2_TAU_S]] = tail_s, apart * tail_s
    c.valve[V_TARGET_CREEPS] = 1.0


def _press(c: Coefficients, values: Sequence[float]) -> None:
    _one_tail(c, values)
    c.valve[V_TARGET_CREEPS] = PRESSED


def _press_apart(c: Coefficients, values: Sequence[float]) -> None:
    _pull_apart(c, values)
    c.valve[V_TARGET_CREEPS] = PRESSED


def _stretch(c: Coefficients, values: Sequence[float]) -> None:
    _one_tail(c, values)
    c.valve[V_STRETCHES], c.valve[V_STRETCHED] = 1.0, values[2]


def _stretch_twice(c: Coefficients, values: Sequence[float]) -> None:
    _two_tails(c, values)
    c.valve[V_STRETCHES], c.valve[V_STRETCHED] = 1.0, values[2]


def _force(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_FORCE_CREEP] = values[0]
    c.valve[V_FORCE_CREEP_TAU_S] = values[1]


def _relax(c: Coefficients, values: Sequence[float]) -> None:
    # What gives way is the spring itself: a stem that a stop holds does not load it any more, as air goes on doing.
    c.valve[V_RELAX] = values[0] / c.design.compliance
    c.valve[V_RELAX_TAU_S] = values[1]


def _relax_target(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_RELAX_TARGET] = values[0] / c.design.compliance
    c.valve[V_RELAX_TAU_S] = values[1]


EFFECT = Effect(
    name="creep",
    stage="actuator",
    claim="A slow tail follows the fast response.",
    equations="reading = (1 - share) x + share z, dz/dt = (x - z) / tail; two tails: half of the share each, tail and "
    "6 tail; tails apart: long of it with apart times the tail; pull: the same on the target of the stem, before its "
    "lag and rate limit (on the stem where the two act on each other); pressed: as pull, of a target that ends at the "
    "upper stop / (1 - share) before its tails and at the stops after them; force: the same on the pressure before the "
    "play; stretch: reading = x + share z up to the stops, z as above and begun x at the start; "
    "spring: p = x/k + share (x - z)/k, dz/dt = (x - z) / tail; driven_spring: the same on the target of the stem, "
    "friction included (on the stem where the two act on each other)",
    source="Findley, Lai, Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials (North-Holland 1976), ch. 5",
    forms=(
        Form("one_tail", (_SHARE, _tail(4.0, (12.0, 50.0), "time constant of the tail")), _one_tail),
        Form("two_tails", (_SHARE, _tail(2.0, (5.0, 20.0), "the shorter of the two time constants")), _two_tails),
        Form("pull_tail", (_SHARE, _tail(4.0, (12.0, 50.0), "time constant of the tail of the pull")), _pull),
        Form("pull_tails", (_SHARE, _tail(2.0, (5.0, 20.0), "the shorter of the two time constants")), _pull_twice),
        Form(
            "pull_tails_apart",
            (_SHARE, _tail(2.0, (4.0, 10.0), "the shorter of the two time constants"), _APART, _LONG),
            _pull_apart,
        ),
        Form("pressed_tail", (_SHARE, _tail(4.0, (12.0, 50.0), "time constant of the tail of the pull")), _press),
        Form(
            "pressed_tails_apart",
            (_SHARE, _tail(2.0, (4.0, 10.0), "the shorter of the two time constants"), _APART, _LONG),
            _press_apart,
        ),
        Form("stretch", (_SHARE, _tail(4.0, (12.0, 50.0), "time in which it gives way"), _BEGUN), _stretch),
        Form("stretch_twice", (_SHARE, _tail(2.0, (5.0, 20.0), "the shorter of the two"), _BEGUN), _stretch_twice),
        Form("force_tail", (_SHARE, _tail(4.0, (12.0, 50.0), "time constant of the tail of the force")), _force),
        Form("spring_tail", (_SHARE, _tail(4.0, (12.0, 50.0), "time in which the spring relaxes")), _relax),
        Form("driven_spring_tail", (_SHARE, _tail(4.0, (12.0, 50.0), "time in which it relaxes")), _relax_target),
    ),
    absorbs=("compliance", "offset", "tau"),
)
