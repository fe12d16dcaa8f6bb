"""An end stop is not where the design says."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.kernels.valve_slots import V_HARD_HIGH, V_HARD_LOW, V_HIGH, V_LOW
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter, Scales

_ANYWHERE = (-0.01, 0.005, 0.04, 0.15, 0.35)
_TRAVEL_IN = DesignModel().travel  # of the valve that scales refer to
#: Of all readings, those beyond which noise and false ones are.
_BEYOND = 0.002


def _reached(records: Sequence[Recording], scales: Scales, closed: bool) -> list[tuple[float, ...]]:
    """Just within the furthest that was read, and anywhere.

    A stop beyond that does nothing, and for one far within it all else bends to make up.
    """
    read = np.concatenate([r.position[np.isfinite(r.position)] for r in records])
    share = np.quantile(read, 1.0 - _BEYOND if closed else _BEYOND) / (_TRAVEL_IN * scales.position)
    furthest = 1.0 - share if closed else share
    near = [furthest + more for more in (0.002, 0.01) if -0.2 < furthest + more < 0.8]
    return [*((value,) for value in near), *((value,) for value in _ANYWHERE)]


def _closed(records: Sequence[Recording], scales: Scales) -> list[tuple[float, ...]]:
    return _reached(records, scales, closed=True)


def _open(records: Sequence[Recording], scales: Scales) -> list[tuple[float, ...]]:
    return _reached(records, scales, closed=False)


def _both(records: Sequence[Recording], scales: Scales) -> list[tuple[float, ...]]:
    """Both stops just within the furthest that was read, or one of them nearly where it should be."""
    low, high = _open(records, scales)[0], _closed(records, scales)[0]
    return [(*low, *high), (0.005, *high), (*low, 0.005)]


def _missing(doc: str, name: str = "missing") -> tuple[Parameter]:
    return (
        Parameter(
            name=name,
            kind="fraction",
            lower=-0.2,
            upper=0.8,
            starts=_ANYWHERE,
            scale=0.1,
            doc=doc,
        ),
    )


def _upper(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[[V_HIGH, V_HARD_HIGH]] -= values[0] * c.design.travel


def _lower(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[[V_LOW, V_HARD_LOW]] += values[0] * c.design.travel


def _upper_hit(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_HARD_HIGH] = (1.0 - values[0]) * c.design.travel
    c.valve[V_HIGH] += max(-values[0], 0.0) * c.design.travel  # added, as what presses beyond the stop is


def _lower_hit(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_HARD_LOW] = values[0] * c.design.travel
    c.valve[V_LOW] -= max(-values[0], 0.0) * c.design.travel


def _both_stops(c: Coefficients, values: Sequence[float]) -> None:
    _lower(c, values[:1])
    _upper(c, values[1:])


def _both_hit(c: Coefficients, values: Sequence[float]) -> None:
    _lower_hit(c, values[:1])
    _upper_hit(c, values[1:])


_ENDS = (
    *_missing("fraction of travel missing at the open end", "missing_open"),
    *_missing("fraction of travel missing at the closed end", "missing_closed"),
)


def _seat(doc: str) -> tuple[Parameter, Parameter]:
    begins = Parameter(name="missing", kind="fraction", lower=0.0, upper=0.2, starts=(0.03, 0.12), scale=0.1, doc=doc)
    gives = Parameter(
        name="give",
        kind="fraction",
        lower=0.02,
        upper=0.95,
        starts=(0.1, 0.4),
        scale=0.3,
        doc="compliance against the seat, as a share of the design's",
        neutral=0.3,
        size=False,
    )
    return begins, gives


def _against(c: Coefficients, depth: FloatArray, give: float) -> None:
    """What a seat takes that is pressed in by `depth` (fraction of travel, shape (GRID,)), on both curves."""
    span = c.design.travel / c.design.compliance
    shift = depth * span * (1.0 / give - 1.0)
    c.close_shift += shift
    c.open_shift += shift


def _upper_seat(c: Coefficients, values: Sequence[float]) -> None:
    _against(c, np.maximum(c.xi - (1.0 - values[0]), 0.0), values[1])


def _lower_seat(c: Coefficients, values: Sequence[float]) -> None:
    _against(c, np.minimum(c.xi - values[0], 0.0), values[1])


EFFECT = Effect(
    name="reduced_travel",
    stage="actuator",
    claim="An end stop is not where the design says.",
    equations="x and w held in 0..(1 - missing) travel (upper), missing travel..travel (lower), or both; "
    "hit: only x is held, so the stem meets the stop at speed; "
    "seat: the compliance beyond where the stop begins is give times the design's",
    source="Bartys, Patton, Syfert, de las Heras, Quevedo, Control Eng. Practice 14 (2006) 577 (DAMADICS valve faults)",
    forms=(
        Form("upper_stop", _missing("fraction of travel missing at the closed end"), _upper, _closed),
        Form("lower_stop", _missing("fraction of travel missing at the open end"), _lower, _open),
        Form("upper_stop_hit", _missing("fraction of travel missing at the closed end"), _upper_hit, _closed),
        Form("lower_stop_hit", _missing("fraction of travel missing at the open end"), _lower_hit, _open),
        Form("both_stops", _ENDS, _both_stops, _both),
        Form("both_stops_hit", _ENDS, _both_hit, _both),
        Form("upper_seat", _seat("fraction of travel within which the closed end's seat is pressed in"), _upper_seat),
        Form("lower_seat", _seat("fraction of travel within which the open end's seat is pressed in"), _lower_seat),
    ),
    twins=("lvdt_calibration",),
)
