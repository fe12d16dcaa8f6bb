"""Whether dither and iterative learning pay: both tried on the virtual valve, next to the controller `brake`.

`python bench/dither_and_learning.py` prints two tables in half a minute.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from app.rivals import open_scenario
from control.compare import true_valve
from control.controller import Controller, make_controller
from control.design import DesignModel
from control.metrics import Score, score
from control.scenarios import SCENARIOS, TRAVEL_IN, Scenario
from control.trial import run_trial

DESIGN, TICK_S, SEEDS = DesignModel(), 0.1, (0, 1)
FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Dithered:
    """Another controller, with a square wave of `size_psi` and `ticks` per half period on its command."""

    inner: Controller[Any]
    size_psi: float
    ticks: int = 3

    def initial(self, sample: Any, target_in: float) -> Any:
        return 0, self.inner.initial(sample, target_in)

    def step(self, state: Any, sample: Any, target_in: float, dt_s: float) -> tuple[Any, float]:
        count, inside = state
        inside, command_psi = self.inner.step(inside, sample, target_in, dt_s)
        sign = 1.0 if count // self.ticks % 2 else -1.0
        return (count + 1, inside), min(max(command_psi + sign * self.size_psi, 0.0), 20.0)


def dithered(name: str, scenario: Scenario, size_psi: float) -> list[Score]:
    """One score per seed."""
    found = []
    for seed in SEEDS:
        law: Any = Dithered(make_controller(name, DESIGN), size_psi)
        trace = run_trial(open_scenario(scenario, seed), law, scenario.targets(TICK_S), TICK_S)
        found.append(score(trace, scenario, true_valve(scenario)))
    return found


def learned(scenario: Scenario, passes: int, gain: float = 0.7) -> list[float]:
    """The worst steady error [% of travel] in every pass of the same holds, each with one pressure, which is moved by
    `gain` times what its last error asks for; the first pass has the design's pressures."""
    targets = np.array([part.end_in for part in scenario.segments])
    closing = np.diff(targets, prepend=0.0) > 0.0
    pressures = np.where(closing, DESIGN.a1, DESIGN.a2) + targets / DESIGN.compliance
    rows, worst = round(scenario.segments[0].duration_s / TICK_S), []
    for number in range(passes):
        stems = _played(scenario, np.repeat(pressures, rows), seed=100 + number).reshape(targets.size, rows)
        error_in = stems[:, -rows // 4 :].mean(axis=1) - targets
        worst.append(100.0 * float(np.abs(error_in).max()) / TRAVEL_IN)
        pressures = pressures - gain * error_in / DESIGN.compliance
    return worst


def _played(scenario: Scenario, commands: FloatArray, seed: int) -> FloatArray:
    opened, stems = open_scenario(scenario, seed), np.empty(commands.size)
    assert opened.truth_in is not None
    for row, command_psi in enumerate(commands):
        opened.bench.exchange(float(command_psi))
        opened.clock.sleep_until((row + 1) * TICK_S)
        stems[row] = opened.truth_in()
    return stems * scenario.reading_gain


def main() -> None:
    print("dither: worst steady error, worst moment [% of travel], air [psi], worst of two seeds")
    for name in ("if_then_pi", "inverse_pi", "brake"):
        for which in ("ladder", "stiction"):
            for size_psi in (0.0, 0.1, 0.3, 1.0):
                found = dithered(name, SCENARIOS[which], size_psi)
                numbers = (max(s.steady for s in found), max(s.peak for s in found), max(s.air_psi for s in found))
                print(f"  {name:11s} {which:9s} {size_psi:3.1f} psi  " + "  ".join(f"{n:7.2f}" for n in numbers))
    print("iterative learning of one pressure per hold: worst steady error [% of travel] by pass")
    for which in ("ep_plus", "lvdt_plus", "deadband_plus", "stiction", "ep_hysteresis", "noise"):
        print(f"  {which:14s} " + "  ".join(f"{e:6.2f}" for e in learned(SCENARIOS[which], 6)))


if __name__ == "__main__":
    main()
