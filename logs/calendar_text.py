"""Times of day and dates that come as text, as seconds."""

from __future__ import annotations

import re
from collections.abc import Callable
from datetime import UTC, datetime

_HOUR_MINUTE = r"(?P<hour>\d{1,2}):(?P<minute>\d{2})"
_SECOND = r"(?P<second>\d{2}(?:[.,]\d+)?)"
_NOON = r" ?(?P<noon>[AP])M"
_CLOCK = re.compile(rf"(?P<hour>\d{{1,3}}):(?P<minute>\d{{2}}):{_SECOND}(?:{_NOON})?", re.IGNORECASE)
_ISO = re.compile(r"(?:\d{4}-\d{2}-\d{2}[ T]|\d{8}T)\S+")
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
#: All but ISO: each in one order only, which its writing tells. `optional`: AM and PM may be missing ("?") or not ("").
_DATES = tuple(
    re.compile(rf"{date},? +{_HOUR_MINUTE}(?::{_SECOND})?(?:{_NOON}){optional}(?P<zone>Z|[-+]\S+)?", re.IGNORECASE)
    for date, optional in (
        # Day first, as everywhere that dates have dots.
        (r"(?P<day>\d{1,2})\.(?P<month>\d{1,2})\.(?P<year>\d{4}|\d{2})", "?"),
        (r"(?P<year>\d{4})/(?P<month>\d{1,2})/(?P<day>\d{1,2})", "?"),
        # As historians write: 05-Mar-24.
        (rf"(?P<day>\d{{1,2}})[- ](?P<month>{'|'.join(_MONTHS)})[- ](?P<year>\d{{4}}|\d{{2}})", "?"),
        # Month first: a date with a clock of twelve hours is American. Without AM or PM a slash does not tell.
        (r"(?P<month>\d{1,2})/(?P<day>\d{1,2})/(?P<year>\d{4})", ""),
    )
)
#: 2000-01-01, from which dates are counted [s since 1970].
EPOCH_S = 946_684_800.0
#: What is read, for an operator whose file has something else.
FORMS = (
    "2024-03-05 08:00:00.5, 2024/03/05 08:00:00, 05.03.2024 08:00:00, 05-Mar-24 08:00:00, "
    "03/05/2024 08:00:00 AM (month first), 08:00:00, or seconds"
)


def looks_like_time(text: str) -> bool:
    """Whether a text is probably meant as a date or a time of day, in whatever form."""
    return re.search(r"\d[:/]\d", text) is not None


def parser_of(text: str) -> Callable[[str], float]:
    """How a column with a first cell like `text` is read: times of day, dates (see `FORMS`) or numbers."""
    if _CLOCK.fullmatch(text):
        return clock_seconds
    return date_seconds if any(form.fullmatch(text) for form in (_ISO, *_DATES)) else float


def clock_seconds(text: str) -> float:
    """Seconds since midnight. Raises: `ValueError` for what is no time of day."""
    found = _CLOCK.fullmatch(text)
    if found is None:
        raise ValueError(text)
    return 3600.0 * _hour(found) + 60.0 * float(found["minute"]) + float(found["second"].replace(",", "."))


def date_seconds(text: str) -> float:
    """Seconds since 2000, in UTC where the text names no zone. Raises: `ValueError` for what is no such date."""
    found = next(filter(None, (form.fullmatch(text) for form in _DATES)), None)
    when = datetime.fromisoformat((_iso(found) if found else text).replace(",", "."))
    return (when if when.tzinfo else when.replace(tzinfo=UTC)).timestamp() - EPOCH_S


def _iso(date: re.Match[str]) -> str:
    name, year = date["month"].lower(), int(date["year"])
    month = _MONTHS.index(name) + 1 if name in _MONTHS else int(name)
    clock = f"{_hour(date):02d}:{date['minute']}:{date['second'] or '00'}{date['zone'] or ''}"
    return f"{year if year > 99 else 2000 + year}-{month:02d}-{int(date['day']):02d}T{clock}"


def _hour(clock: re.Match[str]) -> int:
    """The hour of 24: 12 AM is midnight."""
    hour = int(clock["hour"])
    return hour if clock["noon"] is None else hour % 12 + 12 * (clock["noon"].upper() == "P")
