"""Laws of time that begin anew with each recording, though the clocks of the recordings go on."""

from __future__ import annotations

from collections.abc import Sequence

from twin.model.coefficients import Coefficients
from twin.model.effect import Apply


def anew(law: Apply) -> Apply:
    """The law as if each recording were the first."""

    def applied(c: Coefficients, values: Sequence[float]) -> None:
        place = c.place
        c.place = place.anew() if place is not None else None
        law(c, values)
        c.place = place

    return applied
