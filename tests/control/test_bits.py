"""A record replays to the last bit on another machine: controllers use nothing that depends on it.

And as far as one machine can show it: with other kernels of BLAS, of numpy and of the C library.
"""

from __future__ import annotations

import ast
import json
import os
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


# IEEE 754 defines these to the last bit, or they only choose and copy; `math.fsum` is rounded correctly.
EXACT = {"isfinite", "copysign", "fsum", "sqrt", "inf", "ceil", "float64", "array", "abs", "concatenate", "clip"} | {
    "argmin", "full", "where", "empty_like", "maximum", "minimum"
}  # fmt: skip
# The order of the terms is the library's affair; and `sum` compensates from Python 3.12 on.
SUMS = {"sum", "mean", "std", "var", "dot", "prod", "cumsum", "pow"}
# One mean is left: numpy's pairwise sum has a fixed order, the same on every processor with the same numpy.
KNOWN = {"control.controllers.mpc": ["miss.mean"]}


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


@cache
def sources() -> dict[str, ast.Module]:
    """The modules of `control` that a controller is made of: its own, and all that they import."""
    house, found = Path(__file__).resolve().parents[2], dict[str, ast.Module]()
    wanted = ["control.controller", *(f"control.controllers.{name}" for name in controller_names())]
    while wanted:
        name = wanted.pop()
        if name not in found:
            found[name] = ast.parse((house / name.replace(".", "/")).with_suffix(".py").read_text(encoding="utf-8"))
            imports = [node.module or "" for node in ast.walk(found[name]) if isinstance(node, ast.ImportFrom)]
            wanted += [module for module in imports if module.startswith("control.")]
    return found


def depends(node: ast.AST) -> str:
    """What of it differs from machine to machine, or from Python to Python, in the last bit; empty for nothing."""
    if isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.Pow | ast.MatMult):
        return ast.unparse(node)
    if isinstance(node, ast.ImportFrom) and node.module in ("math", "numpy", "scipy"):
        return ast.unparse(node)
    if isinstance(node, ast.Attribute):
        library = ast.unparse(node.value) in ("math", "np", "numpy")
        return ast.unparse(node) if (library and node.attr not in EXACT) or node.attr in SUMS else ""
    return node.id if isinstance(node, ast.Name) and node.id in ("sum", "pow") else ""


@pytest.mark.parametrize("name", sorted(sources()))
def test_a_controller_is_made_of_what_has_the_same_bits_everywhere(name: str) -> None:
    """No processor of ours can show all others; but what is rounded correctly by definition needs none."""
    assert [found for node in ast.walk(sources()[name]) if (found := depends(node))] == KNOWN.get(name, [])


@pytest.mark.parametrize(
    "code", ["x**2", "a @ b", "math.exp(x)", "np.exp(x)", "sum(xs)", "a.sum()", "np.linalg.inv(a)"]
)
def test_what_differs_is_seen(code: str) -> None:
    assert any(depends(node) for node in ast.walk(ast.parse(code)))


@pytest.mark.parametrize("place", ["a newer one", "no wide registers"])
@pytest.mark.parametrize("name", controller_names())
def test_a_record_replays_on_another_machine(name: str, place: str) -> None:
    here, there = replayed("an old processor")[name], replayed(place)[name]
    assert len(set(here)) > 1  # it did something
    assert here == there
