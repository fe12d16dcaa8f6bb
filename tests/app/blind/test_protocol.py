from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.blind.protocol import FILE, begin, check, code_digest
from app.blind.trial import orders
from hal.errors import BadInput
from sim_device.sealed import draw


def test_every_valve_is_committed_to_and_none_is_told(tmp_path: Path) -> None:
    todo = orders(3, 5, "thesis", tmp_path)
    content = begin(tmp_path, todo, 5, "thesis")
    assert content["commitments"] == {o.seal: draw(o.seal, ("thesis",)).commitment for o in todo}
    text = (tmp_path / FILE).read_text()
    assert json.loads(text)["code"] == code_digest()
    assert "physics_seed" not in text and "causes" not in text


def test_more_trials_later_keep_what_was_written(tmp_path: Path) -> None:
    first = begin(tmp_path, orders(1, 5, "thesis", tmp_path), 5, "thesis")["commitments"]
    later = begin(tmp_path, orders(2, 5, "thesis", tmp_path), 5, "thesis")["commitments"]
    assert first.items() < later.items()


def test_another_seed_or_other_code_needs_another_folder(tmp_path: Path) -> None:
    begin(tmp_path, [], 5, "thesis")
    with pytest.raises(BadInput, match="seed = 5"):
        begin(tmp_path, [], 6, "thesis")
    content = json.loads((tmp_path / FILE).read_text())
    (tmp_path / FILE).write_text(json.dumps(content | {"code": "0" * 64}))
    with pytest.raises(BadInput, match="code"):
        begin(tmp_path, [], 5, "thesis")


def test_a_result_of_another_valve_is_refused(tmp_path: Path) -> None:
    todo = orders(1, 5, "thesis", tmp_path)
    content = begin(tmp_path, todo, 5, "thesis")
    check(content, [{"trial": 0, "seal": todo[0].seal, "commitment": content["commitments"][todo[0].seal]}])
    with pytest.raises(BadInput, match="trial 0"):
        check(content, [{"trial": 0, "seal": todo[0].seal, "commitment": "f" * 64}])


def test_a_file_that_is_no_protocol(tmp_path: Path) -> None:
    (tmp_path / FILE).write_text("{")
    with pytest.raises(BadInput, match="no protocol"):
        begin(tmp_path, [], 5, "thesis")
