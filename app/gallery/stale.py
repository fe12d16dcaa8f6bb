"""Whether a stored item of the gallery is what the code says today: its numbers, its words and its picture."""

from __future__ import annotations

import math
import re
from itertools import zip_longest
from pathlib import Path

from app.gallery import page
from app.gallery.figure import Entry, save

NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
# A pixel differs when a colour does by a quarter of its range; a picture when one pixel in 200 does. Another library's
# rounding moves the edge of a line, another result moves the line.
COLOUR, PIXELS = 0.25, 0.005


def differences(folder: Path, entry: Entry) -> list[str]:
    """What is stale about the item stored below `folder`, in words; empty when nothing is.

    Raises: `JobFailed` where there is no page to compare with.
    """
    return [*_numbers(folder, entry), *_words(folder, entry), *_picture(folder, entry)]


def _numbers(folder: Path, entry: Entry) -> list[str]:
    """Numbers that have moved by more than a unit of their last digit shown and 2 %, that are new or gone."""
    old, moved = page.stored_numbers(folder).get(entry.key, {}), []
    for n in entry.numbers:
        was = old.get(n.label, "missing")
        if was is None and not math.isfinite(n.ours):
            continue
        if not isinstance(was, float | int) or abs(was - n.ours) > max(10.0**-n.digits, 0.02 * abs(n.ours)):
            moved.append(f"{n.label}: {was} -> {n.ours:.4g}")
    gone = sorted(set(old) - {n.label for n in entry.numbers})
    return [*moved, *(f"{label}: no longer computed" for label in gone)]


def _words(folder: Path, entry: Entry) -> list[str]:
    """The first line whose words differ, or in which a number has moved by more than a unit of its last digit and 2 %.

    Tables are compared by their numbers above.
    """
    was, now = (_lines(text) for text in (page.sections(folder).get(entry.key, ""), page.section(entry)))
    for old, new in zip_longest(was, now, fillvalue=""):
        close = NUMBER.sub("#", old) == NUMBER.sub("#", new) and all(
            _close(a, b) for a, b in zip(NUMBER.findall(old), NUMBER.findall(new), strict=True)
        )
        if not close:
            return [f"text: {_apart(old, new)!r} -> {_apart(new, old)!r}"]
    return []


def _lines(text: str) -> list[str]:
    return [line for line in text.splitlines() if line and not line.startswith("|")]


def _close(old: str, new: str) -> bool:
    digits = len(new.partition(".")[2])
    return abs(float(old) - float(new)) <= max(1.001 * 10.0**-digits, 0.02 * abs(float(new)))


def _apart(text: str, other: str) -> str:
    """The piece of `text` from where it leaves `other`."""
    same = next(
        (i for i, pair in enumerate(zip(text, other, strict=False)) if pair[0] != pair[1]), min(len(text), len(other))
    )
    return text[max(0, same - 20) : same + 40]


def _picture(folder: Path, entry: Entry) -> list[str]:
    """Whether drawing it now gives another picture."""
    from tempfile import TemporaryDirectory

    import numpy as np
    from matplotlib.image import imread

    stored = folder / "pictures" / entry.picture
    if entry.draw is None:
        return []
    if not stored.is_file():
        return [f"{stored.name}: missing"]
    with TemporaryDirectory() as place:
        save(entry, Path(place))
        was, now = (imread(path)[..., :3] for path in (stored, Path(place) / entry.picture))
    if was.shape != now.shape:
        return [f"{stored.name}: {was.shape[1]} x {was.shape[0]} pixels -> {now.shape[1]} x {now.shape[0]}"]
    share = float(np.mean(np.abs(was - now).max(axis=2) > COLOUR))
    return [f"{stored.name}: {100.0 * share:.1f} % of the picture differ"] if share > PIXELS else []
