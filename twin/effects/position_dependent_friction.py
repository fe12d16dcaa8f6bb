"""The deadband is wider or narrower at some positions; a linear trend over position belongs to `spring_asymmetry`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from logs.recording import FloatArray, Recording
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter, Scales
from twin.model.shapes import CENTRE, WIDTH, bow, bump, detrended, edge

#: Length of the raised end, as a fraction of travel.
END = 0.12
#: Length of the edges of a band, likewise: as sharp as the grid on which the curves are bent.
_EDGE = 0.03


def _height(doc: str) -> Parameter:
    return Parameter(
        name="height",
        kind="pressure",
        lower=-1.45,
        upper=2.5,
        starts=(-0.25, -0.04, 0.04, 0.25, 0.8),
        scale=0.3,
        doc=doc,
    )


def _knot(at: float) -> Parameter:
    return Parameter(
        name=f"at_{round(100 * at)}",
        kind="pressure",
        lower=-1.45,
        upper=2.5,
        starts=(-0.02, 0.02),
        scale=0.1,
        doc=f"extra half deadband at {round(100 * at)} % of travel, straight between these points",
    )


_ACROSS = replace(
    WIDTH,
    upper=0.9,
    starts=(0.1, 0.2, 0.3),
    scale=0.15,
    doc="how much of the travel it covers, as a fraction",
    neutral=0.2,
)
#: Its valleys are narrow, where moves are few and far between: it is looked for on a finer net.
_IN_BAND = replace(_height("extra half deadband within the band"), starts=(-0.25, -0.1, -0.04, 0.04, 0.1, 0.25, 0.8))
_BAND_AT = replace(CENTRE, starts=(0.1, 0.3, 0.5, 0.7, 0.9))
#: A burr cuts one way only; one that helps is none.
_BURR = replace(
    _height("extra pressure at the centre, needed in one direction only"), lower=0.0, starts=(0.04, 0.25, 0.8)
)

_TIGHT_FROM = replace(_IN_BAND, doc="extra half deadband of the closed end")
_FROM = replace(_BAND_AT, name="from_here", doc="where half of it is there, as a fraction of the travel")
_EASED = replace(
    WIDTH,
    name="edge",
    upper=0.6,
    starts=(0.06, 0.2),
    doc="over how much of the travel it comes, as a fraction",
)

_MID = _height("extra half deadband at mid travel against the ends, 1.5 times")
_OPEN, _CLOSED = (_height(f"extra half deadband at fully {end}") for end in ("open", "closed"))

#: Points of the travel at which the profile is free: four pieces for each of three waves along the stroke.
KNOTS = tuple(k / 12 for k in range(13))


def _widen(c: Coefficients, shape: FloatArray) -> None:
    c.close_shift += shape
    c.open_shift -= shape


def _spot(c: Coefficients, values: Sequence[float]) -> None:
    _widen(c, values[0] * bump(c.xi, values[1], values[2]))


def _band(c: Coefficients, values: Sequence[float]) -> None:
    height, centre, width = values
    _widen(c, height * (edge(c.xi, centre - 0.5 * width, _EDGE) - edge(c.xi, centre + 0.5 * width, _EDGE)))


def _from_a_place_on(c: Coefficients, values: Sequence[float]) -> None:
    _widen(c, values[0] * edge(c.xi, values[1], values[2]))


def _grip(c: Coefficients, shape: FloatArray) -> None:
    # The packing grips the stem where it is; going by where it is pulled to is right only when it is slow.
    c.bend_at_stem(shape, -shape)


def _stem_spot(c: Coefficients, values: Sequence[float]) -> None:
    _grip(c, values[0] * bump(c.xi, values[1], values[2]))


def _stem_bow(c: Coefficients, values: Sequence[float]) -> None:
    _grip(c, values[0] * detrended(bow(c.xi), c.xi))


def _stem_open_end(c: Coefficients, values: Sequence[float]) -> None:
    _grip(c, values[0] * np.exp(-c.xi / END))


def _stem_closed_end(c: Coefficients, values: Sequence[float]) -> None:
    _grip(c, values[0] * np.exp(-(1.0 - c.xi) / END))


def _closing_spot(c: Coefficients, values: Sequence[float]) -> None:
    c.close_shift += values[0] * bump(c.xi, values[1], values[2])


def _opening_spot(c: Coefficients, values: Sequence[float]) -> None:
    c.open_shift -= values[0] * bump(c.xi, values[1], values[2])


def _bow(c: Coefficients, values: Sequence[float]) -> None:
    _widen(c, values[0] * detrended(bow(c.xi), c.xi))


def _open_end(c: Coefficients, values: Sequence[float]) -> None:
    _widen(c, values[0] * np.exp(-c.xi / END))


def _closed_end(c: Coefficients, values: Sequence[float]) -> None:
    _widen(c, values[0] * np.exp(-(1.0 - c.xi) / END))


def _profile(c: Coefficients, values: Sequence[float]) -> None:
    _widen(c, np.interp(c.xi, KNOTS, values))


def _profile_starts(_records: Sequence[Recording], scales: Scales) -> list[tuple[float, ...]]:
    """Small bumps in turn: from there a smooth response is fitted in any direction."""
    size = 0.01 * scales.pressure
    return [tuple(size if k % 2 == odd else -size for k in range(len(KNOTS))) for odd in (0, 1)]


EFFECT = Effect(
    name="position_dependent_friction",
    stage="actuator",
    claim="The deadband is wider or narrower locally, at some positions.",
    equations="closing p = a1 + w/k + e(w), opening p = a2 + w/k - e(w), e = height * bell((w/travel - centre)/width), "
    "or height within a band of that width, or from a place on, or straight between points of the travel; stem_*: e of "
    "the stem x; "
    "closing_spot, opening_spot: e on one of the two curves",
    source="Armstrong-Helouvry, Control of Machines with Friction (Kluwer 1991)",
    forms=(
        Form("spot", (_height("extra half deadband at the centre"), CENTRE, WIDTH), _spot),
        Form("band", (_IN_BAND, _BAND_AT, _ACROSS), _band),
        Form("from_a_place_on", (_TIGHT_FROM, _FROM, _EASED), _from_a_place_on),
        Form("stem_spot", (_height("extra half deadband at the centre"), CENTRE, WIDTH), _stem_spot),
        Form("closing_spot", (_BURR, CENTRE, WIDTH), _closing_spot),
        Form("opening_spot", (_BURR, CENTRE, WIDTH), _opening_spot),
        Form("bow", (_MID,), _bow),
        Form("open_end", (_OPEN,), _open_end),
        Form("closed_end", (_CLOSED,), _closed_end),
        Form("stem_bow", (_MID,), _stem_bow),
        Form("stem_open_end", (_OPEN,), _stem_open_end),
        Form("stem_closed_end", (_CLOSED,), _stem_closed_end),
        Form("profile", tuple(_knot(at) for at in KNOTS), _profile, _profile_starts, free=True),
    ),
    twins=("stiction", "spring_asymmetry"),
    absorbs=("deadband",),
    hides=("spring_asymmetry",),
)
