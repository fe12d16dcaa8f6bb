"""Compiles a function of the plant with numba, and keeps its type for the type checker."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

_Function = TypeVar("_Function", bound=Callable[..., Any])

STEP_S = 0.001  # all stages advance together in this step [s]; the polling jitter is a whole number of them


def compiled(function: _Function) -> _Function:
    """`function`, compiled at its first call and cached beside its source."""
    return cast(_Function, njit(cache=True)(function))
