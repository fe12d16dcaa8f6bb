"""A spread of play widths: inner reversals move the stem gradually (Prandtl-Ishlinskii)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from twin.kernels.elastic import stretches
from twin.kernels.slots import PLAYS
from twin.kernels.valve_slots import V_DAHL, V_DAHL_HALF, V_PRESLIDING, V_RINGS
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter


def _spread(doc: str) -> tuple[Parameter]:
    return (
        Parameter(
            name="spread",
            kind="pressure",
            lower=0.0,
            upper=1.48,
            starts=(0.08, 0.3, 0.9),
            scale=0.4,
            doc=doc,
        ),
    )


_SOFT = Parameter(
    name="soft_share",
    kind="fraction",
    lower=0.0,
    upper=0.7,
    starts=(0.02, 0.1, 0.35),
    scale=0.15,
    doc="share of the elements whose widths spread from none to the full deadband",
)

_PRESLIDING = Parameter(
    name="presliding",
    kind="position",
    lower=0.0,
    upper=0.25,
    starts=(0.003, 0.012, 0.04),
    scale=0.04,
    doc="distance after a reversal over which all of the friction has turned",
)

_DISTANCE = replace(_PRESLIDING, name="distance", doc="distance over which friction turns, but for 1/e of it")

_ELASTIC = Parameter(
    name="elastic",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.15, 0.5),
    scale=0.3,
    doc="share of the friction that rings of the packing bear which yield before they slip",
)

_LONGEST = replace(_PRESLIDING, name="longest", starts=(0.02, 0.1), doc="distance after which the last ring slips")
_LONGEST = replace(_LONGEST, lower=0.001, neutral=0.05, size=False)

_NEARER = Parameter(
    name="nearer",
    kind="fraction",
    lower=0.02,
    upper=0.98,
    starts=(0.15, 0.5),
    scale=0.3,
    doc="distance after which the first ring slips, as a share of the last one's",
    neutral=0.5,
    size=False,
)

_SHARE = Parameter(
    name="share",
    kind="fraction",
    lower=0.02,
    upper=0.98,
    starts=(0.2, 0.6),
    scale=0.3,
    doc="share of the motion that belongs to the narrower play",
    neutral=0.5,
    size=False,
)

_SCATTER = Parameter(
    name="scatter",
    kind="fraction",
    lower=0.0,
    upper=1.5,
    starts=(0.1, 0.4),
    scale=0.3,
    doc="standard deviation of the logarithms of the widths",
)

_QUANTILES = (np.arange(PLAYS) + 0.5) / PLAYS


def _uniform(c: Coefficients, values: Sequence[float]) -> None:
    reach = min(values[0], 0.5 * c.design.deadband)
    _set(c, reach * (2.0 * _QUANTILES - 1.0), np.full(PLAYS, 1.0 / PLAYS))


def _exponential(c: Coefficients, values: Sequence[float]) -> None:
    tail = -np.log1p(-_QUANTILES)
    reach = min(values[0], 0.5 * c.design.deadband)
    _set(c, reach * (tail / tail.mean() - 1.0), np.full(PLAYS, 1.0 / PLAYS))


def _lognormal(c: Coefficients, values: Sequence[float]) -> None:
    widths = np.exp(values[0] * ndtri(_QUANTILES))
    _set(c, 0.5 * c.design.deadband * (widths / widths.mean() - 1.0), np.full(PLAYS, 1.0 / PLAYS))


def _partly_soft(c: Coefficients, values: Sequence[float]) -> None:
    half = 0.5 * c.design.deadband
    soft = np.append(values[0] / (PLAYS - 1) * np.ones(PLAYS - 1), 1.0 - values[0])
    narrow = -half * (np.arange(PLAYS - 1) + 0.5) / (PLAYS - 1)
    wide = 0.5 * half * values[0] / (1.0 - values[0])
    _set(c, np.append(narrow, wide), soft)


def _two(c: Coefficients, values: Sequence[float]) -> None:
    share, apart = values
    narrow = -min(apart, 0.5 * c.design.deadband) * (1.0 - share)
    _set(c, np.array([narrow, -narrow * share / (1.0 - share)]), np.array([share, 1.0 - share]))


def _turns(c: Coefficients, values: Sequence[float]) -> None:
    """Springs that slip one after the other: in the force balance as such, before it as the plays that they make."""
    if values[0] <= 0.0:
        return
    c.valve[V_PRESLIDING] += values[0]
    slips = stretches(c.valve[V_PRESLIDING])
    _springs(c, slips, np.full(slips.size, 1.0 / slips.size))


def _two_rings(c: Coefficients, values: Sequence[float]) -> None:
    elastic, longest, nearer = values
    if elastic > 0.0:
        _springs(c, longest * np.array([nearer, 1.0]), np.full(2, 0.5 * elastic))


def _rings(c: Coefficients, values: Sequence[float]) -> None:
    elastic, longest = values
    if elastic > 0.0:
        count = PLAYS - 1
        _springs(c, longest * (np.arange(count) + 1.0) / count, np.full(count, elastic / count))


def _springs(c: Coefficients, slips: np.ndarray, shares: np.ndarray) -> None:
    """The plays that springs make which bear these shares of the friction and slip when stretched so far (sorted).

    What they do not bear turns at once.
    """
    c.valve[V_RINGS] = 1.0
    compliance, deadband = c.design.compliance, c.design.deadband
    rigid = deadband * (1.0 - float(shares.sum()))
    borne = (np.minimum(slips[:, None] / slips, 1.0) * shares).sum(axis=1)
    turned = rigid + 2.0 * slips / compliance + deadband * borne
    still = np.append(np.cumsum((shares / slips)[::-1])[::-1], 0.0)
    gives = 1.0 / (1.0 + 0.5 * compliance * deadband * still)
    _set(c, 0.5 * (np.append(rigid, turned) - deadband), np.diff(gives, prepend=0.0))


def _dahl(c: Coefficients, values: Sequence[float]) -> None:
    """As it is before the force balance; in it, where there is more, as the plays that turn like it after a stroke."""
    if values[0] <= 0.0:
        return
    compliance, deadband = c.design.compliance, c.design.deadband
    c.valve[V_DAHL], c.valve[V_DAHL_HALF] = values[0], 0.5 * deadband
    share = np.arange(PLAYS) / PLAYS
    back = -values[0] * np.log1p(-share)
    turned = back / compliance + deadband * share
    gives = np.append(np.diff(back) / np.diff(turned) / compliance, 1.0)
    _set(c, 0.5 * (turned - deadband), np.diff(gives, prepend=0.0))


def _set(c: Coefficients, spreads: np.ndarray, weights: np.ndarray) -> None:
    """Spreads about the design's half deadband, weights that sum to 1; the mean width does not change."""
    c.spreads = np.ascontiguousarray(spreads, dtype=np.float64)
    c.weights = np.ascontiguousarray(weights, dtype=np.float64)


