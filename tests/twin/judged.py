"""Records of a plant with noise, searched and judged without held-out data."""

from __future__ import annotations

import numpy as np

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.choose.rules import DecisionRules
from twin.choose.stages import StageResult, judge
from twin.choose.weigh import Weights
from twin.diagnose import Settings
from twin.fit.case import make_case
from twin.judge.verdict import Judgement, pronounce
from twin.model.insert import inserted_from
from twin.model.plant import Plant
from twin.record.sensing import sense
from twin.replay.simulate import simulate_recording
from twin.search.search_rules import SearchRules

#: A diagnosis that stops at two causes, which takes a third of the time where nothing explains all.
UP_TO_TWO = Settings(search=SearchRules(most=2))
_NOISE_IN, _NOISE_PSI = 0.0004, 0.008


def _command(n: int) -> FloatArray:
    """Random steps over both curves, held long enough to settle now and then, with slow steps between."""
    dice = np.random.default_rng(5)
    levels: list[FloatArray] = []
    while sum(part.size for part in levels) < n:
        levels.append(np.full(int(dice.integers(15, 90)), dice.uniform(4.5, 12.8)))
    return np.concatenate(levels)[:n]


def a_record(plant: Plant, seed: int = 1, twice: bool = False, n: int = 1500) -> Recording:
    """`n` noisy readings, 0.2 s apart: five minutes; `twice`: the second half has the commands of the first."""
    period_s = 0.2
    blank = np.zeros(n)
    command = np.tile(_command(n // 2), 2) if twice else _command(n)
    record = Recording("valve", np.arange(n) * period_s, command, blank, np.full(n, 4.0))
    pressure, position = simulate_recording(plant, record)
    dice = np.random.default_rng(seed)
    pressure = pressure + dice.normal(0.0, _NOISE_PSI, n)
    position = position + dice.normal(0.0, _NOISE_IN, n)
    return Recording("valve", record.time_s, record.command, position, pressure)


def judged(record: Recording, design: DesignModel | None = None) -> tuple[StageResult, Judgement]:
    design = design or DesignModel()
    case = make_case([record], design, inserted_from(design))
    sensing = sense([record], case.noise, design)
    result = judge(case, SearchRules(most=2), DecisionRules(), lambda _what, _share: None)
    return result, pronounce(result, sensing, 0.0, Weights())
