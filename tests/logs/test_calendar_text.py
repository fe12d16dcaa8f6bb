"""Dates and times of day as files write them: one moment in all forms, and what could mean two is refused."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logs.calendar_text import FORMS, clock_seconds, date_seconds, parser_of

EPOCH = datetime(2000, 1, 1, tzinfo=UTC)
WRITTEN = ("%Y-%m-%d %H:%M:%S.%f", "%Y-%m-%dT%H:%M:%S.%fZ", "%Y%m%dT%H%M%S.%f", "%Y/%m/%d %H:%M:%S.%f",
           "%d.%m.%Y %H:%M:%S,%f", "%d.%m.%y %H:%M:%S.%f", "%d-%b-%y %H:%M:%S.%f", "%d %b %Y, %H:%M:%S.%f",
           "%d-%b-%Y %I:%M:%S.%f %p", "%m/%d/%Y %I:%M:%S.%f %p", "%Y/%m/%d %I:%M:%S.%f%p")  # fmt: skip


@given(st.datetimes(datetime(2000, 1, 1), datetime(2099, 12, 31)), st.sampled_from(WRITTEN))
def test_a_moment_is_the_same_however_it_is_written(moment: datetime, form: str) -> None:
    text = moment.strftime(form)
    assert parser_of(text) is date_seconds
    assert date_seconds(text) == pytest.approx((moment.replace(tzinfo=UTC) - EPOCH).total_seconds(), abs=2e-6)


@given(st.times(), st.sampled_from(["%H:%M:%S.%f", "%I:%M:%S.%f %p", "%I:%M:%S,%f%p"]))
def test_so_is_a_time_of_day(moment, form: str) -> None:
    text = moment.strftime(form)
    assert parser_of(text) is clock_seconds
    seconds = 3600.0 * moment.hour + 60.0 * moment.minute + moment.second + 1e-6 * moment.microsecond
    assert clock_seconds(text) == pytest.approx(seconds, abs=1e-6)


def test_minutes_are_enough_and_a_zone_counts() -> None:
    eight = date_seconds("2024-03-05 08:00:00")
    assert (
        date_seconds("05.03.2024 08:00") == date_seconds("5-MAR-24 8:00") == date_seconds("03/05/2024 8:00 AM") == eight
    )
    assert date_seconds("05.03.2024 09:00:00+01:00") == date_seconds("2024/03/05 08:00:00Z") == eight


@pytest.mark.parametrize(
    "text", ["03/05/2024 08:00:00", "05-Foo-24 08:00:00", "5.3.124 08:00:00", "08:00", "05.03.2024"]
)
def test_what_its_writing_does_not_tell_is_no_date(text: str) -> None:
    assert parser_of(text) is float


@pytest.mark.parametrize(
    "text", ["30-Feb-24 08:00:00", "05.13.2024 08:00:00", "2024/03/05 25:00:00", "05.03.2024 08:61"]
)
def test_a_day_or_hour_that_there_is_not_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"must be in|out of range|is out of|Invalid"):
        date_seconds(text)


def test_an_operator_is_told_what_is_read() -> None:
    forms = [form.partition(" (")[0] for form in FORMS.removesuffix(", or seconds").split(", ")]
    assert {parser_of(form) for form in forms} == {date_seconds, clock_seconds}
    assert {date_seconds(form) // 86_400 for form in forms if parser_of(form) is date_seconds} == {8830.0}
