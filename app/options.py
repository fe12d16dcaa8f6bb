"""Options that several verbs share: which bench, and what is kept of a run. The same words in every verb."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, TypeVar

import click

if TYPE_CHECKING:
    from hal.profile import Profile

F = TypeVar("F", bound=Callable[..., Any])


class BenchWords(TypedDict):
    """What `bench_options` hands to a verb, as `open_bench` and `open_to_look` take it."""

    port: str | None
    profile: str | Profile | None
    physics: str | None
    seed: int
    effects: tuple[str, ...]
    plant: tuple[str, ...]
    real_time: bool


def profile_of(profile: str | Path | Profile | None, physics: str | None = None) -> Profile:
    """The profile that is meant; without a name the pilot positioner has its own. Raises: `BadInput`."""
    from hal.profile import Profile, load_profile

    if isinstance(profile, Profile):
        return profile
    return load_profile(profile or ("positioner" if physics == "positioner" else "virtual"))


def bench_options(command: F) -> F:
    """`--port --profile --physics --seed --effect --plant --real-time`: which bench."""
    options = (
        click.option(
            "--port", metavar="PORT", help="Serial port, tcp:// or rtu+tcp://HOST:PORT.  [default: virtual valve]"
        ),
        click.option("--profile", metavar="FILE|NAME", help="Bench profile.  [default: virtual]"),
        click.option("--physics", metavar="NAME", help="Plant of the virtual valve.  [default: thesis]"),
        click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of all chance."),
        click.option(
            "--effect",
            "effects",
            metavar="NAME=SIZE",
            multiple=True,
            help="Imperfection of the virtual valve, stiction=0.4.",
        ),
        click.option(
            "--plant",
            metavar="NAME=VALUE",
            multiple=True,
            help="Design number of the virtual valve, compliance=0.18; noise=0 for none.",
        ),
        click.option("--real-time", is_flag=True, help="Let the virtual valve live in real time."),
    )
    for option in reversed(options):
        command = option(command)
    return command


def listed(text: str) -> tuple[str, ...]:
    """The words of an option that takes several with commas between."""
    return tuple(word.strip() for word in text.split(",") if word.strip())


def plant_options(effects: Sequence[str] = (), plant: Sequence[str] = ()) -> dict[str, object]:
    """The words of `--effect` and `--plant` as options of the virtual valve. Raises: `BadInput`."""
    from hal.errors import BadInput

    numbers = sizes(plant, "--plant", "compliance=0.18")
    if "effects" in numbers:
        raise BadInput("--plant takes design numbers, for example compliance=0.18; for imperfections there is --effect")
    found = sizes(effects, "--effect", "stiction=0.4")
    return {**numbers, **({"effects": found} if found else {})}


def sizes(words: Sequence[str], option: str, example: str) -> dict[str, float]:
    """`NAME=SIZE` words of an option. Raises: `BadInput` for a word of another form, or a size that is not finite."""
    from hal.errors import BadInput

    found = {}
    for word in words:
        name, equals, size = word.partition("=")
        try:
            found[name.strip()] = float(size)
            if not (name.strip() and equals and math.isfinite(found[name.strip()])):
                raise ValueError
        except ValueError as error:
            raise BadInput(
                f"{option} {word!r} is not of the form NAME=SIZE with a finite size, for example {example}"
            ) from error
    return found


def sealed_option(command: F) -> F:
    """`--sealed SEED`: a virtual valve with something, or nothing, wrong with it, for a blind check."""
    return click.option(
        "--sealed", metavar="SEED", help="A virtual valve with something, or nothing, wrong: drawn, not told."
    )(command)


def record_options(command: F) -> F:
    """`--out --note --operator --live`: what is kept of a run, and who watches."""
    options = (
        click.option("--out", type=click.Path(path_type=Path, file_okay=False), help="Run folder; new or empty."),
        click.option("--note", default="", help="What the record should say about this run."),
        click.option("--operator", default="", help="Who runs it."),
        click.option("--live", is_flag=True, help="Stream to rerun while running."),
    )
    for option in reversed(options):
        command = option(command)
    return command
