"""Columns and rows of a record."""

from __future__ import annotations

import math

from control.row import columns_of, missing_sample, row_of
from hal.clock import SteppedClock
from hal.profile_checks import RESERVED
from hal.sample import Quality, Reading, Sample
from tests.control.fakes import ToyBench


def test_columns_carry_units_and_depend_on_the_bench() -> None:
    columns = columns_of(ToyBench(SteppedClock()).info, closed_loop=True, aux_units={"supply_psi": "psi"})
    assert columns["command_psi"] == columns["next_command_psi"] == columns["supply_psi"] == "psi"
    assert columns["target_in"] == "in"
    bare = columns_of(
        ToyBench(SteppedClock(), unit="percent", has_pressure=False).info, closed_loop=False, aux_units={}
    )
    assert "command_percent" in bare
    assert not {"pressure_psi", "pressure_quality", "target_in", "command_psi"} & set(bare)


def test_no_further_channel_takes_the_name_of_a_column() -> None:
    for unit in ("psi", "percent"):
        info = ToyBench(SteppedClock(), unit=unit).info
        assert set(columns_of(info, closed_loop=True, aux_units={})) <= RESERVED


def test_every_key_of_a_row_is_a_declared_column() -> None:
    info = ToyBench(SteppedClock()).info
    columns = columns_of(info, closed_loop=True, aux_units={"supply_psi": "psi"})
    sample = Sample(
        12.0,
        9.0,
        Reading(0.1, 12.0, 0.001, Quality.STALE),
        Reading(8.9, 12.0, 0.001),
        sequence=5,
        aux={"supply_psi": Reading(20.0, 12.0, 0.001), "other": Reading(1.0, 12.0, 0.001)},
    )
    row = row_of(
        sample, unit="psi", origin_s=2.0, in_force=8.0, lateness_s=0.01, step=3, target_in=0.2, aux=("supply_psi",)
    )
    assert set(row) == set(columns)
    assert (row["time_s"], row["command_psi"], row["next_command_psi"]) == (10.0, 8.0, 9.0)
    assert (row["quality"], row["pressure_quality"], row["step"], row["sequence"]) == (1.0, 0.0, 3.0, 5.0)


def test_a_missing_sample_has_a_time_a_command_and_nothing_else() -> None:
    sample = missing_sample(3.0, 9.0, has_pressure=True)
    assert math.isnan(sample.position.value)
    assert sample.pressure is not None
    assert sample.pressure.quality == Quality.MISSING
    assert missing_sample(3.0, 9.0, has_pressure=False).pressure is None
