"""A record replays to the last bit on another machine: other kernels of BLAS, of numpy and of the C library."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from app.physics_bench import open_virtual
from control.controller import controller_names, make_controller
from control.design import DesignModel

TICK_S = 0.1
TARGETS = np.repeat([0.1, 0.5, 0.2, 0.23], 60)
REPLAY = """
import json, sys
from control.controller import controller_names, make_controller
from control.design import DesignModel
from hal.sample import Reading, Sample
rows, commands = json.load(sys.stdin), {}
for name in controller_names():
    controller, state = make_controller(name, DesignModel()), None
    commands[name] = []
    for position, pressure, commanded, target in rows:
        seen = Sample(0.0, commanded, Reading(position, 0.0, 0.0), Reading(pressure, 0.0, 0.0))
        state = controller.initial(seen, target) if state is None else state
        state, command = controller.step(state, seen, target, 0.1)
        commands[name].append(command.hex())
json.dump(commands, sys.stdout)
"""
ELSEWHERE = {
    "an old processor": {"OPENBLAS_CORETYPE": "Nehalem"},
    "a newer one": {"OPENBLAS_CORETYPE": "Haswell"},
    "no wide registers": {
        "OPENBLAS_CORETYPE": "Nehalem",
        "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX2 FMA3 AVX512F AVX512_SKX",
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F,-AVX2_Usable,-FMA_Usable",
    },
}


@cache
def record() -> str:
    """Readings and commands of a run with a dead time, as JSON, which keeps every bit."""
    opened, controller = open_virtual(3, effects={"dead_time": 0.15}), make_controller("brake", DesignModel())
    sample, rows = opened.bench.exchange(0.0), []
    state = controller.initial(sample, TARGETS[0])
    for tick, target in enumerate(TARGETS):
        assert sample.pressure is not None
        rows.append((sample.position.value, sample.pressure.value, sample.commanded_psi, float(target)))
        state, command = controller.step(state, sample, float(target), TICK_S)
        opened.clock.sleep_until((tick + 1) * TICK_S)
        sample = opened.bench.exchange(command)
    return json.dumps(rows)


@cache
def replayed(place: str) -> dict[str, list[str]]:
    """The commands of every controller on that record, in a process of its own, as hexadecimal floats."""
    house = str(Path(__file__).resolve().parents[2])
    env = {**os.environ, **ELSEWHERE[place], "PYTHONPATH": house, "PYTHONWARNINGS": "ignore"}
    done = subprocess.run(
        [sys.executable, "-c", REPLAY], input=record(), env=env, capture_output=True, text=True, check=True
    )
    found: dict[str, list[str]] = json.loads(done.stdout)
    return found


def test_the_kernels_differ_at_all() -> None:
    """What the other test relies on: where numpy has OpenBLAS, a dot product of the two processors differs."""
    blas = np.show_config(mode="dicts")["Build Dependencies"]["blas"]["name"]
    if "openblas" not in blas or platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip(f"numpy was built with {blas} for {platform.machine()}, whose kernels go by other names")
    code = "import numpy as np; a = np.sin(np.arange(999.0)); print([float(a[i:] @ a[i:]).hex() for i in range(99)])"
    sums = {
        subprocess.run(
            [sys.executable, "-c", code], env={**os.environ, **ELSEWHERE[p]}, capture_output=True, text=True, check=True
        ).stdout
        for p in ("an old processor", "a newer one")
    }
    assert len(sums) == 2


@pytest.mark.parametrize("place", ["a newer one", "no wide registers"])
@pytest.mark.parametrize("name", controller_names())
def test_a_record_replays_on_another_machine(name: str, place: str) -> None:
    here, there = replayed("an old processor")[name], replayed(place)[name]
    assert len(set(here)) > 1  # it did something
    assert here == there
