"""Starts the rerun viewer as its own process: on a screen, or without one to take a picture. Loopback only, and quiet.

The `rerun` script is a wrapper whose child outlives it, so the binary itself is started; CI=true in its environment
keeps it from sending usage data.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING

from hal.clock import Clock, RealClock
from hal.errors import BadInput, JobFailed
from logs.ports import LOOPBACK, free_port, listens

if TYPE_CHECKING:
    from rerun.experimental import ViewerClient

PATIENCE_S = 60.0


def viewer_binary() -> Path:
    """The native viewer that comes with rerun-sdk. Raises: `JobFailed` when the package holds none for this system."""
    import rerun_cli

    folder = Path(rerun_cli.__file__).parent
    names = ("rerun.exe",) if sys.platform.startswith("win") else ("Rerun.app/Contents/MacOS/Rerun", "rerun")
    for name in names:
        if (folder / name).is_file():
            return folder / name
    raise JobFailed(f"{folder}: rerun's viewer is not in this installation; run `make setup` again")


def has_screen() -> bool:
    """Whether a window could be opened here."""
    if sys.platform.startswith(("win", "darwin")):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def open_window(target: str) -> subprocess.Popen[bytes]:
    """Starts the viewer on a file or on the address of a live view, and returns at once."""
    where = ["--connect", target] if target.startswith("rerun+") else [target]
    return _start(["--port", str(free_port()), *where], log=None)


def take_picture(
    file: Path,
    png: Path,
    *,
    at_s: float | None = None,
    size: tuple[int, int] = (1600, 1000),
    settle_s: float = 6.0,
) -> list[str]:
    """Renders `file` without a screen into `png`, with the cursor at `at_s` (the end if None).

    The viewer's start-up messages cover a corner of the picture for 5 s; `settle_s` waits for them to go.
    Returns what the views complain about, as sentences.
    Raises: `JobFailed` when this machine has no Vulkan driver, or the viewer does not come up in time.
    """
    try:
        png.touch()
    except OSError as error:
        raise BadInput(f"{png}: cannot be written ({error.strerror}); name another file") from error
    try:
        with _headless(file, size) as client:
            clock = RealClock()
            _wait_for_recording(client, clock)
            _set_cursor(client, at_s)
            png.write_bytes(_settled_picture(client, clock, settle_s))
            return [report.summary for view in client.get_state().views for report in view.reports]
    except BaseException:
        if not png.stat().st_size:
            png.unlink()  # no picture, no file
        raise


@contextmanager
def _headless(file: Path, size: tuple[int, int]) -> Iterator[ViewerClient]:
    from rerun.experimental import ViewerClient

    port = free_port()
    window = ["--window-size", f"{size[0]}x{size[1]}"]
    options = ["--headless", "--port", str(port), "--memory-limit", "1GB", "-j", "1", *window, str(file)]
    with tempfile.TemporaryFile() as log:
        process = _start(options, log)
        try:
            if not _up(process, port):
                raise _no_picture(log)
            yield ViewerClient.connect(f"rerun+http://{LOOPBACK}:{port}/proxy")
        except ConnectionError as error:  # it was there, and has died: some find out late that they cannot render
            raise _no_picture(log) from error
        finally:
            process.terminate()
            process.wait(10.0)


def _no_picture(log: IO[bytes]) -> JobFailed:
    log.seek(0)
    said = [line.strip() for line in log.read().decode(errors="replace").splitlines() if line.strip()]
    why = next((line for line in said if re.search("error|failed|panicked", line, re.IGNORECASE)), (said or [""])[-1])
    return JobFailed(
        f"the viewer cannot render here ({why[:200] or 'it said nothing'}); a picture without a screen needs a Vulkan "
        "driver: on Debian, apt-get install mesa-vulkan-drivers"
    )


def _start(options: list[str], log: IO[bytes] | None) -> subprocess.Popen[bytes]:
    runtime = os.environ.get("XDG_RUNTIME_DIR") or tempfile.gettempdir()
    command = [str(viewer_binary()), "--bind", LOOPBACK, "--hide-welcome-screen", *options]
    return subprocess.Popen(
        command,
        env={**os.environ, "CI": "true", "XDG_RUNTIME_DIR": runtime},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL if log is None else log,
        stderr=subprocess.STDOUT,
    )


def _up(process: subprocess.Popen[bytes], port: int) -> bool:
    for _ in range(int(PATIENCE_S)):
        if process.poll() is not None:
            return False
        if listens(port, patience_s=1.0):
            return True
    return False


def _wait_for_recording(client: ViewerClient, clock: Clock) -> None:
    end_s = clock.now_s() + PATIENCE_S
    while clock.now_s() < end_s:
        state = client.get_state()
        if state.recordings and not state.loading:
            return
        clock.sleep_until(clock.now_s() + 0.1)
    raise JobFailed(f"the viewer has not opened the file within {PATIENCE_S:.0f} s; the machine may be too busy")


def _set_cursor(client: ViewerClient, at_s: float | None) -> None:
    if at_s is not None:
        client.set_time("run_time", duration=at_s, play_state="paused")


def _settled_picture(client: ViewerClient, clock: Clock, settle_s: float) -> bytes:
    """Chunks of a file load lazily and messages fade: shoots until two pictures in a row are the same."""
    start_s = clock.now_s()
    last = b""
    while clock.now_s() < start_s + PATIENCE_S:
        clock.sleep_until(clock.now_s() + 0.7)
        picture = bytes(client.take_screenshot())
        if picture == last and clock.now_s() > start_s + settle_s:
            return picture
        last = picture
    return last
