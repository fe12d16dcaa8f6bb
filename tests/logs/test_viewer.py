"""The viewer without a screen: a picture with something on it, and a clear word where there can be none."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from hal.errors import JobFailed
from logs import viewer
from logs.rrd import write_rrd
from logs.run import read_run
from tests.logs.runs import valve_columns, write_run


def has_vulkan() -> bool:
    folders = (Path("/usr/share/vulkan/icd.d"), Path("/etc/vulkan/icd.d"))
    return any(list(folder.glob("*.json")) for folder in folders if folder.is_dir())


@pytest.fixture
def view(tmp_path: Path) -> Path:
    columns = valve_columns(400)
    columns["target_in"] = np.round(columns["position_in"], 1)
    write_run(tmp_path / "run", columns)
    return write_rrd(read_run(tmp_path / "run"), tmp_path / "view.rrd")


@pytest.mark.viewer
@pytest.mark.skipif(not has_vulkan(), reason="no Vulkan driver here: apt-get install mesa-vulkan-drivers")
def test_a_picture_has_colours_on_it_and_no_view_complains(view: Path, tmp_path: Path) -> None:
    from PIL import Image

    complaints = viewer.take_picture(view, tmp_path / "view.png", size=(1000, 700), settle_s=1.5)
    assert complaints == []
    picture = np.asarray(Image.open(tmp_path / "view.png").convert("RGB")).reshape(-1, 3).astype(int)
    for colour in ((110, 168, 254), (255, 166, 64), (129, 199, 132), (186, 140, 255), (240, 98, 146)):
        near = np.abs(picture - np.array(colour)).sum(axis=1) < 40
        assert near.sum() > 30, colour


def test_a_viewer_that_cannot_start_says_what_to_install(
    view: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = tmp_path / "viewer"
    broken.write_text("#!/bin/sh\necho Failed to get render context\nexit 102\n")
    broken.chmod(0o755)
    monkeypatch.setattr(viewer, "viewer_binary", lambda: broken)
    with pytest.raises(JobFailed, match=r"Failed to get render context.*apt-get install mesa-vulkan-drivers"):
        viewer.take_picture(view, tmp_path / "view.png")
    assert not (tmp_path / "view.png").exists()


def test_a_viewer_that_finds_out_late_says_the_same(
    view: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    late = tmp_path / "viewer"
    late.write_text(
        f"#!{sys.executable}\nimport socket, sys\n"
        "server = socket.create_server(('127.0.0.1', int(sys.argv[sys.argv.index('--port') + 1])))\n"
        "server.accept()\nprint('starting')\nprint('thread main panicked: no adapter')\nprint('bye')\n"
    )
    late.chmod(0o755)
    monkeypatch.setattr(viewer, "viewer_binary", lambda: late)
    with pytest.raises(JobFailed, match=r"panicked: no adapter.*apt-get install mesa-vulkan-drivers"):
        viewer.take_picture(view, tmp_path / "view.png")


@pytest.mark.parametrize(("name", "there"), [("DISPLAY", True), ("WAYLAND_DISPLAY", True), ("", False)])
def test_a_screen_is_known_by_the_environment(monkeypatch: pytest.MonkeyPatch, name: str, there: bool) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    if name:
        monkeypatch.setenv(name, ":0")
    assert viewer.has_screen() is there


def test_the_viewer_is_started_quiet_and_on_the_loopback_address(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = tmp_path / "said"
    fake = tmp_path / "viewer"
    fake.write_text(f'#!/bin/sh\necho "CI=$CI $*" > {said}\n')
    fake.chmod(0o755)
    monkeypatch.setattr(viewer, "viewer_binary", lambda: fake)
    viewer.open_window("run.rrd").wait(5.0)
    assert "CI=true" in said.read_text() and "--bind 127.0.0.1" in said.read_text() and "run.rrd" in said.read_text()
    viewer.open_window("rerun+http://127.0.0.1:9/proxy").wait(5.0)
    assert "--connect rerun+http://127.0.0.1:9/proxy" in said.read_text()
