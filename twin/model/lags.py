"""The number of a lag: the stem and the sensor have the same one."""

from __future__ import annotations

from twin.model.effect import Parameter


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


#: Damping ratio of what is of second order: a mass on its spring, or a filter of two poles.
DAMPING = Parameter(
    name="damping",
    kind="fraction",
    lower=0.2,
    upper=0.98,
    starts=(0.7,),
    scale=0.3,
    doc="damping ratio",
    neutral=0.7,
    size=False,
)


def natural_s(lag_s: float, damping: float) -> float:
    """1 / natural frequency [s] of what is of second order and in the mean so late."""
    return 0.5 * lag_s / damping
