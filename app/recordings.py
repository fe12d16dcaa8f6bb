"""What the verbs that fit models share: records of one valve opened together, and the design they are held to."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, cast

from hal.errors import BadInput, JobFailed

if TYPE_CHECKING:
    from control.design import DesignModel
    from logs.recording import CommandTiming, Recording


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


def design_for(
    path: Path | None, recordings: Sequence[Recording], golden: Sequence[Recording] = ()
) -> tuple[DesignModel, str]:
    """The design in the recordings' units, and where it is from: a file, `golden` recordings of the healthy
    machine, the defaults (records that were written in psi and in), or the records.

    Raises: `BadInput` or `JobFailed` when it cannot be had, with what to do.
    """
    from control.design import DesignModel, load_design
    from twin.model_units import in_units_of

    pressure_unit, position_unit = common_units([*recordings, *golden])
    if path is not None:
        try:
            return in_units_of(load_design(path), pressure_unit, position_unit), str(path)
        except BadInput as error:
            raise error if str(error).startswith(str(path)) else BadInput(f"{path}: {error}") from error
    if golden:
        return _identified(golden, pressure_unit, position_unit), "identified from the healthy recordings"
    if (pressure_unit, position_unit) == ("psi", "in") and not any(_of_another_house(r) for r in recordings):
        return DesignModel(), "the defaults"
    return _identified(recordings, pressure_unit, position_unit), "identified from the record"


def _of_another_house(recording: Recording) -> bool:
    """Whether a file speaks of kPa or mm: it is not of the thesis's valve, whose numbers are in psi and in."""
    foreign = cast("tuple[str, ...]", recording.meta.get("foreign", ()))
    return "command" in foreign or "position" in foreign


def _identified(recordings: Sequence[Recording], pressure_unit: str, position_unit: str) -> DesignModel:
    from control.identify import identify
    from twin.tuned import tuned_to

    try:
        return tuned_to(recordings, identify(recordings).design)
    except (BadInput, JobFailed) as error:
        raise type(error)(
            f"without --design the design is identified from the record, and that failed: {error}; give the design "
            f"as --design MODEL.toml (in {pressure_unit} and {position_unit}), or a record that moves over both curves"
        ) from error
