"""Experiments as TOML: `kind`, and then whatever differs from the defaults. Format: docs/experiments.md."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path

from control.experiment import Experiment
from control.experiment_catalog import experiment_kinds, make_experiment
from hal.errors import BadInput
from hal.toml_file import read_toml


def to_plain(experiment: Experiment) -> dict[str, object]:
    """All fields and the kind as plain values, for a record's start document or a TOML file."""
    plain: dict[str, object] = {"kind": experiment.kind}
    for each in fields(experiment):
        value = getattr(experiment, each.name)
        plain[each.name] = [list(row) for row in value] if isinstance(value, tuple) else value
    return plain


def from_plain(content: Mapping[str, object], origin: str) -> Experiment:
    """The experiment that `to_plain` has described; `origin` names it in errors.

    Raises: `BadInput`.
    """
    kind = content.get("kind")
    if not isinstance(kind, str):
        raise BadInput(f"{origin}: key 'kind' is missing; write kind = one of {', '.join(experiment_kinds())}")
    try:
        return make_experiment(kind, {key: value for key, value in content.items() if key != "kind"})
    except BadInput as error:
        raise BadInput(f"{origin}: {error}") from error


def load_experiment(path: Path) -> Experiment:
    """Reads an experiment file.

    Raises: `BadInput` naming the file, the key, its value and its limit.
    """
    try:
        content = read_toml(path)
    except OSError as error:
        raise BadInput(f"{path}: the experiment cannot be read ({error.strerror}); check the path") from error
    except tomllib.TOMLDecodeError as error:
        raise BadInput(f"{path}: not a TOML file ({error}); see docs/experiments.md for the format") from error
    return from_plain(content, str(path))


def save_experiment(experiment: Experiment, path: Path, comment: str = "") -> None:
    """Writes an experiment file with every field, each with what it means."""
    import tomlkit

    document = tomlkit.document()
    for line in comment.splitlines():
        document.add(tomlkit.comment(line))
    document["kind"] = experiment.kind
    meanings = {each.name: str(each.metadata.get("doc", "")) for each in fields(experiment)}
    for name, value in to_plain(experiment).items():
        if name == "kind":
            continue
        document[name] = value
        if meanings[name]:
            document[name].comment(meanings[name])
    path.write_text(tomlkit.dumps(document), encoding="utf-8")
