"""An expired calibration: `check` refuses, what moves the valve warns, and a record keeps the warning."""

from __future__ import annotations

import json

from hal.profile import FOLDER
from logs.run import read_run
from tests.app.test_bench_verbs import lost


def expired_profile(tmp_path) -> str:
    text = (FOLDER / "virtual.toml").read_text(encoding="utf-8")
    assert "made = 2026-11-01" in text
    path = tmp_path / "expired.toml"
    path.write_text(text.replace("made = 2026-11-01", "made = 2019-01-01\nexpires = 2020-02-01"), encoding="utf-8")
    return str(path)


def test_an_expired_calibration_is_said_before_the_first_move_and_in_the_record(tmp_path) -> None:
    sentence = "calibration 'virtual-two-point' expired on 2020-02-01: positions may be off; `lostmotion calibrate`"
    profile = expired_profile(tmp_path)
    for words in (("set", "9", "--hold", "0.2"), ("jog", "+1", "--dwell", "0.2")):
        said = lost(*words, "--profile", profile)
        assert said.stderr.count(sentence) == 1
        assert "expired" not in lost(*words).output
    out = tmp_path / "run"
    said = lost(
        "sweep", "hold", "--set", "hold_s=2", "--set", "conditioning=false", "--profile", profile, "--out", str(out)
    )
    assert said.stderr.count(sentence) == 1
    assert next(event.text for event in read_run(out).events if event.level == "warning").startswith(sentence)
    shown = lost("show", str(out), "--json").stdout
    assert any("had expired on 2020-02-01" in note["what"] for note in json.loads(shown)["data_quality"])
