"""Flow loops of a refinery: `github.com/TerenceXue-tech/StictionGPT`, folder `plant_data` (Apache-2.0).

The third line names the columns, the fourth and fifth are no samples. What a valve without friction would do is the
straight line through the steady states of all files of its loop. No file says what 100 % of a flow is: guessed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.public.recording import Recording, columns, servo, units

FOLDER = "StictionGPT"

#: Flow at 100 %, of the loops whose flow follows the output: guessed.
_FULL = {
    "2411FIC20102": 150.0,
    "2111FIC10201": 80.0,
    "2111FIC40102B": 150.0,
    "2111FIC40102C": 150.0,
    "2111FIC40102E": 150.0,
    "2111FIC45102C": 100.0,
    "2111FIC46002": 120.0,
    "2411FIC90204": 40.0,
    "FIC11502": 25.0,
    "FIC60101": 5.0,
}
_WORDS = {"stiction_data": "called sticking", "non-stiction_data": "called healthy"}
_SAME = 0.9  # of its readings, in those before it: the same hours; what overlaps only in part shares 0.76 at the most
_MEAN = 50  # rows: a stretch that long is a steady state


def recordings(clone: Path, work: Path) -> Iterator[Recording]:
    """Every stretch of every loop once, the loops in the order of `_FULL`."""
    for loop, full in _FULL.items():
        files = [(path, _lines(path)) for path in sorted(clone.glob(f"plant_data/*/stic_*{loop}*.txt"))]
        if not files:
            continue
        gain, onset = _line([_readings(lines, full) for _, lines in files])
        design = servo(work / f"{loop}.toml", 1.0, 5.0, gain=gain, onset=onset)
        for path, lines in _distinct(files):
            file = work / f"{path.stem.replace('=', '_').replace('#', '_')}.txt"
            file.write_text("\n".join([lines[2], *lines[5:]]) + "\n", encoding="utf-8")
            scale = f"flow(0..{full:g}=0..100 percent)"
            words = (
                *columns(time="1", command="2", position="3", target="4"),
                *units(command="percent", position=scale, target=scale),
                *("--command-timing", "unknown"),
            )
            yield Recording(f"{loop}, {_WORDS[path.parent.name]}", _stretch(path), "", file, (*words, *design))


def _lines(path: Path) -> list[str]:
    return path.read_text(encoding="utf-8", errors="replace").splitlines()


def _distinct(files: list[tuple[Path, list[str]]]) -> Iterator[tuple[Path, list[str]]]:
    """The files that hold other hours than those before them: some hours are there under two names, minutes apart."""
    seen: set[str] = set()
    for path, lines in files:
        readings = {"\t".join(line.split("\t")[1:3]) for line in lines[5:]}
        if len(readings & seen) < _SAME * len(readings):
            yield path, lines
        seen |= readings


def _stretch(path: Path) -> str:
    """Day and hour of the file's name: `stic_2411FIC20102_0609_0957_Stick1=0.89278` was stored at 09:57 on 9 June."""
    found = re.search(r"_(\d{4,8})_(\d{4})_Stick", path.name)
    assert found is not None, path.name
    day = found[1][-4:]
    return f"{day[:2]}-{day[2:]} {found[2][:2]}:{found[2][2:]}"


def _readings(lines: list[str], full: float) -> NDArray[np.float64]:
    """`[rows, 2]` output and flow [percent]."""
    rows = [line.split("\t")[1:3] for line in lines[5:]]
    return np.array([row for row in rows if all(row)], dtype=float) * [1.0, 100.0 / full]


def _line(stretches: list[NDArray[np.float64]]) -> tuple[float, float]:
    """Slope and onset of the principal axis of all steady states."""
    steady = [rows[: len(rows) // _MEAN * _MEAN].reshape(-1, _MEAN, 2).mean(axis=1) for rows in stretches]
    output, flow = np.concatenate(steady).T
    axis = np.linalg.eigh(np.cov(output, flow))[1][:, 1]
    gain = axis[1] / axis[0]
    return float(gain), float(output.mean() - flow.mean() / gain)
