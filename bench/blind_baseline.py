"""The model of the healthy reference valve that its blind trials are held against: `python bench/blind_baseline.py`.

It plays the test sequence to a healthy valve, and holds it at positions in closed loop, fits the design's numbers stage
by stage with what these records show (a booster behind the converter's pilot; friction in motion that grows as the stem
slows down; curves that are not quite parallel; a filtered reading), writes `app/blind/baselines/reference.toml`, and
measures what this model leaves on seeds that it has not seen: "nothing is wrong" in a blind trial means nothing beyond
that margin (`reference_margin.toml`). Run it anew whenever the physics of the reference plant change.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.blind.designs import FOLDER
from app.blind.excite import closed_loop, commands, open_loop
from app.blind.trial import CONTROLLER
from app.job import Job, perform
from app.session import open_bench
from control.controller import make_controller
from control.design import DesignModel, save_design
from control.drive import ControllerDrive
from control.identify import identify
from logs.load import load_recording
from logs.recording import FloatArray, Recording
from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record
from twin.choose.stages import combined, driven_about
from twin.fit.case import Case, make_case
from twin.fit.channel import Channel, position_channel, pressure_channel
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.plant import effect_tables
from twin.replay.simulate import simulate_recording

FAMILY = "reference"
SEED, FRESH = 101, (102, 103, 104)
#: How often design and friction are fitted in turn about the other, and how far numbers may move each time.
ROUNDS, DOUBT = 3, 0.1
#: What the valve behind the converter shows, by the position.
STEM = (
    ("friction_in_motion", "elastic"),
    ("stiction", "falling_with_speed"),
    ("spring_asymmetry", "at_stem"),
    ("sensor_lag", "first_order"),
)
COMMENT = "The healthy reference valve: booster, friction, springs, reading; by bench/blind_baseline.py."
MARGIN = """# RMS by which the healthy reference valve departs from reference.toml, on seeds that the fit has not seen
# and without noise; made by bench/blind_baseline.py. A blind trial finds "no gap" when nothing stands out beyond this.
pressure_psi = {pressure}
position_in = {position}
"""


def healthy(seed: int, noise: float = 1.0) -> Recording:
    """A healthy valve through the test sequence."""
    time_s, command = commands(open_loop(seed))
    pressure, position = record(make_physics(FAMILY, seed, noise=noise), time_s, command)
    return Recording(f"healthy, seed {seed}", time_s, command, position, pressure)


def held(design: DesignModel, seed: int, noise: float = 1.0) -> Recording:
    """A healthy valve in closed loop over the wire, as the record that no diagnosis sees."""
    plan, made = closed_loop(seed), make_controller(CONTROLLER, design)
    job = Job("run", plan, lambda begun: ControllerDrive(made, plan.period_s, begun), closed_loop=True)
    with tempfile.TemporaryDirectory() as out, open_bench(physics=FAMILY, seed=seed, options={"noise": noise}) as bench:
        return load_recording(perform(bench, job, out=Path(out) / "held", live=False, title="healthy").folder)


def fitted(swept: Recording) -> DesignModel:
    """Identified, then refined: the converter and its booster by the pressure, the valve behind it by the position."""
    design = identify([swept]).design
    recordings = [swept, held(design, SEED)]
    booster, behind = _cause("ep_rate_limit", "orifices"), [_cause(*one) for one in STEM]
    for _ in range(ROUNDS):
        case = make_case(recordings, design, ())
        assert case.sigma_p is not None
        found = _fit(case, pressure_channel(case.trials, case.sigma_p), (booster,))
        stem = _fit(case, position_channel(driven_about(found.plant, case), case.sigma_y), behind)
        plant = combined(case.base, [found, stem])
        design = plant.design
    return replace(design, effects=effect_tables(plant.inserted))


def _cause(name: str, form: str) -> Cause:
    one = effect(name)
    return Cause(name, one, one.form(form))


def _fit(case: Case, channel: Channel, causes: Sequence[Cause]) -> Fit:
    space = make_space(case.base, causes, channel.numbers, case.scales, DOUBT)
    return fit(channel, space, starts_of(space), rounds=60, refine=6)


def left(design: DesignModel, recording: Recording) -> FloatArray:
    """RMS of the noise-free pressure [psi] and position [in] that the model misses, after the first seconds."""
    assert recording.pressure is not None
    pressure, position = simulate_recording(design, recording)
    errors = np.stack([recording.pressure - pressure, recording.position - position])
    missed: FloatArray = np.sqrt(np.mean(errors[:, 50:] ** 2, axis=1))
    return missed


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args()
    design = fitted(healthy(SEED))
    misses = np.array([left(design, healthy(seed, noise=0.0)) for seed in FRESH])
    pressure, position = np.sqrt(np.mean(misses**2, axis=0))
    print("missed on fresh seeds [psi, in]:", misses.round(5).tolist())
    closed = [left(design, held(design, seed, noise=0.0)).round(5).tolist() for seed in FRESH]
    print("and in closed loop:", closed)
    FOLDER.mkdir(exist_ok=True)
    save_design(design, FOLDER / f"{FAMILY}.toml", COMMENT)
    text = MARGIN.format(pressure=float(f"{pressure:.3g}"), position=float(f"{position:.3g}"))
    (FOLDER / f"{FAMILY}_margin.toml").write_text(text, encoding="utf-8")
    print((FOLDER / f"{FAMILY}.toml").read_text(encoding="utf-8"), text, sep="\n")


if __name__ == "__main__":
    main()
