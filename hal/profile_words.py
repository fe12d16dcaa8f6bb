"""What is wrong with a file that pydantic has refused, in our words."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

_HINTS = {
    "extra_forbidden": "unknown key; remove it or correct its spelling",
    "missing": "missing; add it",
    "string_pattern_mismatch": "empty; give it a text",
}
_KINDS = (  # the beginning of the type of an error, and what should have been there
    ("float", "a number"),
    ("int", "a whole number"),
    ("string", "a text in quotes"),
    ("bool", "true or false"),
    ("date", "a date like 2026-11-01"),
    ("tuple", "a list in square brackets"),
    ("list", "a list in square brackets"),
    ("dict", "a table"),
    ("model", "a table"),
)
_BOUNDS = {
    "greater_than_equal": ("ge", "at least"),
    "greater_than": ("gt", "more than"),
    "less_than_equal": ("le", "at most"),
    "less_than": ("lt", "less than"),
}


def not_finite(content: object, place: tuple[str | int, ...] = ()) -> str | None:
    """What to say of the first nan or inf in a file: TOML has them, and no key of a profile can be one."""
    if isinstance(content, float) and not math.isfinite(content):
        return f"{key_of(place)}: {content} given, it must be finite"
    inner: Sequence[tuple[Any, object]] = ()
    if isinstance(content, Mapping):
        inner = tuple(content.items())
    elif isinstance(content, (list, tuple)):
        inner = tuple(enumerate(content))
    return next((said for key, value in inner if (said := not_finite(value, (*place, key)))), None)


def key_of(place: Sequence[str | int]) -> str:
    """The place as an operator finds it: `calibration.points, row 1, value 2`."""
    names = ".".join(str(part) for part in place if isinstance(part, str))
    numbers = [part + 1 for part in place if isinstance(part, int)]
    words = ("value",) if len(numbers) == 1 and not names.endswith("points") else ("row", "value")
    return ", ".join((names, *(f"{word} {number}" for word, number in zip(words, numbers, strict=False))))


def sentence(errors: Sequence[Any]) -> str:
    """The first of pydantic's errors: key, value and what it should be; and how many there are besides."""
    first = errors[0]
    key, more = key_of(first["loc"]), f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
    return f"{key + ': ' if key else ''}{_what(first)}{more}"


def _what(error: Mapping[str, Any]) -> str:
    kind, given, context = str(error["type"]), error["input"], error.get("ctx", {})
    if kind in _HINTS:
        return _HINTS[kind]
    if kind in _BOUNDS:
        limit, words = _BOUNDS[kind]
        return f"{given} must be {words} {context[limit]}"
    if kind in ("too_short", "too_long"):
        least = kind == "too_short"
        wanted = context["min_length" if least else "max_length"]
        return f"{len(given)} given, {f'at least {wanted} are needed' if least else f'at most {wanted} can be'}"
    if kind == "literal_error":
        return f"{given!r} must be {context['expected']}"
    wanted = next((words for start, words in _KINDS if kind.startswith(start)), None)
    if wanted is not None:
        point = isinstance(given, float) and given.is_integer() and kind.startswith("int")
        return f"{_shown(given)} is not {wanted}" + (f"; write {given:.0f}" if point else "")
    return str(error["msg"]).removeprefix("Value error, ")


def _shown(given: object) -> str:
    """A value as TOML writes it."""
    if isinstance(given, (Mapping, list, tuple)):
        return "what is given"
    return str(given).lower() if isinstance(given, bool) else repr(given)
