"""How usual the sizes and forms are that a hypothesis claims, by what is known of other machines."""

from __future__ import annotations

import numpy as np

from twin.fit.fitting import Fit


def log_usual(fit: Fit, name: str | None = None) -> float:
    """How usual the sizes and forms are, as a log-density over the logarithm of the size; 0 where nothing is known.

    Of all causes of a hypothesis together, or of the one called `name`.
    """
    total, values, at = 0.0, fit.values(), len(fit.space.numbers)
    for cause in fit.space.causes:
        parameters = cause.form.parameters if cause.form is not None else ()
        if cause.form is not None and name in (None, cause.name):
            total += float(np.log(cause.form.share))
        for k, parameter in enumerate(parameters):
            if parameter.usual is not None and name in (None, cause.name):
                median, factor = parameter.usual
                size = abs(values[at + k]) / (median * fit.space.scales.factor(parameter.kind))
                width = np.log(factor)
                total -= float(0.5 * (np.log(max(size, 1e-9)) / width) ** 2 + np.log(width))
        at += len(parameters)
    return total
