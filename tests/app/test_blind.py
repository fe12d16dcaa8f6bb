from __future__ import annotations

import json
from pathlib import Path

from click.testing import CliRunner

from app.blind.protocol import begin
from app.blind.trial import orders
from app.commands.blind import command
from tests.app.blind.lines import some_lines


def prepared(folder: Path) -> Path:
    """A check whose trials are all done."""
    lines = some_lines()
    protocol = begin(folder, orders(len(lines), 1, "thesis", folder), 1, "thesis")
    for line in lines:
        if "commitment" in line:
            line["commitment"] = protocol["commitments"][line["seal"]]
    (folder / "trials.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    return folder


def test_a_finished_check_is_only_scored(tmp_path: Path) -> None:
    words = ["--trials", "8", "--seed", "1", "--family", "thesis", "--out", str(prepared(tmp_path))]
    result = CliRunner().invoke(command, words)
    assert result.exit_code == 0, result.output
    assert "8 done, 0 to do" in result.output and "3 of 6  50 %" in result.output
    assert "1 trials ended in an error" in result.output
    assert json.loads((tmp_path / "scores.json").read_text())["trials"] == 8
    assert (tmp_path / "blind.html").stat().st_size > 5000


def test_json_is_the_scores_alone(tmp_path: Path) -> None:
    words = ["--trials", "8", "--seed", "1", "--family", "thesis", "--out", str(prepared(tmp_path)), "--json"]
    result = CliRunner().invoke(command, words)
    assert json.loads(result.stdout)["all"]["right"]["hits"] == 3
