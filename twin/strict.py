"""Values as strict JSON: no NaN, no infinity, no digits that would change with the machine."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass

_DIGITS = 6  # significant digits in the file: more would pretend, and would change with the machine


def json_ready(value: object) -> object:
    """`value` as JSON types: tuples and arrays as lists, dataclasses as objects, six significant digits.

    Non-finite numbers are None.

    Raises: TypeError for an object that has no JSON form.
    """
    if value is None or isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, float):
        return float(f"{value:.{_DIGITS}g}") if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): json_ready(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [json_ready(item) for item in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {one.name: json_ready(getattr(value, one.name)) for one in fields(value)}
    as_list = getattr(value, "tolist", None)  # numpy arrays and scalars
    if as_list is not None:
        return json_ready(as_list())
    raise TypeError(f"{type(value).__name__} has no JSON form")
