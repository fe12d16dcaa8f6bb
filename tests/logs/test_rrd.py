"""The view as a file: every sample is in it, with a layout, and a failure does not leave half a file."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from hal.errors import BadInput
from logs.rrd import write_rrd
from logs.run import Run, read_run
from tests.logs.runs import valve_columns, write_run


def contents(path: Path) -> tuple[Counter[str], int]:
    """Rows per entity, and how many blueprints the file holds."""
    from rerun.chunk import RrdReader

    reader = RrdReader(path)
    rows: Counter[str] = Counter()
    for chunk in reader.stream(store=reader.recordings()[0]):
        rows[chunk.entity_path] += chunk.to_record_batch().num_rows
    return rows, len(reader.blueprints())


@pytest.fixture(autouse=True)
def strict(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wrong type is an error here; by itself rerun would warn and store nothing."""
    import rerun as rr

    monkeypatch.setenv("RERUN_STRICT", "1")
    rr.set_strict_mode(True)


def test_every_sample_state_and_event_is_in_the_file_with_a_layout(tmp_path: Path) -> None:
    columns = valve_columns(500)
    columns["target_in"] = np.round(columns["position_in"], 1)
    columns["pressure_psi"][50:60] = np.nan
    write_run(tmp_path / "run", columns)
    path = write_rrd(read_run(tmp_path / "run"), tmp_path / "view.rrd")
    rows, blueprints = contents(path)
    for entity in ("/pressure", "/position", "/error", "/timing", "/aux/quality", "/aux/step"):
        assert rows[entity] - 1 == 500, entity  # and one row of names and colours
    for entity in ("/plane/design/closing", "/plane/design/opening", "/plane/run/rising", "/plane/run/falling"):
        assert rows[entity] == 1, entity
    assert rows["/plane/trail"] == rows["/plane/now"] >= 490 // 12
    assert rows["/state/bench"] == 2  # its colours, and running
    assert (rows["/log/event"], rows["/log/note"], rows["/log/end"], rows["/about"]) == (1, 1, 1, 1)
    assert blueprints == 1
    assert not list(tmp_path.glob("*.partial"))


@pytest.mark.parametrize("left", [("pressure_psi",), ("pressure_psi", "position_in"), ("command_psi", "pressure_psi")])
def test_a_run_with_fewer_signals_has_a_view_too(tmp_path: Path, left: tuple[str, ...]) -> None:
    columns = {name: values for name, values in valve_columns(60).items() if name not in left}
    write_run(tmp_path / "run", columns)
    rows, blueprints = contents(write_rrd(read_run(tmp_path / "run"), tmp_path / "view.rrd"))
    assert rows["/timing"] == 61 and blueprints == 1


def test_a_run_without_samples_is_refused(tmp_path: Path) -> None:
    empty = Run(tmp_path, {}, {"time_s": np.zeros(0)}, {"time_s": "s"})
    with pytest.raises(BadInput, match="nothing to view"):
        write_rrd(empty, tmp_path / "view.rrd")
    assert not (tmp_path / "view.rrd").exists()


def test_a_file_that_cannot_be_written_is_bad_input(tmp_path: Path) -> None:
    write_run(tmp_path / "run", valve_columns(30))
    with pytest.raises(BadInput, match="cannot be written"):
        write_rrd(read_run(tmp_path / "run"), tmp_path / "no folder" / "view.rrd")
