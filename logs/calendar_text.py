"""Times of day and dates that come as text, as seconds."""

from __future__ import annotations

import re
from collections.abc import Callable
from datetime import UTC, datetime

_CLOCK = re.compile(r"(\d{1,3}):(\d{2}):(\d{2}(?:[.,]\d+)?)")
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}[ T]\S+")
_DOTTED = re.compile(r"(\d{1,2})\.(\d{1,2})\.(\d{4}) +(\S+)")  # day first, as everywhere that dates have dots

#: Month first: a date with a clock of twelve hours is American. Without AM or PM a slash does not say which it is.
_SLASHED = re.compile(
    r"(\d{1,2})/(\d{1,2})/(\d{4}),? +(\d{1,2}):(\d{2}(?::\d{2}(?:[.,]\d+)?)?) ?([AP])M", re.IGNORECASE
)
#: What is read, for an operator whose file has something else.
FORMS = "2024-03-05 08:00:00.5, 05.03.2024 08:00:00, 03/05/2024 08:00:00 AM (month first), 08:00:00, or seconds"


def looks_like_time(text: str) -> bool:
    """Whether a text is probably meant as a date or a time of day, in whatever form."""
    return re.search(r"\d[:/]\d", text) is not None


def parser_of(text: str) -> Callable[[str], float]:
    """How a column with a first cell like `text` is read: times of day, dates (see `FORMS`) or numbers."""
    if _CLOCK.fullmatch(text):
        return clock_seconds
    return date_seconds if any(form.fullmatch(text) for form in (_DATE, _DOTTED, _SLASHED)) else float


def clock_seconds(text: str) -> float:
    """Seconds since midnight. Raises: `ValueError` for what is no time of day."""
    found = _CLOCK.fullmatch(text)
    if found is None:
        raise ValueError(text)
    return 3600.0 * float(found[1]) + 60.0 * float(found[2]) + float(found[3].replace(",", "."))


def date_seconds(text: str) -> float:
    """Seconds since 2000, in UTC where the text names no zone. Raises: `ValueError` for what is no such date."""
    dotted = _DOTTED.fullmatch(text)
    if dotted is not None:
        text = f"{dotted[3]}-{int(dotted[2]):02d}-{int(dotted[1]):02d}T{dotted[4]}"
    slashed = _SLASHED.fullmatch(text)
    if slashed is not None:
        hour = int(slashed[4]) % 12 + (12 if slashed[6].upper() == "P" else 0)
        text = f"{slashed[3]}-{int(slashed[1]):02d}-{int(slashed[2]):02d}T{hour:02d}:{slashed[5]}"
    when = datetime.fromisoformat(text.replace(",", "."))
    return (when if when.tzinfo else when.replace(tzinfo=UTC)).timestamp() - 946_684_800.0
