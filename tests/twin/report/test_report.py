"""The report: self-contained, complete, the same twice, and whole for every kind of verdict."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from tests.twin.report_example import diagnosis, series
from twin.diagnosis import Bin, Cause, Diagnosis, Gap, Ranked, Share
from twin.report.content import cause_rows, columns, gap_marks, ranking_rows, share_bars, top_share
from twin.report.page import render, write_report
from twin.report.series import Series, busiest_pressure, busiest_window, thin, thin_together
from twin.report.statement import statement
from twin.report.story import story
from twin.report.words import VERDICTS

VOID = {"meta", "link", "img", "br", "hr", "input"}


class Balance(HTMLParser):
    """Opening and closing tags in step."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def shown() -> Series:
    return series(60)


@pytest.fixture(scope="module")
def page(shown: Series) -> str:
    return render(diagnosis(shown), shown)


@pytest.fixture
def words_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages without figures, as with few rows, for tests of what a page says: drawing takes seconds."""
    monkeypatch.setattr("twin.report.page._figures", lambda diagnosis, series: {})


def test_page_is_whole_and_refers_to_nothing_outside(page: str) -> None:
    balance = Balance()
    balance.feed(page)
    assert balance.open == []
    links = set(re.findall(r"""(?:https?:)?//[^\s"'<)]+""", page))
    assert links <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
    assert not re.search(r"<(script|link|img|iframe)\b|@import|url\((?!#)", page)
    assert len(page) < 1_500_000


def test_page_says_everything(page: str) -> None:
    for words in (
        "The stem sticks: it needs 0.35 psi more",
        "actuator or sensor",
        "0.330 to 0.370",
        "Karnopp",
        "this data cannot tell apart: stiction, distributed hysteresis",
        "lostmotion sweep next.toml",
        "the command never came near the supply pressure",
        "duplicate time in run 0041",
        "run 0042 ramp",
        "second position signal",
        "pressure above the sliding curve that is needed to start",
        "0.000800 in RMS, from repeated commands; one in 1.0 readings is independent",
    ):
        assert words in page
    assert page.count("<svg") == 4
    assert "nan" not in re.sub(r"<style>.*?</style>", "", page, flags=re.S).lower().replace("nanos", "")


@pytest.mark.thorough
@pytest.mark.parametrize(("stage", "pictures"), [("ep", 5), ("sensor", 4)])
def test_a_cause_in_the_converter_shows_in_a_picture_of_the_pressure(shown: Series, stage: str, pictures: int) -> None:
    assert shown.pressure is not None
    late = replace(shown, pressure_before=shown.pressure + 1.0, pressure_after=shown.pressure)
    cause = Cause("dead_time" if stage == "ep" else "sensor_lag", stage, 0.9, 3.4, {})  # type: ignore[arg-type]
    known = replace(diagnosis(shown), causes=(cause,))
    assert render(known, late).count("<svg") == pictures
    assert render(known, shown).count("<svg") == 4  # nothing to draw it from
    unclear = replace(known, verdict="unexplained", causes=(), residual_signature={"signal": "pressure"})
    assert "misses the pressure most" in render(unclear, late)


def test_the_stretch_with_the_worst_pressure(shown: Series) -> None:
    assert shown.pressure is not None and shown.record is not None
    n = shown.pressure.size
    off = np.where((np.arange(n) > n - 300) & (np.arange(n) < n - 200), 2.0, 0.0)
    late = replace(shown, pressure_before=shown.pressure + off, pressure_after=shown.pressure)
    window = busiest_pressure(late, 400)
    assert window.start <= n - 300 and window.stop >= n - 200