EFFECT = Effect(
    name="distributed_hysteresis",
    stage="actuator",
    claim="The hysteresis is a spread of play widths: inner reversals move the stem gradually.",
    equations="w = sum of g_j play(p; half deadband + s_j), sum of g_j = 1, sum of g_j s_j = 0; turns_over_a_distance: "
    "friction is the half deadband times the mean of z_j / q_j, springs z_j that x stretches and that slip at "
    "q_j = presliding ((j + 1/2) / 8)^2; as plays, where the friction is not in the force balance; rings, two_rings: "
    "springs that bear a share of it alike and slip after distances that are spaced evenly, always as plays, whose sum "
    "a stop holds; "
    "dahl: p = offset + w/k + half deadband * F, dF/dw = (1 - F sgn(dw)) / distance; "
    "lognormal: half widths in proportion to exp(scatter z), z normal",
    source="Kuhnen, Eur. J. Control 9 (2003) 407; Brokate, Sprekels, Hysteresis and Phase Transitions (Springer 1996); "
    "Iwan, J. Appl. Mech. 33 (1966) 893; Al-Bender, Lampaert, Swevers, IEEE Trans. Autom. Control 50 (2005) 1883; "
    "Dahl, The Aerospace Corporation, TOR-0158(3107-18)-1 (1968)",
    forms=(
        Form("uniform", _spread("half widths spread evenly by this much about the design's"), _uniform),
        Form("partly_soft", (_SOFT,), _partly_soft),
        Form("turns_over_a_distance", (_PRESLIDING,), _turns),
        Form("rings", (_ELASTIC, _LONGEST), _rings),
        Form("two_rings", (_ELASTIC, _LONGEST, _NEARER), _two_rings),
        Form("dahl", (_DISTANCE,), _dahl),
        Form("two_plays", (_SHARE, *_spread("by how much the half widths of the two plays differ")), _two),
        Form("lognormal", (_SCATTER,), _lognormal),
        Form("exponential", _spread("mean excess of exponentially distributed half widths"), _exponential),
    ),
    twins=("stiction", "creep"),
    absorbs=("deadband",),
)
