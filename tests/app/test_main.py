"""The door: Ctrl-C while the program is still being imported, or has just ended, is no traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest

#: Sends SIGINT when module NAME is looked for, or is done with; then runs the command line.
_INTERRUPTED_AT = """
import os, signal, sys
NAME, ALSO = sys.argv[1:3]
class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == NAME:
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Finder())
sys.argv = ["lostmotion", *sys.argv[3:]]
if ALSO == "ignored":
    signal.signal(signal.SIGINT, signal.SIG_IGN)
from app.__main__ import main
main()
"""


def run(code: list[str]) -> subprocess.CompletedProcess[str]:
    """In a process that hears SIGINT, whatever became of it for this one: what runs in the background does not."""

    def hears() -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    env = {**os.environ, "CI": "true"}
    return subprocess.run(code, capture_output=True, text=True, check=False, env=env, preexec_fn=hears)


def interrupted_at(name: str, also: str = "", *words: str) -> subprocess.CompletedProcess[str]:
    return run([sys.executable, "-c", _INTERRUPTED_AT, name, also, *(words or ("explain", "stiction"))])


@pytest.mark.parametrize("name", ["hal", "twin", "app.cli", "click", "hal.errors", "app.commands.explain", "numpy"])
def test_an_interrupt_during_the_imports_is_exit_130_without_a_traceback(name: str) -> None:
    done = interrupted_at(name)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr.strip() == "lostmotion: interrupted"


def test_an_interrupt_that_somebody_has_switched_off_stays_off() -> None:
    done = interrupted_at("click", "ignored", "--version")
    assert done.returncode == 0
    assert done.stdout.startswith("lostmotion, version")


def test_an_interrupt_after_the_end_is_no_traceback() -> None:
    code = (
        "import atexit, os, signal, sys; sys.argv = ['lostmotion', '--version']; "
        f"atexit.register(os.kill, os.getpid(), {int(signal.SIGINT)}); from app.__main__ import main; main()"
    )
    done = run([sys.executable, "-c", code])
    assert (done.returncode, done.stderr) == (130, "lostmotion: interrupted\n")
