"""The HAL drives slaves that nobody here wrote, from a profile."""

from __future__ import annotations

import pytest

from hal.clock import RealClock
from hal.errors import BenchFault
from hal.modbus_bench import ModbusBench
from hal.sample import Quality
from tests.interop.peers import foreign_profile, pymodbus_slave


@pytest.mark.parametrize("fc23", [True, False], ids=["one transaction", "write and read"])
def test_the_hal_drives_the_simulator_of_pymodbus(fc23: bool) -> None:
    with pymodbus_slave() as port:
        with ModbusBench(foreign_profile(fc23=fc23), port, RealClock()) as bench:
            bench.exchange(7.25)
            sample = bench.exchange(9.5)
            assert sample.readback_psi == 9.5
            assert sample.pressure is not None
            assert (sample.pressure.value, sample.pressure.quality) == (9.5, Quality.GOOD)
            assert sample.position.value == 0.0
        with ModbusBench(foreign_profile(fc23=fc23), port, RealClock(), read_only=True) as bench:
            assert bench.observe().readback_psi == 0.0  # leaving the bench sent the safe command


def test_the_hal_names_a_slave_that_is_not_there() -> None:
    with pymodbus_slave() as port, pytest.raises(BenchFault, match="99"):
        ModbusBench(foreign_profile(id=99), port, RealClock(), margin_s=0.05).__enter__()
