"""Machines of other kinds: a valve with its positioner, servos, electric cylinders, a fatigue rig.

Sources, each a folder of clones of the same name: `dlaredo/ValveActuator-DAMADICS-` (an hour of a boiler's valve),
`roboninecom/Measuring-Backlash-in-Popular-UART-Servos`, `nicolazande/camber-control`, and
`decargroup/system_norm_koopman` (Fortune, Beltempo, Forbes, IFAC-PapersOnLine 52 (2019) 382).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.io import loadmat

from bench.public.recording import Recording, columns, servo, units

_UNKNOWN = ("--command-timing", "unknown")


def damadics(clone: Path, work: Path) -> Iterator[Recording]:
    """An hour of the boiler's water valve LC74_20 at 1 Hz: control value and rod are the sixth and seventh row."""
    table = loadmat(clone / "DABLib" / "OneHourTestData_ExampleII.mat")["OneHourTestData_ExampleII"]
    file = work / "damadics.csv"
    np.savetxt(file, table[[0, 5, 6]].T, delimiter=",", header="time_s,control,rod", comments="")
    words = (*columns(time="time_s", command="control", position="rod"), *units(command="percent", position="percent"))
    design = servo(work / "damadics.toml", 0.1, 2.0)
    yield Recording("DAMADICS", "one hour", "positioner", file, (*words, *_UNKNOWN, *design))


def servos(clone: Path, _work: Path) -> Iterator[Recording]:
    """A servo is commanded while two others pull its lever about within its backlash."""
    motors = {"single": 5, "nocomp2": 1, "comp2": 1, "single_3250": 4, "pgain_zero_db": 1}
    counts = "counts(1847..2247=0..100 percent)"
    for name, motor in motors.items():
        file = clone / "logs" / f"motor_telemetry_{name}.csv"
        words = (
            *columns(time="timestamp", command=f"target pos ({motor})", position=f"pos ({motor})"),
            *units(command=counts, position=counts),
        )
        yield Recording("bus servo", name, "step 0.25 %", file, (*words, *_UNKNOWN))


def cylinders(clone: Path, work: Path) -> Iterator[Recording]:
    """Electric cylinders; positions are written to 0.01 mm."""
    files = {
        "LinA": ("no-load-square-wave-full-travel-0.5Hz", -3.78, 3.38),
        "EccA": ("load-square-wave-full-travel-0.5Hz", -59.0, 80.6),
    }
    design = servo(work / "cylinder.toml", 0.005, 0.02, rate_per_s=1000.0)
    for name, (stem, low_mm, high_mm) in files.items():
        scale = f"mm({low_mm}..{high_mm}=0..100 percent)"
        words = (
            *columns(time="1", command="3", position="4"),
            *units(time="ms", command=scale, position=scale),
        )
        known = f"step {0.01 / (high_mm - low_mm):.2%}"
        file = clone / "actuators" / name / "data" / f"{stem}.txt"
        yield Recording("electric cylinder", name, known, file, (*words, *_UNKNOWN, *design))


def rig(clone: Path, _work: Path) -> Iterator[Recording]:
    """A beam under one actuator: force reference, measured force, displacement."""
    force = "fraction(-1..1=0..100 percent)"
    words = (
        *columns(time="t", command="r", pressure="y", position="d"),
        *units(time="s", command=force, pressure=force, position="mm(-5.1..4.9=0..100 percent)"),
    )
    file = clone / "datasets" / "faster" / "faster.csv"
    yield Recording("fatigue rig", "faster", "repeats readings", file, (*words, *_UNKNOWN))
