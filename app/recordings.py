"""What the verbs that fit models share: records of one valve opened together, and the design they are held to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

from hal.errors import BadInput, JobFailed

if TYPE_CHECKING:
    from control.design import DesignModel
    from logs.recording import CommandTiming, Recording

#: Where a design is from that nobody gave.
DEFAULTS, FROM_RECORD = "the defaults", "identified from the record"


def load_all(paths: Sequence[Path], mapping: str | None, units: str | None, command_timing: str) -> list[Recording]:
    """All records in house units, read alike. Raises: `BadInput` naming the file, row and value that cannot be used."""
    from logs.load import load_recording

    timing = cast("CommandTiming", command_timing)
    return [load_recording(path, mapping=mapping, units=units, command_timing=timing) for path in paths]


def common_units(recordings: Sequence[Recording]) -> tuple[str, str]:
    """The units of pressure and position that all recordings share. Raises: `BadInput` when they do not."""
    first = recordings[0]
    for other in recordings[1:]:
        if (other.pressure_unit, other.position_unit) != (first.pressure_unit, first.position_unit):
            raise BadInput(
                f"{other.name} has [{other.pressure_unit}, {other.position_unit}], {first.name} "
                f"[{first.pressure_unit}, {first.position_unit}]; give --units so that they agree"
            )
    return first.pressure_unit, first.position_unit


def from_open(
    recordings: Sequence[Recording], golden: Sequence[Recording] = (), another: bool = False
) -> tuple[list[Recording], list[Recording]]:
    """Both without what their positions read where the stem is fully open, if no design is given that says.

    Where the design is the defaults, whose travel is known, less than that travel is not for guessing: a sensor's zero
    may be what has slipped; `another`: it is known to be another valve. Raises: `BadInput` for recordings in different
    units.
    """
    from control.identify_zero import OFF, zeroed

    every = [*recordings, *golden]
    common_units(every)
    known = not golden and not another and _of_the_defaults(every)
    done = zeroed(every, 1.0 if known else OFF)
    return done[: len(recordings)], done[len(recordings) :]


def without_design(
    recordings: Sequence[Recording], golden: Sequence[Recording]
) -> tuple[list[Recording], list[Recording], DesignModel, str]:
    """What `from_open` and `design_for` say where no design is given; a record in psi and in that cannot be of the
    thesis's valve gets its own numbers, as one in other units does.

    Raises: `BadInput` or `JobFailed`, as they do.
    """
    opened, healthy = from_open(recordings, golden)
    model, origin = design_for(None, opened, healthy)
    if origin == DEFAULTS and (own := _of_another(recordings, opened, model)) is not None:
        return own[0], healthy, own[1], own[2]
    return opened, healthy, model, origin


def design_for(
    path: Path | None, recordings: Sequence[Recording], golden: Sequence[Recording] = ()
) -> tuple[DesignModel, str]:
    """The design in the recordings' units, and where it is from: a file, `golden` recordings of the healthy
    machine, the defaults (records that were written in psi and in), or the records.

    It says in which units to speak of it: in those of the file, or else in those that the recordings were written in.

    Raises: `BadInput` or `JobFailed` when it cannot be had, with what to do.
    """
    from logs.spoken import spoken_by

    every = [*recordings, *golden]
    pressure_unit, position_unit = common_units(every)
    if path is not None:
        return design_of_file(path, pressure_unit, position_unit), str(path)
    model, origin = _without_file(recordings, golden, pressure_unit, position_unit)
    return replace(model, spoken=spoken_by(every)), origin


def bench_design(path: Path) -> DesignModel:
    """The design of a file in psi and in, in which benches are commanded; one in percent stays, to be refused.

    Raises: `BadInput` naming the file.
    """
    from control.design import load_design
    from logs.units import PERCENT, plain_name
    from twin.model.model_units import in_units_of

    given = load_design(path)
    if PERCENT in (plain_name(given.pressure_unit), plain_name(given.position_unit)):
        return given
    try:
        return in_units_of(given, "psi", "in")
    except BadInput as error:
        raise BadInput(f"{path}: {error}") from error


def design_of_file(path: Path, pressure_unit: str, position_unit: str) -> DesignModel:
    """The design of a file in these units, spoken of in its own. Raises: `BadInput` naming the file."""
    from control.design import load_design
    from logs.spoken import spoken_in
    from twin.model.model_units import in_units_of

    given = load_design(path)
    try:
        model = in_units_of(given, pressure_unit, position_unit)
        return replace(model, spoken=spoken_in(given.pressure_unit, given.position_unit))
    except BadInput as error:
        raise error if str(error).startswith(str(path)) else BadInput(f"{path}: {error}") from error


def _without_file(
    recordings: Sequence[Recording], golden: Sequence[Recording], pressure_unit: str, position_unit: str
) -> tuple[DesignModel, str]:
    from control.design import DesignModel

    if golden:
        return _identified(golden, pressure_unit, position_unit), "identified from the healthy recordings"
    if _of_the_defaults(recordings):
        return DesignModel(), DEFAULTS
    return _identified(recordings, pressure_unit, position_unit), FROM_RECORD


def _of_another(
    recordings: Sequence[Recording], opened: Sequence[Recording], given: DesignModel
) -> tuple[list[Recording], DesignModel, str] | None:
    """The recordings with their own numbers, if the `given` ones are another valve's; None if they need not be, or if
    they are refused with these, as what is in kPa by mistake."""
    from logs.spoken import spoken_by
    from twin.ready.another import admitted, far_off, is_another, miss

    missed = miss(opened, given)
    if not far_off(missed) or not admitted(opened, given):
        return None
    own, _ = from_open(recordings, another=True)
    try:
        model = _identified(own, given.pressure_unit, given.position_unit)
    except (BadInput, JobFailed):
        return None
    if not is_another(model, miss(own, model), given, missed):
        return None
    origin = f"{FROM_RECORD}, which the thesis's numbers miss by {100.0 * missed:.0f} % of travel"
    return own, replace(model, spoken=spoken_by(own)), origin


def _of_the_defaults(recordings: Sequence[Recording]) -> bool:
    """Whether nothing speaks against the thesis's valve; all are in the same units."""
    units = recordings[0].pressure_unit, recordings[0].position_unit
    return units == ("psi", "in") and not any(_of_another_house(one) for one in recordings)


def _of_another_house(recording: Recording) -> bool:
    """Whether a file speaks of kPa or mm: it is not of the thesis's valve, whose numbers are in psi and in."""
    foreign = cast("tuple[str, ...]", recording.meta.get("foreign", ()))
    return "command" in foreign or "position" in foreign


def _identified(recordings: Sequence[Recording], pressure_unit: str, position_unit: str) -> DesignModel:
    from control.identify import identify
    from twin.ready.tuned import tuned_to

    try:
        return tuned_to(recordings, identify(recordings).design)
    except (BadInput, JobFailed) as error:
        raise type(error)(
            f"without --design the design is identified from the record, and that failed: {error}; give the design "
            f"as --design MODEL.toml (in {pressure_unit} and {position_unit}), or a record that moves over both curves"
        ) from error
