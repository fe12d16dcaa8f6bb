"""Writes a diagnosis: diagnosis.json, model.toml, report.html, diagnosis.rrd, and the next experiment if any."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from control.design import DesignModel, save_design
from logs.recording import FloatArray
from twin.diagnose import Outcome
from twin.diagnosis import Diagnosis, write_diagnosis
from twin.files import FILES
from twin.model.model_units import as_spoken
from twin.next.file import explained
from twin.report.answered import answered, series_answered
from twin.report.page import write_report
from twin.report.rrd import write_rrd
from twin.report.series import Series

#: Numbers that make up for something unknown are true nowhere else: one such model missed a further record by five
#: times as much as the design (368005, case 13 of the thirty-fourth plant).
_RETUNED = "Its numbers are re-tuned to these recordings and name no cause; another may be nearer to the design given."

Progress = Callable[[str, float], None]


def write_outcome(outcome: Outcome, folder: Path, progress: Progress) -> None:
    """Writes all files of a diagnosis into `folder`; the verdict first, the pictures after it.

    What an earlier diagnosis left there goes first: no file may speak of another verdict than the one beside it.
    """
    clear(folder)
    write_diagnosis(outcome.diagnosis, folder / "diagnosis.json")
    spoken = outcome.model.spoken
    units = {name: {key: spoken.unit(u) for key, u in table.items()} for name, table in outcome.effect_units.items()}
    save_design(as_spoken(outcome.model), folder / "model.toml", said_of_the_model(outcome.diagnosis), units)
    if outcome.next_file is not None:
        (folder / "next.toml").write_text(explained(outcome.next_file, spoken), encoding="utf-8")
    series = series_answered(series_of(outcome), spoken)
    shown = answered(outcome.diagnosis, outcome.model.pressure_unit, outcome.model.position_unit)
    progress("report", 0.2)
    write_report(shown, series, folder / "report.html")
    progress("report", 0.8)
    write_rrd(shown, series, folder / "diagnosis.rrd")
    progress("report", 1.0)


def said_of_the_model(diagnosis: Diagnosis) -> str:
    """What stands above the numbers of model.toml: the statement, and where no cause is behind them, that."""
    gap = diagnosis.gap
    if diagnosis.verdict != "unexplained" or gap.after is None or gap.before is None or gap.after >= gap.before:
        return diagnosis.statement
    return f"{diagnosis.statement}\n{_RETUNED}"


def write_known(diagnosis: Diagnosis, design: DesignModel, folder: Path) -> None:
    """Writes what an interrupted diagnosis knew, and the design as it was given, and nothing else."""
    clear(folder)
    write_diagnosis(diagnosis, folder / "diagnosis.json")
    save_design(as_spoken(design), folder / "model.toml", diagnosis.statement)


def clear(folder: Path) -> None:
    """Makes `folder`, or removes the files of an earlier diagnosis from it; records and anything else stay."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in FILES:
        (folder / name).unlink(missing_ok=True)


def series_of(outcome: Outcome) -> Series:
    """The arrays that the report draws, all recordings in turn."""
    records = outcome.recordings

    def joined(parts: tuple[FloatArray, ...]) -> FloatArray:
        return np.concatenate(parts)

    pressures = [r.pressure if r.pressure is not None else np.full(r.n, np.nan) for r in records]
    measured = any(r.pressure is not None for r in records)
    modelled = (None, None) if outcome.pressures is None else tuple(joined(parts) for parts in outcome.pressures)
    return Series(
        time_s=joined(tuple(r.time_s for r in records)),
        command=joined(tuple(r.command for r in records)),
        position=joined(tuple(r.position for r in records)),
        before=joined(outcome.before),
        retuned=joined(outcome.retuned),
        after=joined(outcome.after),
        heldout=np.isfinite(outcome.gap.after),
        travel=outcome.model.travel,
        pressure=np.concatenate(pressures) if measured else None,
        pressure_before=modelled[0],
        pressure_after=modelled[1],
        false=np.concatenate([t.false for t in outcome.result.case.trials]),
        record=np.concatenate([np.full(r.n, k, dtype=np.int64) for k, r in enumerate(records)]),
        names=tuple(r.name for r in records),
        pressure_unit=outcome.model.pressure_unit,
        position_unit=outcome.model.position_unit,
    )
