"""Which kinds of experiment there are, and making one by name: one file in `control/experiments` is one kind."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from typing import Any

from control.experiment import Experiment
from hal.errors import BadInput

FOLDER = Path(__file__).parent / "experiments"
# A percent command runs from 0 to 100 where the pressure defaults run from 4 to 13 psi.
_PSI_LOW, _PSI_HIGH = 4.0, 13.0
_FULL_SCALE = {"psi": (_PSI_LOW, _PSI_HIGH), "percent": (0.0, 100.0)}


def experiment_kinds() -> tuple[str, ...]:
    """Every kind, by the name of its file."""
    return tuple(sorted(path.stem for path in FOLDER.glob("[a-z]*.py")))


def experiment_class(kind: str) -> type[Experiment]:
    """The class that the file `control/experiments/KIND.py` offers as `EXPERIMENT`.

    Raises: `BadInput` with the kinds that exist.
    """
    if kind not in experiment_kinds():
        raise BadInput(f"experiment {kind!r} does not exist; choose one of {', '.join(experiment_kinds())}")
    found = import_module(f"control.experiments.{kind}").EXPERIMENT
    assert isinstance(found, type) and issubclass(found, Experiment)
    return found


def defaults_for(kind: str, unit: str) -> dict[str, Any]:
    """The fields of a kind and their defaults, brought from psi to the scale of `unit`.

    Raises: `BadInput` for a unit that commands do not come in.
    """
    if unit not in _FULL_SCALE:
        raise BadInput(f"experiment {kind}: unit = {unit!r} must be one of {', '.join(_FULL_SCALE)}")
    low, high = _FULL_SCALE[unit]
    scale = (high - low) / (_PSI_HIGH - _PSI_LOW)
    found: dict[str, Any] = {}
    for each in fields(experiment_class(kind)):
        value: Any = each.default
        if unit != "psi" and each.metadata.get("is") == "level":
            value = low + scale * (value - _PSI_LOW)
        elif unit != "psi" and each.metadata.get("is") == "span":
            value = scale * value
        found[each.name] = value
    found["unit"] = unit
    return found


def make_experiment(kind: str, settings: Mapping[str, object] | None = None) -> Experiment:
    """An experiment of a kind; what `settings` leaves out has its default, for `settings["unit"]` or psi.

    Raises: `BadInput` for an unknown kind or field, or a value that cannot be.
    """
    given = dict(settings or {})
    made_of = experiment_class(kind)
    values = defaults_for(kind, str(given.get("unit", "psi")))
    for name, value in given.items():
        if name not in values:
            raise BadInput(f"experiment {kind} has no setting {name!r}; it has {', '.join(values)}")
        default = values[name]
        whole = isinstance(default, int) and not isinstance(default, bool)
        values[name] = int(value) if whole and isinstance(value, float) and value == int(value) else value
    return made_of(**values)


def parse_settings(words: Iterable[str]) -> dict[str, object]:
    """Settings from `key=value` words of a command line, with values as in TOML; bare words are text.

    Raises: `BadInput` for a word without `=`.
    """
    import tomllib

    settings: dict[str, object] = {}
    for word in words:
        key, equals, text = word.partition("=")
        if not (key.strip() and equals and text.strip()):
            raise BadInput(f"setting {word!r} is not of the form key=value")
        try:
            settings[key.strip()] = tomllib.loads(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            settings[key.strip()] = text.strip()
    return settings
