"""A position that comes late is the position of then, and the pressure is that of now."""

from __future__ import annotations

import pytest

from app.physics_bench import open_virtual
from control.late_gauge import LateGauge


@pytest.mark.parametrize(("late_s", "rows"), [(0.0, 0.0), (0.3, 3.0), (0.25, 2.5)])
def test_the_position_is_that_of_then(late_s: float, rows: float) -> None:
    plain, late = open_virtual(0, noise=0.0), open_virtual(0, noise=0.0)
    bench = LateGauge(late.bench, late_s)
    seen, told = [], []
    with plain.bench, bench:
        for tick in range(40):
            seen.append(plain.bench.exchange(12.0))
            told.append(bench.exchange(12.0))
            for opened in (plain, late):
                opened.clock.sleep_until(0.1 * (tick + 1))
    below, part = int(rows), rows - int(rows)
    for n in range(4, 40):
        then = [seen[n - below].position.value, seen[n - below - 1].position.value]
        assert told[n].position.value == pytest.approx((1.0 - part) * then[0] + part * then[1], abs=1e-12)
        assert told[n].pressure == seen[n].pressure
    assert bench.info == late.bench.info
