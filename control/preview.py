"""What an experiment or a target sequence will do, in a few lines of text, before anything moves."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray

_DOTS = (0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80)


def sketch(values: FloatArray, *, columns: int = 72, rows: int = 8) -> list[str]:
    """A line drawing of `values`, shape (n,), in braille cells: `rows` lines of `columns` characters, top first."""
    width, height = 2 * columns, 4 * rows
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    reach = high - low or 1.0
    edges = np.linspace(0, values.size, width + 1).astype(int)
    cells = np.zeros((rows, columns), dtype=int)
    last = 0
    for x in range(width):
        part = values[edges[x] : max(edges[x] + 1, edges[x + 1])]
        part = part[np.isfinite(part)]
        if not part.size:
            continue
        ends = np.rint((np.array([part.min(), part.max()]) - low) / reach * (height - 1)).astype(int)
        bottom, top = int(ends[0]), int(ends[1])
        if x:  # joins on to the column before, so that a jump is a stroke and not a hole
            bottom, top = min(bottom, max(last, bottom) if last > top else last), max(top, min(last, top), last)
        for y in range(bottom, top + 1):
            from_top = height - 1 - y
            cells[from_top // 4, x // 2] |= _DOTS[x % 2][from_top % 4]
        last = round((float(part[-1]) - low) / reach * (height - 1))
    return ["".join(chr(0x2800 + int(cell)) for cell in line) for line in cells]


def with_scale(values: FloatArray, unit: str, *, columns: int = 72, rows: int = 8) -> list[str]:
    """The sketch with its highest and lowest value at the left."""
    lines = sketch(values, columns=columns, rows=rows)
    labels = {0: f"{float(np.nanmax(values)):.4g} {unit}", rows - 1: f"{float(np.nanmin(values)):.4g} {unit}"}
    room = max(len(label) for label in labels.values())
    return [f"{labels.get(number, ''):>{room}} {line}" for number, line in enumerate(lines)]


def duration_words(duration_s: float) -> str:
    """A time as people say it: '45 s', '18 min 20 s', '2 h 05 min'."""
    whole = round(duration_s)
    if whole < 60:
        return f"{duration_s:.3g} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
