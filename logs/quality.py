"""What is wrong with the values of a signal, said in notes; missing values are NaN, a missing command is held."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from hal.sample import Quality
from logs.recording import DataNote, FloatArray

Rows = np.ndarray[tuple[int], np.dtype[np.intp]]
CLIP_RUN = 5  # so many equal readings in a row at the end of the range, in a signal that is noisy elsewhere
CLIP_SHARE = 0.005
FLAT_SHARE = 0.5  # a signal that repeats its value more often than this says nothing by repeating it


def finite(name: str, values: FloatArray, rows: Rows) -> tuple[FloatArray, list[DataNote]]:
    """Makes infinities NaN, and says how many samples are missing. `rows` are the file's rows, from 0."""
    bad = ~np.isfinite(values)
    if not bad.any():
        return values, []
    infinite = int(np.isinf(values).sum())
    what = f"{name}: missing values" + (f", {infinite} of them infinite" if infinite else "")
    note = DataNote(what, "kept as missing", int(bad.sum()), int(rows[int(np.argmax(bad))]) + 1)
    return np.where(bad, np.nan, values), [note]


def held(name: str, values: FloatArray, rows: Rows) -> tuple[FloatArray, list[DataNote]]:
    """Fills missing commands with the last one known: a register holds its value until it is written again."""
    bad = ~np.isfinite(values)
    if not bad.any():
        return values, []
    last = np.maximum.accumulate(np.where(bad, 0, np.arange(values.size)))
    filled = values[last]
    filled[~np.isfinite(filled)] = values[int(np.argmax(~bad))]  # before the first one that is known
    note = DataNote(
        f"{name}: missing values", "the last command is held", int(bad.sum()), int(rows[int(np.argmax(bad))]) + 1
    )
    return filled, [note]


def constant(values: FloatArray) -> bool:
    """Whether a signal never changes; so is one that is missing altogether."""
    good = values[np.isfinite(values)]
    return good.size == 0 or bool(np.all(good == good[0]))


def clipped(name: str, values: FloatArray, rows: Rows, raw: Callable[[float], float] = float) -> list[DataNote]:
    """Says where a signal that is noisy elsewhere sits flat at the end of its range: a converter at its limit.

    `raw` is what a value is in the file, under whose header it is told.
    """
    good = np.isfinite(values)
    if good.sum() < 4 * CLIP_RUN or constant(values):
        return []
    inside = values[good]
    notes = []
    for end, word in ((inside.min(), "lowest"), (inside.max(), "highest")):
        at_end = values == end
        others = values[good & ~at_end]
        noisy = others.size > CLIP_RUN and np.mean(np.diff(others) == 0) < FLAT_SHARE
        if noisy and at_end.sum() >= CLIP_SHARE * values.size and _longest(at_end) >= CLIP_RUN:
            first = int(rows[int(np.argmax(at_end))]) + 1
            what = f"{name}: flat at its {word} value {raw(end):.6g}, clipped or at an end stop"
            notes.append(DataNote(what, "kept as it is", int(at_end.sum()), first))
    return notes


def flags(name: str, values: FloatArray, rows: Rows) -> list[DataNote]:
    """What the bench itself said about its readings while it took them (`hal.sample.Quality`)."""
    codes = np.where(np.isfinite(values), values, 0.0).astype(np.int64)
    notes = []
    for flag in Quality:
        hit = (codes & int(flag)) != 0
        if flag and hit.any():
            word = (flag.name or str(int(flag))).lower()
            first = int(rows[int(np.argmax(hit))]) + 1
            notes.append(
                DataNote(f"{name}: readings flagged {word} by the bench", "kept as it is", int(hit.sum()), first)
            )
    return notes


def _longest(mask: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> int:
    """Length of the longest run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(np.int8)))
    return int((edges[1::2] - edges[::2]).max()) if edges.size else 0
