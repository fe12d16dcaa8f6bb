"""An experiment as the text of the file that `lostmotion sweep FILE.toml` runs."""

from __future__ import annotations

import tomlkit

from control.experiment import Experiment
from control.experiment_catalog import defaults_for
from control.experiment_file import from_plain, to_plain

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


def _rounded(value: object) -> object:
    if isinstance(value, float):
        return round(value, _DIGITS)
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return value
