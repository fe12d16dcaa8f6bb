"""The number of a lag: the stem and the sensor have the same one."""

from __future__ import annotations

from twin.effect import Parameter


def lag_parameter(doc: str, usual: tuple[float, float]) -> tuple[Parameter]:
    """A time constant [s]; `usual`: see `Parameter`."""
    return (
        Parameter(
            name="lag",
            kind="time",
            lower=0.0,
            upper=8.0,
            starts=(0.06, 0.25, 0.9, 3.0),
            scale=0.5,
            doc=doc,
            usual=usual,
        ),
    )
