"""The reading is a curved function of position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from logs.recording import Recording
from twin.kernels.sensor_slots import (
    S_AT_OPEN,
    S_BOW,
    S_FROM,
    S_GAIN,
    S_KINK,
    S_KINK_AT,
    S_LEAVES,
    S_OTHER,
    S_SWING,
    S_TABLE,
    S_TRAVEL,
    S_WAVE,
    S_ZERO,
    TABLE,
)
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter, Scales


def _parameter(name: str, doc: str) -> Parameter:
    return Parameter(
        name=name,
        kind="fraction",
        lower=-0.25,
        upper=0.25,
        starts=(-0.01, 0.01),
        scale=0.02,
        doc=doc,
    )


#: A cube is its line less so much of a bow, and so much of a swing: z - z^3 = z (1 - z) (1.5 - 0.5 (1 - 2 z)).
_OF_A_CUBE, _SWINGS = 1.5 / 4.0, 0.5 / 10.4

_BOW = _parameter("bow", "excess of the reading at mid travel, fraction of travel")
_WAVE = _parameter("wave", "amplitude of one wave of a sine, excess at a quarter of travel, fraction of travel")
_SWING = _parameter("swing", "amplitude of the S-shaped part, excess at 21 % of travel, fraction of travel")


def _bend(end: str) -> Parameter:
    # A quarter of it is a bow, the rest a line: curves that are the same have to be as likely, in whatever number.
    bend = _parameter("bend", f"excess of the reading at fully {end}, fraction of travel")
    return replace(bend, starts=(-0.04, 0.04), scale=0.08)


def _cubed(end: str) -> Parameter:
    """Three eighths of it are a bow."""
    return replace(_bend(end), scale=0.02 / _OF_A_CUBE)


_LINE = Parameter(
    name="line",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.6,),
    scale=0.3,
    doc="share of its line that the calibration took out: 0.6 by least squares, 1 by the ends",
    neutral=0.6,
    size=False,
)


def _bow(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_BOW] = values[0]


def _wave(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_WAVE] = values[0]


def _swing(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_SWING] = values[0]


def _both(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_BOW] = values[0]
    c.sensor[S_SWING] = values[1]


def _about_open(c: Coefficients, values: Sequence[float]) -> None:
    """xi^2 is xi less a bow."""
    _bent(c, gain=values[0], bow=-0.25 * values[0])


def _about_closed(c: Coefficients, values: Sequence[float]) -> None:
    """(1 - xi)^2 is 1 - xi less a bow."""
    _bent(c, gain=-values[0], bow=-0.25 * values[0], zero=values[0])


def _cubed_open(c: Coefficients, values: Sequence[float]) -> None:
    _bent(c, gain=values[0], bow=-_OF_A_CUBE * values[0], swing=_SWINGS * values[0])


def _cubed_closed(c: Coefficients, values: Sequence[float]) -> None:
    """The same seen from the other end, where a swing goes the other way."""
    _bent(c, gain=-values[0], bow=-_OF_A_CUBE * values[0], swing=-_SWINGS * values[0], zero=values[0])


def _about_mid(c: Coefficients, values: Sequence[float]) -> None:
    _cubic(c, (values[0], 0.0))


def _cubic(c: Coefficients, values: Sequence[float]) -> None:
    """u^3 less a part of its line, u = 2 xi - 1: which line a calibration has put through the curve nobody says.

    u^3 is u and a swing.
    """
    bend, line = values
    _bent(c, gain=2.0 * bend * (1.0 - line), swing=bend * 4.0 / 10.4, zero=-bend * (1.0 - line))


def _bent(c: Coefficients, gain: float, bow: float = 0.0, swing: float = 0.0, zero: float = 0.0) -> None:
    c.sensor[S_BOW], c.sensor[S_SWING] = bow / (1.0 + gain), swing / (1.0 + gain)  # the gain comes behind the curve
    c.sensor[S_GAIN] *= 1.0 + gain
    c.sensor[S_ZERO] += zero * c.sensor[S_TRAVEL]


def _leaving(end: str) -> tuple[Parameter, Parameter]:
    begins = Parameter(
        name="range",
        kind="fraction",
        lower=0.2,
        upper=0.9,
        starts=(0.45, 0.75),
        scale=0.2,
        doc=f"share of the travel, from the other end, within which the reading is straight ({end} end)",
        neutral=0.6,
        size=False,
    )
    return _bend(end), begins


def _other_bend() -> Parameter:
    return replace(_bend("open"), name="other_bend")


def _middle() -> Parameter:
    doc = "share of the travel, in its middle, within which the reading is straight"
    return replace(_leaving("either")[1], starts=(0.4, 0.7), doc=doc)


def _leaves_closed(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[[S_LEAVES, S_FROM]] = values


def _leaves_open(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[[S_LEAVES, S_FROM, S_AT_OPEN]] = values[0], 1.0 - values[1], 1.0


def _leaves_both(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[[S_LEAVES, S_OTHER, S_FROM]] = values[0], values[1], 0.5 + 0.5 * values[2]


def _kink(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[[S_KINK, S_KINK_AT]] = values


_AT = Parameter(
    name="at",
    kind="fraction",
    lower=0.05,
    upper=0.95,
    starts=(0.3, 0.7),
    scale=0.2,
    doc="position at which they meet, fraction of travel",
    neutral=0.5,
    size=False,
)
_ENTRIES = tuple(
    _parameter(
        f"at_{round(100 * k / (TABLE + 1))}",
        f"excess of the reading at {k}/{TABLE + 1} of the travel, fraction of travel",
    )
    for k in range(1, TABLE + 1)
)


def _table(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_TABLE : S_TABLE + TABLE] = values


def _uneven(_records: Sequence[Recording], _scales: Scales) -> list[tuple[float, ...]]:
    """Every second entry too high: from there a least squares finds all of them."""
    return [tuple(0.005 if k % 2 == odd else -0.005 for k in range(TABLE)) for odd in (0, 1)]


EFFECT = Effect(
    name="lvdt_nonlinearity",
    stage="sensor",
    claim="The reading is a curved function of position.",
    equations="y = x + travel (bow 4 xi (1 - xi) + swing 10.4 xi (1 - xi) (1 - 2 xi)), xi = x / travel; "
    "wave: y = x + travel wave sin(2 pi xi); "
    "about_*: y = x + travel bend s, s = xi^2, (1 - xi)^2 or u^3, u = 2 xi - 1; cubed_*: xi^3 or (1 - xi)^3; "
    "cubic: u^3 - line u; leaves_range_*: "
    "s is the square of how far the core is beyond its linear range, as a share of what is left of the travel there; "
    "kink: straight from 0 at both ends to the bend; table: straight between entries",
    source="Herceg, Schaevitz Handbook of Measurement and Control (1972); Doebelin, Measurement Systems (McGraw-Hill)",
    forms=(
        Form("bow", (_BOW,), _bow),
        Form("swing", (_SWING,), _swing),
        Form("wave", (_WAVE,), _wave),
        Form("bow_and_swing", (_BOW, _SWING), _both),
        Form("about_open", (_bend("closed"),), _about_open),
        Form("about_closed", (_bend("open"),), _about_closed),
        Form("cubed_about_open", (_cubed("closed"),), _cubed_open),
        Form("cubed_about_closed", (_cubed("open"),), _cubed_closed),
        Form("about_mid", (_bend("closed"),), _about_mid),
        Form("cubic", (_bend("closed"), _LINE), _cubic),
        Form("leaves_range_closed", _leaving("closed"), _leaves_closed),
        Form("leaves_range_open", _leaving("open"), _leaves_open),
        Form("leaves_range_both", (_bend("closed"), _other_bend(), _middle()), _leaves_both),
        Form("kink", (_parameter("bend", "excess where two straight halves meet, fraction of travel"), _AT), _kink),
        Form("table", _ENTRIES, _table, _uneven),
    ),
    twins=("nonlinear_spring", "flow_force"),
    absorbs=("compliance", "offset"),
)