def test_same_input_same_bytes(shown: Series, page: str, tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    write_report(diagnosis(shown), shown, path)
    there = page.replace("lostmotion sweep next.toml", f"lostmotion sweep {tmp_path / 'next.toml'}")
    assert there != page  # what it says to run can be run from anywhere
    assert path.read_text(encoding="utf-8") == there


def test_limits_are_right_for_effects_that_are_worse_when_smaller_and_the_records_are_not_claimed(page: str) -> None:
    assert "the mildest case that would have been found here" in page
    assert "smallest size" not in page
    assert "every number of this page" not in page


def test_a_page_of_an_unfinished_diagnosis_is_not_headed_by_a_verdict(shown: Series, words_only: None) -> None:
    unfinished = replace(
        diagnosis(shown), verdict="unexplained", incomplete="interrupted at position: one cause (40 %)"
    )
    for text in (render(unfinished, shown), story(unfinished)):
        assert "No whole answer: interrupted at position: one cause (40 %)" in text
        assert VERDICTS["unexplained"] not in text


def test_no_gap_page_on_few_bare_rows() -> None:
    bare = Diagnosis("no_gap", "No gap <b>larger</b> than 0.1 %.", (), (), Gap(0.15, 0.15, 0.15, 0.14, None))
    n = 40
    zeros = np.zeros(n)
    small = Series(np.arange(n) * 1.0, zeros, zeros, zeros, zeros, np.zeros(n, dtype=bool), 0.5625)
    page = render(bare, small)
    assert "No gap &lt;b&gt;larger&lt;/b&gt;" in page
    assert "nothing to close" in page
    assert "there is nothing to locate" in page
    assert "No cause is needed" in page


@pytest.mark.thorough
def test_unexplained_without_pressure_and_with_missing_values(shown: Series) -> None:
    position = shown.position.copy()
    position[100:140] = np.nan
    blind = replace(shown, position=position, pressure=None, retuned=None, false=np.arange(position.size) % 97 == 0)
    known = diagnosis(shown)
    where = replace(known.where, stage=None, attributed=None)
    signature = {"signal": "position", "rms_over_noise": 2.5, "depends_on": {"time": 0.1}}
    unclear = replace(known, verdict="unexplained", causes=(), where=where, residual_signature=signature)
    page = render(unclear, blind)
    assert "without measured pressure the stages cannot be told apart" in page
    assert "the position, 2.50 times its noise" in page
    assert "command [psi]" in page
    measured = render(unclear, replace(blind, pressure=shown.pressure))
    assert "without measured pressure the stages" not in measured
    assert "No error above the floor to share out" in measured


def test_bars_show_masking_and_columns_their_scale() -> None:
    bars = share_bars({"ep": Share(-0.5, (-0.6, -0.4)), "actuator_or_sensor": Share(1.5, (1.4, 1.6))})
    assert [bar.tone for bar in bars] == ["minus", "plus"]
    assert "masks" in bars[0].detail
    assert bars[0].left + bars[0].width == pytest.approx(bars[0].zero)
    assert max(bar.high for bar in bars) == pytest.approx(100.0)
    assert share_bars(None) == []
    shown = columns((Bin(0.0, 0.5, Share(0.4, (0.3, 0.5))), Bin(0.5, 1.0, Share(0.6, (0.5, 0.8)))), 0.8, 100.0)
    assert shown[1].label == "50"
    assert shown[1].height == pytest.approx(75.0)
    assert columns((Bin(-0.0014, 2.7, Share(1.0, (0.9, 1.0))),), 1.0)[0].label == "0"
    assert columns((Bin(0.002, 0.004, Share(1.0, (0.9, 1.0))),), 1.0)[0].label == "0.0020"
    assert columns(None, 1.0) == []
    marks = gap_marks(Gap(4.0, 3.0, 0.2, 0.1, None))
    assert [mark.place for mark in marks] == sorted(mark.place for mark in marks)


def test_all_columns_share_one_scale_that_is_printed(page: str) -> None:
    low, high = (Bin(0.0, 1.0, Share(v, (v, v + 0.05))) for v in (0.1, 0.62))
    assert top_share(((low,), None, (high,))) == pytest.approx(0.7)
    assert columns((low,), 0.7)[0].height == pytest.approx(100.0 / 7.0)
    printed = re.findall(r'class="top">([^<]*)</span>', page)
    assert len(printed) == 4
    assert len(set(printed)) == 1


def test_a_verdict_without_a_gap_gives_no_stage_a_share_of_it(shown: Series, words_only: None) -> None:
    known = diagnosis(shown)
    page = render(replace(known, verdict="no_gap", causes=(), where=replace(known.where, attributed=None)), shown)
    boxes = re.findall(r'class="box">[^<]*<small>([^<]*)</small>', page)
    assert boxes == ["no gap"] * 3


def test_rejected_candidates_are_shown_as_such_and_none_is_left_out(shown: Series) -> None:
    lines = tuple(Ranked(f"candidate_{k}", 0.0, 3.0 + k, rejected=True) for k in range(20))
    unclear = replace(diagnosis(shown), verdict="unexplained", causes=(), confusable=(), ranking=lines)
    rows = ranking_rows(unclear)
    assert len(rows) == 20
    assert {row["probability"] for row in rows} == {"rejected"}


def test_nothing_is_said_to_be_impossible_and_methods_are_those_in_use(shown: Series, words_only: None) -> None:
    unlikely = replace(diagnosis(shown), ranking=(Ranked("creep", 0.0, 0.3),), causes=())
    assert [row["probability"] for row in ranking_rows(unlikely)] == ["< 1 %"]
    page = render(unlikely, shown)
    assert "Fieller" in page  # twin/where/ratio.py
    assert "bootstrap" not in page


def test_a_cause_says_which_form_of_the_equations_it_has() -> None:
    rows = cause_rows(
        (Cause("ep_calibration", "ep", 0.9, form="gain_and_zero"), Cause("parameter:tau", "actuator", 0.9))
    )
    assert [row["form"] for row in rows] == ["gain and zero", ""]


def test_a_fast_stroke_is_drawn_whole() -> None:
    n = 100_000
    driver = np.where(np.arange(n) % 5000 < 2500, 4.0, 13.0)
    driver[2500:2600] = np.linspace(4.0, 13.0, 100)  # far fewer rows than are left out beside it
    noise = np.random.default_rng(1).normal(0.0, 1e-4, n)
    rows = thin_together((driver, driver / 10.0 + noise), 2000)
    assert rows.size < n / 10
    assert set(range(2500, 2600)) <= set(rows.tolist())
    broken = np.where(np.arange(n) % 1000 == 7, np.nan, driver)
    assert set(range(7, n, 1000)) <= set(thin_together((broken, driver), 2000).tolist())  # a cut stays a cut


def test_thinning_keeps_extremes_and_windows_stay_in_one_record(shown: Series) -> None:
    values = np.sin(np.arange(100_000) / 50.0)
    values[54_321] = 7.0
    rows = thin(values, 2000)
    assert rows.size <= 2000
    assert 54_321 in rows
    assert rows[0] == 0
    assert rows[-1] == values.size - 1
    window = busiest_window(shown, 400)
    assert shown.record is not None
    assert np.unique(shown.record[window]).size == 1
    assert np.all(np.diff(shown.run_time_s) > 0)


@pytest.mark.parametrize(
    ("source", "before", "said"), [("still", 0.1, False), ("straight", 0.1, True), ("straight", 0.3, False)]
)
def test_a_noise_that_holds_motion_is_said_to_be_no_more_than_a_bound(source: str, before: float, said: bool) -> None:
    gap = Gap(before, before, before, 0.2, None)
    healthy = Diagnosis("no_gap", "", (), (), gap, noise={"position": {"source": source}})
    assert ("or less" in statement(healthy)) is said
