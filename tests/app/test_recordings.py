"""Which design a record is held to where nobody gives one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.recordings import DEFAULTS, FROM_RECORD, bench_design, design_for, from_open, load_all, without_design
from control.design import DesignModel, check_for_control, save_design
from hal.errors import BadInput
from logs.recording import Recording
from logs.spoken import HOUSE, Spoken
from tests.control.toy_valve import Toy, random_steps, record

PSI_PER_KPA, IN_PER_MM = 0.1450377, 1.0 / 25.4
IN_BAR = DesignModel(a1=0.6, a2=0.4, compliance=70.0, travel=14.0, pressure_unit="bar", position_unit="mm")


def a_file(folder: Path, command: str, position: str, scale: tuple[float, float]) -> Path:
    """A valve without backlash: 0.5 in for 10 psi after a lag of a second, written in other units."""
    time_s = np.arange(0.0, 400.0, 0.2)
    levels = np.random.default_rng(1).uniform(3.0, 13.0, time_s.size // 50)
    psi = np.repeat(levels, 50)
    stem, x = np.empty_like(psi), 0.05 * (psi[0] - 2.0)
    for k, p in enumerate(psi):
        x += 0.18 * (0.05 * (p - 2.0) - x)
        stem[k] = x
    stem += np.random.default_rng(2).normal(0.0, 5e-4, stem.size)
    path = folder / "valve.csv"
    table = np.column_stack([time_s, psi * scale[0], stem * scale[1]])
    np.savetxt(path, table, delimiter=",", header=f"time_s,command_{command},position_{position}", comments="")
    return path


@pytest.mark.parametrize(
    ("units", "scale", "defaults"),
    [(("psi", "in"), (1.0, 1.0), True), (("kPa", "mm"), (1.0 / PSI_PER_KPA, 1.0 / IN_PER_MM), False)],
)
def test_a_file_in_other_units_is_of_another_valve(
    tmp_path: Path, units: tuple[str, str], scale: tuple[float, float], defaults: bool
) -> None:
    recordings = load_all([a_file(tmp_path, *units, scale)], None, None, "before")
    design, origin = design_for(None, recordings)
    assert (origin == "the defaults") is defaults
    assert (design == DesignModel()) is defaults
    if not defaults:
        assert design.compliance == pytest.approx(0.05, rel=0.02)
        assert design.deadband < 0.05


@pytest.mark.parametrize(
    ("units", "scale", "said"),
    [(("psi", "in"), (1.0, 1.0), HOUSE), (("kPa", "mm"), (1.0 / PSI_PER_KPA, 1.0 / IN_PER_MM), Spoken("kPa", "mm"))],
)
def test_one_is_answered_in_the_units_of_the_design_or_else_of_the_records(
    tmp_path: Path, units: tuple[str, str], scale: tuple[float, float], said: Spoken
) -> None:
    recordings = load_all([a_file(tmp_path, *units, scale)], None, None, "before")
    assert design_for(None, recordings)[0].spoken == said
    file = tmp_path / "valve.toml"
    save_design(
        DesignModel(a1=0.6, a2=0.4, compliance=70.0, travel=14.0, pressure_unit="bar", position_unit="mm"), file
    )
    design, _ = design_for(file, recordings)
    assert design.spoken == Spoken("bar", "mm")
    assert (design.pressure_unit, design.position_unit) == ("psi", "in")
    assert design.travel == pytest.approx(14.0 / 25.4)


def test_a_bench_gets_the_design_in_its_own_units(tmp_path: Path) -> None:
    file = tmp_path / "valve.toml"
    save_design(
        DesignModel(a1=0.6, a2=0.4, compliance=70.0, travel=14.0, pressure_unit="bar", position_unit="mm"), file
    )
    design = bench_design(file)
    check_for_control(design)
    assert design.a1 == pytest.approx(0.6 / 0.0689475729, rel=1e-8)
    save_design(DesignModel(position_unit="percent"), file)
    with pytest.raises(BadInput, match="percent"):
        check_for_control(bench_design(file))


def test_a_zero_far_from_fully_open_is_taken_off_where_no_design_says_where_it_is(tmp_path: Path) -> None:
    command = random_steps(240.0, 0.2, seed=3)
    plain = record(Toy(), 0.2 * np.arange(command.size), command)

    def read(zero_in: float, foreign: bool) -> Recording:
        meta = {"foreign": ("position",)} if foreign else {}
        return replace(plain, position=plain.position + zero_in, meta=meta)

    ((done,), golden) = from_open([read(0.3, foreign=True)])
    assert golden == [] and done.notes[-1].what.startswith("the position reads 0.3 in where")
    ((same,), _) = from_open([read(0.3, foreign=False)])  # of the thesis's travel: a sensor may have slipped
    assert same.notes == plain.notes
    ((far,), (beside,)) = from_open([read(2.0, foreign=False)], [read(2.0, foreign=False)])
    assert abs(float(far.position.min())) < 0.01 and np.array_equal(far.position, beside.position)


def test_a_valve_in_psi_and_in_that_cannot_be_the_thesis_s_gets_its_own_numbers(tmp_path: Path) -> None:
    recordings = load_all([a_file(tmp_path, "psi", "in", (1.0, 1.0))], None, None, "before")
    assert design_for(None, recordings)[1] == DEFAULTS
    _, _, design, origin = without_design(recordings, [])
    assert origin.startswith(FROM_RECORD) and "% of travel" in origin
    assert design.compliance == pytest.approx(0.05, rel=0.02)


@pytest.mark.parametrize("toy", [Toy(), Toy(tau=8.0), Toy(a1=10.5)])
def test_the_thesis_s_valve_with_a_wrong_number_does_not(toy: Toy) -> None:
    command = random_steps(240.0, 0.2, seed=3)
    recordings = [record(toy, 0.2 * np.arange(command.size), command)]
    ((same,), _, design, origin) = without_design(recordings, [])
    assert (design, origin) == (DesignModel(), DEFAULTS)
    assert np.array_equal(same.position, recordings[0].position)
