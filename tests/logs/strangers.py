"""Strangers' files written and read again, for the tests of the reader."""

from __future__ import annotations

from pathlib import Path

import pytest

from hal.errors import BadInput
from logs.load import load_recording
from logs.recording import Recording

HEAD = "time_s,command_psi,pressure_psi,position_in\n"
KPA = 0.145037737730


def load(tmp_path: Path, text: str | bytes, **options: str) -> Recording:
    path = tmp_path / "file.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return load_recording(path, **options)  # type: ignore[arg-type]


def refusal(tmp_path: Path, text: str | bytes, **options: str) -> str:
    with pytest.raises(BadInput) as caught:
        load(tmp_path, text, **options)
    return str(caught.value)


def said(recording: Recording) -> str:
    return "\n".join(f"{note.what} | {note.handled} | {note.rows} | {note.first_row}" for note in recording.notes)
