"""Effects are found, not listed."""

from __future__ import annotations

from pathlib import Path

import pytest

import twin.model.catalog
from hal.errors import BadInput
from twin.model.catalog import effect, effects


def test_found_in_alphabetical_order() -> None:
    assert list(effects()) == sorted(effects())
    assert effect("creep") is effects()["creep"]


def test_unknown_effect_names_those_there_are() -> None:
    with pytest.raises(BadInput, match=r"no effect is called 'rust'; there are additional_lag, .*supply_saturation"):
        effect("rust")


def test_a_file_that_defines_none_is_a_defect(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "nothing.py").write_text('"""An effect that forgot to register."""\n')
    monkeypatch.setattr(twin.model.catalog, "_FOLDER", tmp_path)
    monkeypatch.setattr("twin.effects.__path__", [str(tmp_path)])
    with pytest.raises(TypeError, match=r"nothing.py must define EFFECT, an Effect called 'nothing'"):
        effects.__wrapped__()
