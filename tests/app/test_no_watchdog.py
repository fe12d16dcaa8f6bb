"""`check` says plainly when nothing would vent the valve but this program."""

from __future__ import annotations

import json

from hal.profile import FOLDER
from tests.app.test_bench_verbs import lost


def test_a_profile_without_a_watchdog_is_noted_and_no_failure(tmp_path) -> None:
    text = (FOLDER / "virtual.toml").read_text(encoding="utf-8")
    head, _, rest = text.partition("[devices.bench.watchdog]")
    path = tmp_path / "bare.toml"
    path.write_text(head + "[signals.command]" + rest.partition("[signals.command]")[2], encoding="utf-8")
    said = lost("check", "--profile", str(path))
    assert said.exit_code == 0
    line = next(line for line in said.output.splitlines() if "watchdog" in line)
    assert line.startswith("NOTE no watchdog")
    assert "keeps its last one" in line
    found = json.loads(lost("check", "--profile", str(path), "--json").stdout)
    assert [name for name, finding in found.items() if finding["remark"]] == ["no watchdog"]
    assert "NOTE" not in lost("check").output
