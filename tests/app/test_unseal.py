from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from app.commands.emulate import command as emulate
from app.commands.unseal import command
from hal.errors import BadInput
from sim_device.sealed import draw, reveal, write

FOUND = {"verdict": "effect", "causes": [{"name": "creep", "probability": 0.91}]}


@pytest.fixture
def run(tmp_path: Path) -> Path:
    write(tmp_path, draw("plum"))
    (tmp_path / "diagnosis.json").write_text(json.dumps(FOUND))
    return tmp_path


def test_truth_and_finding_stand_under_each_other(run: Path) -> None:
    result = CliRunner().invoke(command, [str(run), "plum"])
    assert result.exit_code == 0
    truth, found = result.output.splitlines()
    assert all(cause.key in truth for cause in reveal("plum").causes)
    assert found == "found:  effect: creep (probability 0.91)"


def test_json_is_the_label(run: Path) -> None:
    result = CliRunner().invoke(command, [str(run), "plum", "--json"])
    assert json.loads(result.output)["kind"] == reveal("plum").kind


def test_the_wrong_seed_is_refused(run: Path) -> None:
    result = CliRunner().invoke(command, [str(run), "pear"])
    assert isinstance(result.exception, BadInput)
    assert "does not belong to seed 'pear'" in str(result.exception)


def test_a_diagnosis_that_is_none_is_refused(run: Path) -> None:
    (run / "diagnosis.json").write_text("[1]")
    result = CliRunner().invoke(command, [str(run), "plum"])
    assert "this is not a diagnosis" in str(result.exception)


def test_emulate_sealed_takes_no_effect_besides() -> None:
    result = CliRunner().invoke(emulate, ["--sealed", "plum", "--effect", "creep=0.1"])
    assert "leave out --physics, --effect and --plant" in str(result.exception)


def test_emulate_sealed_commits_before_it_listens_and_tells_nothing(tmp_path: Path) -> None:
    file = tmp_path / "sealed.json"
    arguments = ["emulate", "--sealed", "plum", "--commitment", str(file), "--json", "--port-link", str(tmp_path / "v")]
    with subprocess.Popen([sys.executable, "-m", "app", *arguments], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        said = json.loads(process.stdout.readline())
        process.terminate()
    assert said["commitment"] == draw("plum").commitment == json.loads(file.read_text())["commitment"]
    assert said["physics"] == f"{reveal('plum').family}, sealed"
    assert set(said) == {"port", "tcp", "physics", "commitment", "profile", "units"}
