"""The items of the gallery by key, in the order of the thesis; each is computed when asked for."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module

from app.gallery.figure import Entry
from hal.errors import BadInput

_FIGURES = {
    "1-2": "characterization",
    "1-5": "characterization",
    "1-6": "characterization",
    "2-3": "diagrams",
    "2-4": "models",
    "2-5": "models",
    "2-6": "diagrams",
    "2-7": "models",
    "2-8": "nyquist",
    "3-1": "diagrams",
    "3-2": "controllers",
    "3-4": "controllers",
    "3-5": "geometry",
    "3-6": "diagrams",
    "3-7": "if_then",
    "3-9": "geometry",
    "3-10": "if_then",
    "3-12": "if_then",
    "beyond": "controllers",
    "brake": "rivals",
    "rivals": "rivals",
}
KEYS = tuple(_FIGURES)


def checked(keys: Sequence[str]) -> tuple[str, ...]:
    """These keys in the order of the page, or all of them for none. Raises: `BadInput` for one that is not there."""
    for key in keys:
        if key not in KEYS:
            raise BadInput(f"the gallery has no item {key!r}; it has {', '.join(KEYS)}")
    return tuple(key for key in KEYS if key in keys or not keys)


def make(key: str) -> Entry:
    """Computes one item."""
    module = import_module(f"app.gallery.{_FIGURES[key]}")
    if _FIGURES[key] == "diagrams":
        found: Entry = next(entry for entry in module.entries() if entry.key == key)
    else:
        found = getattr(module, f"figure_{key.replace('-', '_')}")()
    return found
