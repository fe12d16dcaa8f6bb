"""`lostmotion emulate` as a process of its own."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from click.testing import CliRunner

from app.commands.emulate import command
from hal.errors import BadInput
from tests.sim_device.wire import Wire


@contextmanager
def emulating(*arguments: str) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [sys.executable, "-m", "app", "emulate", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def test_it_says_where_it_listens_answers_there_and_takes_its_link_away(tmp_path: Path) -> None:
    link = tmp_path / "valve"
    with emulating("--port-link", str(link), "--json") as process:
        assert process.stdout is not None
        place = json.loads(process.stdout.readline())
        assert place == {"port": str(link), "tcp": None, "units": [1], "profile": "virtual", "physics": "thesis"}
        with Wire(place["port"], patience_s=20.0) as wire:
            assert wire.ask("01 10 00 00 00 02 04 40 e8 00 00", 6) == "01 10 00 00 00 02"
            assert wire.ask("01 03 00 10 00 02", 7) == "01 03 04 40 e8 00 00"
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=10.0) == 0
        assert not os.path.lexists(link)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--fault", "rain=0.1"], "rain=0.1"),
        (["--tcp", "0.0.0.0:0"], "loopback"),
        (["--physics", "perpetuum"], "there is no physics 'perpetuum'"),
        (["--effect", "stiction"], "NAME=SIZE"),
        (["--profile", "nowhere.toml"], "nowhere.toml"),
        (["--tcp", "127.0.0.1:0", "--fault", "bit_flip=0.1"], "use a pseudo-terminal or rtu+tcp://"),
        (["--fault", "wrong_transaction=0.1"], "it needs Modbus TCP"),
    ],
)
def test_what_it_cannot_do_is_one_sentence(arguments: list[str], message: str) -> None:
    result = CliRunner().invoke(command, arguments)
    assert isinstance(result.exception, BadInput)
    assert message in str(result.exception)
