"""The effects that a design model file carries, as parts of a plant."""

from __future__ import annotations

import math
from collections.abc import Mapping

from control.design import DesignModel
from hal.errors import BadInput
from twin.model.catalog import effects
from twin.model.effect import Effect, Form
from twin.model.plant import Inserted, Plant


def inserted_from(design: DesignModel) -> tuple[Inserted, ...]:
    """The `[effects.NAME]` tables as effects at work, in the order of the file.

    Raises: `BadInput` naming the key for an unknown effect, form or parameter, a missing parameter, or no number.
    """
    return tuple(_one(name, table) for name, table in design.effects.items())


def plant_of(design: DesignModel) -> Plant:
    """The design model with the effects that its file names. Raises: `BadInput` as `inserted_from`."""
    return Plant(design, inserted_from(design))


def _one(name: str, table: Mapping[str, float | str]) -> Inserted:
    if name not in effects():
        raise BadInput(f"[effects.{name}]: no effect is called {name!r}; there are {', '.join(effects())}")
    form = _form(effects()[name], table)
    return Inserted(name, form, tuple(_value(name, p.name, table[p.name]) for p in form.parameters))


def _form(effect: Effect, table: Mapping[str, float | str]) -> Form:
    """The form that the table names, or the only one with exactly these parameters that comes first."""
    keys = set(table) - {"form"}
    if "form" in table:
        found = next((f for f in effect.forms if f.name == table["form"]), None)
        if found is None:
            known = ", ".join(f.name for f in effect.forms)
            raise BadInput(f"[effects.{effect.name}] form = {table['form']!r}: there is no such form; it has {known}")
        wanted = {p.name for p in found.parameters}
        _same(effect.name, keys, wanted, found.name)
        return found
    for form in effect.forms:
        if {p.name for p in form.parameters} == keys:
            return form
    choices = "; ".join(f"{f.name}: {', '.join(p.name for p in f.parameters) or 'none'}" for f in effect.forms)
    raise BadInput(
        f"[effects.{effect.name}] has the parameters {', '.join(sorted(keys)) or 'none'}, which fit no form; "
        f"the forms and their parameters are {choices}"
    )


def _same(name: str, keys: set[str], wanted: set[str], form: str) -> None:
    for key in sorted(keys - wanted):
        raise BadInput(f"[effects.{name}] {key}: form {form} has no such parameter; it has {', '.join(sorted(wanted))}")
    for key in sorted(wanted - keys):
        raise BadInput(f"[effects.{name}]: {key} is missing; form {form} needs {', '.join(sorted(wanted))}")


def _value(name: str, key: str, value: float | str) -> float:
    if isinstance(value, str) or not math.isfinite(value):
        raise BadInput(f"[effects.{name}] {key} = {value!r} is not a finite number")
    return float(value)
