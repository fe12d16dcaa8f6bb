"""The serial line that is not there."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from hal.errors import PortFault
from sim_device.pseudoterminal import PseudoTerminal


def test_a_stale_link_is_replaced_and_the_own_one_removed(tmp_path: Path) -> None:
    link = tmp_path / "valve"
    link.symlink_to("/nowhere")
    terminal = PseudoTerminal(link)
    assert terminal.port == str(link)
    assert os.path.realpath(link) == terminal.path
    terminal.close()
    assert not os.path.lexists(link)


def test_a_link_that_somebody_else_took_over_is_left_alone(tmp_path: Path) -> None:
    link = tmp_path / "valve"
    first, second = PseudoTerminal(link), PseudoTerminal(link)
    first.close()
    assert os.path.realpath(link) == second.path
    second.close()


def test_a_file_of_that_name_is_never_overwritten(tmp_path: Path) -> None:
    data = tmp_path / "thesis.txt"
    data.write_text("precious")
    with pytest.raises(PortFault, match=r"a file of that name exists; choose another --port-link"):
        PseudoTerminal(data)
    assert data.read_text() == "precious"


def test_a_folder_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(PortFault, match="missing/valve"):
        PseudoTerminal(tmp_path / "missing" / "valve")
