"""A plane of characters for a terminal or a pipe: two clouds of points over the same axes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray

Cells = npt.NDArray[np.bool_]
Cloud = tuple[FloatArray, FloatArray]
Box = tuple[float, float, float, float]


def plane(
    first: Cloud,
    second: Cloud,
    *,
    columns: int = 64,
    rows: int = 18,
    marks: str = ".o#",
) -> list[str]:
    """Lines of text, top first; `marks` are the signs for the first cloud, the second, and both in one cell.

    Both clouds are (x, y); the axes span both. Raises: ValueError without points.
    """
    x = np.concatenate([first[0], second[0]])
    y = np.concatenate([first[1], second[1]])
    if not x.size:
        raise ValueError("a sketch needs points")
    box = (float(x.min()), float(x.max()), float(y.min()), float(y.max()))
    a, b = (_cells(cloud, box, columns, rows) for cloud in (first, second))
    signs = np.where(a & b, marks[2], np.where(b, marks[1], np.where(a, marks[0], " ")))
    return ["".join(line).rstrip() for line in signs[::-1]]


def _cells(cloud: Cloud, box: Box, columns: int, rows: int) -> Cells:
    cells = np.zeros((rows, columns), dtype=bool)
    column = _index(cloud[0], box[0], box[1], columns)
    row = _index(cloud[1], box[2], box[3], rows)
    cells[row, column] = True
    return cells


def _index(values: FloatArray, low: float, high: float, count: int) -> npt.NDArray[np.int64]:
    share = (values - low) / (high - low) if high > low else np.zeros_like(values)
    return np.clip((share * count).astype(np.int64), 0, count - 1)
