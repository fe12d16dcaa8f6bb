"""An experiment as the text of the file that `lostmotion sweep FILE.toml` runs."""

from __future__ import annotations

import tomllib

import tomlkit

from control.experiment import Experiment
from control.experiment_catalog import defaults_for
from control.experiment_file import from_plain, to_plain
from logs.spoken import Spoken
from logs.units import PERCENT

_DIGITS = 4


def rounded(experiment: Experiment) -> Experiment:
    """The experiment with numbers that a person would write: four digits after the point."""
    plain = {name: _rounded(value) for name, value in to_plain(experiment).items()}
    return from_plain(plain, "proposed experiment")


def toml_text(experiment: Experiment, comment: str) -> str:
    """TOML with the kind and what differs from its defaults; `comment` stands above."""
    document = tomlkit.document()
    for line in comment.splitlines():
        document.add(tomlkit.comment(line))
    document["kind"] = experiment.kind
    defaults = {"unit": "psi", **defaults_for(experiment.kind, experiment.unit)}
    for name, value in to_plain(experiment).items():
        if name == "unit" or (name in defaults and value != defaults[name]):
            document[name] = value
    return tomlkit.dumps(document)


def explained(text: str, spoken: Spoken) -> str:
    """The file with a line on what its commands are in the units of whoever reads it; `sweep` takes psi or percent."""
    experiment = from_plain(tomllib.loads(text), "next.toml")
    if experiment.unit in (spoken.pressure, PERCENT):
        return text
    low, high = experiment.range
    ends = f"{low:.3g} to {high:.3g} {experiment.unit}"
    theirs = " to ".join(f"{spoken.value(end, experiment.unit):.3g}" for end in (low, high))
    return f"# Commands are in {experiment.unit}, as sweep takes them: {ends} are {theirs} {spoken.pressure}.\n{text}"


def _rounded(value: object) -> object:
    if isinstance(value, float):
        return round(value, _DIGITS)
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return value
