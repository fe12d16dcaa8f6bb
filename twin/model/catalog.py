"""Finds the effects: every file of `twin/effects` that defines `EFFECT`. Adding one touches nothing else."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pathlib import Path

from hal.errors import BadInput
from twin.model.effect import Effect

_FOLDER = Path(__file__).parents[1] / "effects"


@cache
def effects() -> dict[str, Effect]:
    """All effects by name, in alphabetical order; a file that defines none is a defect and raises."""
    found: dict[str, Effect] = {}
    for path in sorted(_FOLDER.glob("[a-z]*.py")):
        effect = getattr(import_module(f"twin.effects.{path.stem}"), "EFFECT", None)
        if not isinstance(effect, Effect) or effect.name != path.stem:
            raise TypeError(f"{path.name} must define EFFECT, an Effect called {path.stem!r}")
        found[effect.name] = effect
    return found


def effect(name: str) -> Effect:
    """The effect called `name`. Raises: `BadInput` naming the effects there are."""
    try:
        return effects()[name]
    except KeyError:
        raise BadInput(f"no effect is called {name!r}; there are {', '.join(effects())}") from None
