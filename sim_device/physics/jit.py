"""Compiles the inner loops. Everything that is compiled goes through here, typed and lazily imported."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar, cast

F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """A function that compiled code calls. It is compiled into its caller, so it needs no cache of its own."""
    from numba import njit

    return cast(F, njit(error_model="numpy", nogil=True)(function))


def compiled_entry(function: F) -> F:
    """A function that Python calls; the machine code is kept on disk. It runs without the interpreter lock.

    The disk cache looks only at the file of the entry itself, so the entry must close over `source_stamp(...)` of all
    the files that are compiled into it; otherwise an edit there would go unnoticed.
    """
    from numba import njit

    return cast(F, njit(error_model="numpy", nogil=True, cache=True)(function))


def source_stamp(*folders: Path) -> int:
    """A number that changes when any Python file directly in `folders` changes."""
    stamp = 0
    for folder in folders:
        for path in sorted(folder.glob("*.py")):
            stamp = zlib.crc32(path.read_bytes(), stamp)
    return stamp
