"""The rerun file of a diagnosis: every view has its data, on one time line, and the verdict in words."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hal.errors import BadInput
from tests.twin.report_example import diagnosis, series
from twin.report.rrd import _strips, write_rrd
from twin.report.story import story


def entities(path: Path) -> dict[str, int]:
    """Rows per entity of the recording."""
    from rerun.chunk import RrdReader

    reader = RrdReader(path)
    assert len(reader.blueprints()) == 1
    rows: dict[str, int] = {}
    for chunk in reader.stream(store=reader.recordings()[0]):
        rows[chunk.entity_path] = rows.get(chunk.entity_path, 0) + chunk.to_record_batch().num_rows
    return rows


def test_file_tells_the_story_over_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RERUN_STRICT", "1")
    shown = series(60)
    path = write_rrd(diagnosis(shown), shown, tmp_path / "diagnosis.rrd")
    rows = entities(path)
    n = shown.time_s.size
    for entity in ("/drive", "/position", "/residual", "/running"):
        assert rows[entity] >= n
    for entity in ("/story", "/state/regime", "/state/data", "/plane/trail", "/plane/now", "/plane/loop/updated"):
        assert rows[entity] >= 1
    assert not list(tmp_path.glob("*.partial"))


@pytest.mark.thorough
def test_loops_in_the_plane_share_their_rows(tmp_path: Path) -> None:
    from rerun.chunk import RrdReader

    shown = series(12_000)
    reader = RrdReader(write_rrd(diagnosis(shown), shown, tmp_path / "long.rrd"))
    drawn: dict[str, list[float]] = {}
    for chunk in reader.stream(store=reader.recordings()[0]):
        if "/plane/loop/" in chunk.entity_path:
            strips = chunk.to_record_batch().column("LineStrips2D:strips").to_pylist()[0]
            drawn[chunk.entity_path] = [point[0] for strip in strips for point in strip]
    measured, design, updated = (drawn[f"/plane/loop/{name}"] for name in ("measured", "design", "updated"))
    assert design == updated == measured


def test_loops_are_cut_between_recordings_and_where_readings_are_missing() -> None:
    shown = series(60)
    assert shown.record is not None
    y = shown.position.copy()
    y[10] = np.nan
    rows = np.arange(y.size)
    cut = _strips(shown.command, y, rows, shown)
    assert len(cut) == 1 + np.unique(shown.record).size > 2
    assert sum(len(strip) for strip in cut) == y.size - 1


def test_bare_series_and_impossible_places(tmp_path: Path) -> None:
    shown = series(60)
    position = shown.position.copy()
    position[50:90] = np.nan
    bare = replace(shown, position=position, pressure=None, retuned=None, record=None)
    assert "/drive" in entities(write_rrd(diagnosis(shown), bare, tmp_path / "bare.rrd"))
    with pytest.raises(BadInput, match="cannot be written"):
        write_rrd(diagnosis(shown), bare, tmp_path / "none" / "x.rrd")
    nothing = np.zeros(0)
    empty = replace(bare, **dict.fromkeys(("time_s", "command", "position", "before", "after"), nothing))
    with pytest.raises(BadInput, match="no rows"):
        write_rrd(diagnosis(shown), replace(empty, heldout=nothing > 0), tmp_path / "empty.rrd")


def test_story_in_words() -> None:
    text = story(diagnosis(series(60)))
    assert text.startswith("# Several effects are missing")
    assert "| noise floor | 0.142 |" in text
    assert "breakaway 0.350 psi (0.330 to 0.370)" in text
    assert "Not to be told apart with this data: stiction, distributed hysteresis" in text
