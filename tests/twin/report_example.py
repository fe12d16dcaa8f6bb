"""A diagnosis and its series for the tests of report and rrd: a wider deadband and stick-slip in a toy valve."""

from __future__ import annotations

import numpy as np

from logs.recording import DataNote
from tests.twin.toy_valve import TRAVEL, Toy, staircase
from twin.diagnosis import (
    Cause,
    Diagnosis,
    EffectTest,
    Estimate,
    NextExperiment,
    Ranked,
    Share,
    Where,
)
from twin.noise.model import SignalNoise
from twin.report.series import Series
from twin.where.closure import gap
from twin.where.isolability import describe
from twin.where.map import WherePiece, where_map

DT = 0.1
SIGMA = 8e-4


def series(rows_per_level: int = 200) -> Series:
    """Two recordings of one toy; the second is held out."""
    levels = [5.0, 9.5, 11.0, 9.0, 7.0, 5.5, 10.5, 4.0, 13.0, 8.0, 9.6, 8.8, 10.2, 7.4, 6.0]
    steps = staircase(DT, rows_per_level * DT, levels)
    ramp = np.interp(np.arange(steps.size), [0, steps.size // 2, steps.size], [4.5, 12.5, 4.5])
    truth, retuned, design = Toy(a1=9.4, breakaway=0.35), Toy(a1=9.6), Toy()
    parts: list[dict[str, np.ndarray]] = []
    for seed, command in enumerate((steps, ramp)):
        rng = np.random.default_rng(seed)
        true_pressure = truth.pressure(command, DT)
        parts.append(
            {
                "time_s": np.arange(command.size) * DT,
                "command": command,
                "pressure": true_pressure + 0.02 * rng.standard_normal(command.size),
                "position": truth.position(true_pressure, DT) + SIGMA * rng.standard_normal(command.size),
                "before": design.position(design.pressure(command, DT), DT),
                "retuned": retuned.position(retuned.pressure(command, DT), DT),
                "after": truth.position(true_pressure, DT),
            }
        )
    joined = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    record = np.repeat(np.arange(2), steps.size)
    return Series(
        **joined, heldout=record == 1, travel=TRAVEL, record=record, names=("run 0041 staircase", "run 0042 ramp")
    )


def diagnosis(shown: Series) -> Diagnosis:
    """A verdict on the example with every part filled in; the map and the gap are really computed."""
    noise = SignalNoise(SIGMA, 1.0, "repeats", shown.time_s.size, DT, (), SIGMA)
    assert shown.pressure is not None
    assert shown.retuned is not None
    pieces = []
    for number in (0, 1):
        rows = shown.record == number
        from_pressure = Toy().position(shown.pressure[rows], DT)
        columns = (shown.time_s, shown.position, shown.before, shown.pressure)
        pieces.append(WherePiece(*(column[rows] for column in columns), from_pressure))
    held = shown.heldout
    residuals = [(shown.position - model)[held] for model in (shown.before, shown.retuned, shown.after)]
    where = where_map(pieces, noise, TRAVEL)
    return Diagnosis(
        verdict="effects",
        statement="The stem sticks: it needs 0.35 psi more to break away than to slide, and the deadband is 0.62 psi "
        "wider than the design says. With both, the model predicts held-out data to within the noise.",
        causes=(
            Cause("stiction", "actuator", 0.96, 3.4, {"breakaway": Estimate(0.35, (0.33, 0.37), "psi")}, "one_jump"),
            Cause("parameter:deadband", "actuator", 0.91, 4.1, {"deadband": Estimate(3.58, (3.55, 3.61), "psi")}),
        ),
        ranking=(
            Ranked("stiction", 0.96, 0.15),
            Ranked("parameter:deadband", 0.91, 0.15),
            Ranked("distributed_hysteresis", 0.06, 0.31),
            Ranked("position_dependent_friction", 0.02, 0.42),
            Ranked("nonlinear_spring", 0.008, 1.9),
            Ranked("lvdt_nonlinearity", 0.004, 1.9),
        ),
        gap=gap(*residuals, SIGMA, TRAVEL),
        where=Where(
            where.stage,
            {
                "ep": Share(-0.02, (-0.04, 0.0)),
                "actuator": Share(0.99, (0.97, 1.0)),
                "sensor": Share(0.03, (0.0, 0.06)),
            },
            where.direction,
            where.regime,
            where.position,
            where.pressure,
            where.time,
            where.frequency,
        ),
        confusable=(("stiction", "distributed_hysteresis"),),
        next_experiment=NextExperiment(
            "A slow ramp with nested reversals separates stiction from distributed hysteresis in 6 minutes.",
            "next.toml",
        ),
        data_quality=(DataNote("duplicate time in run 0041", "second reading left out", 1, 1702),),
        effects_tested=(
            EffectTest("dead_time", True, "", "delay", 0.011, "s"),
            EffectTest("supply_saturation", False, "the command never came near the supply pressure"),
        ),
        structure=tuple(describe(frozenset({"pressure"}))),
        noise={"position": {"sigma": SIGMA, "unit": "in", "source": "repeats", "correlation_samples": 1.0}},
        closed_loop={"limit cycle": {"predicted": 0.8, "recorded": 0.9}},
        version="0.1.0",
    )
