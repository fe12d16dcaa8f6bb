"""A diagnosis as its reader sees it: the same numbers in the units in which that reader speaks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from logs.recording import FloatArray
from logs.spoken import Spoken
from twin.diagnosis import Bin, Cause, Diagnosis, EffectTest, Estimate
from twin.report.series import Series

#: Keys of free mappings with a `unit` whose numbers are in that unit; the rest there are shares, counts and Hz.
_SIZES = frozenset({"value", "sigma", "amplitude", "between_repeats", "at_rest"})


def answered(diagnosis: Diagnosis, pressure_unit: str, position_unit: str) -> Diagnosis:
    """The diagnosis in the units of its sentences; `pressure_unit`, `position_unit`: those of its numbers.

    Probabilities, shares and percent of travel have no unit, and stay.
    """
    spoken = diagnosis.spoken
    if spoken.is_house:
        return diagnosis
    where = diagnosis.where
    return replace(
        diagnosis,
        causes=tuple(_cause(one, spoken) for one in diagnosis.causes),
        effects_tested=tuple(_test(one, spoken) for one in diagnosis.effects_tested),
        where=replace(
            where,
            position=_bins(where.position, position_unit, spoken),
            pressure=_bins(where.pressure, pressure_unit, spoken),
        ),
        noise=_mapping(diagnosis.noise, spoken),
        residual_signature=_mapping(diagnosis.residual_signature, spoken),
    )


def series_answered(series: Series, spoken: Spoken) -> Series:
    """What is drawn, in the same units."""
    if spoken.is_house:
        return series
    p, x = series.pressure_unit, series.position_unit

    def pressure(values: FloatArray | None) -> FloatArray | None:
        return None if values is None else values * spoken.value(1.0, p)

    factor = spoken.value(1.0, x)
    return replace(
        series,
        command=series.command * spoken.value(1.0, p),
        pressure=pressure(series.pressure),
        pressure_before=pressure(series.pressure_before),
        pressure_after=pressure(series.pressure_after),
        position=series.position * factor,
        before=series.before * factor,
        after=series.after * factor,
        retuned=None if series.retuned is None else series.retuned * factor,
        travel=series.travel * factor,
        pressure_unit=spoken.unit(p),
        position_unit=spoken.unit(x),
    )


def _cause(cause: Cause, spoken: Spoken) -> Cause:
    return replace(cause, parameters={name: _estimate(one, spoken) for name, one in cause.parameters.items()})


def _estimate(one: Estimate, spoken: Spoken) -> Estimate:
    low, high = (spoken.value(end, one.unit) for end in one.ci95)
    return Estimate(spoken.value(one.value, one.unit), (low, high), spoken.unit(one.unit))


def _test(test: EffectTest, spoken: Spoken) -> EffectTest:
    limit = test.detection_limit
    said = None if limit is None else spoken.value(limit, test.unit)
    return replace(test, detection_limit=said, unit=spoken.unit(test.unit))


def _bins(bins: tuple[Bin, ...] | None, unit: str, spoken: Spoken) -> tuple[Bin, ...] | None:
    if bins is None:
        return None
    return tuple(replace(b, low=spoken.value(b.low, unit), high=spoken.value(b.high, unit)) for b in bins)


def _mapping(facts: Mapping[str, object], spoken: Spoken) -> dict[str, object]:
    """The same with every size that stands beside its unit converted, at any depth."""
    unit = facts.get("unit")
    found: dict[str, object] = {}
    for key, value in facts.items():
        if isinstance(value, Mapping):
            found[key] = _mapping(value, spoken)
        elif key == "unit":
            found[key] = spoken.unit(str(value))
        elif isinstance(unit, str) and key in _SIZES and isinstance(value, (int, float)):
            found[key] = spoken.value(value, unit)
        else:
            found[key] = value
    return found
