"""All forms of all causes, by name."""

from __future__ import annotations

from bench.stranger.ep_effects import EP_FORMS
from bench.stranger.form import Form
from bench.stranger.outsiders import OUTSIDERS
from bench.stranger.parameters import PARAMETER_FORMS
from bench.stranger.sensor_effects import SENSOR_FORMS
from bench.stranger.spring_effects import SPRING_FORMS
from bench.stranger.stem_effects import STEM_FORMS

EFFECT_FORMS: tuple[Form, ...] = (*EP_FORMS, *STEM_FORMS, *SPRING_FORMS, *SENSOR_FORMS)
ALL_FORMS: tuple[Form, ...] = (*EFFECT_FORMS, *PARAMETER_FORMS, *OUTSIDERS)

#: What one experiment cannot tell apart, as the vocabulary itself says: no case has two of one family.
FAMILIES = (
    frozenset({"nonlinear_spring", "lvdt_nonlinearity", "flow_force"}),
    frozenset({"additional_lag", "sensor_lag"}),
    frozenset({"reduced_travel", "lvdt_calibration"}),
)


def by_cause(forms: tuple[Form, ...]) -> dict[str, list[Form]]:
    """The forms of every cause."""
    found: dict[str, list[Form]] = {}
    for form in forms:
        found.setdefault(form.cause, []).append(form)
    return found


def related(one: str, other: str) -> bool:
    """Whether two causes are of one family."""
    return any(one in family and other in family for family in FAMILIES)
