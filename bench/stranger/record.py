"""Runs a valve through a session and keeps what the acquisition reads, as the CSV of a bench user."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bench.stranger.excite import REST_PSI, Pi, Session, targets
from bench.stranger.noise import QUIET, Noise, steps_per_row, wander_psi
from bench.stranger.plant import Plant, clock_s, noise_free, weather_table
from bench.stranger.reader import Reader
from bench.stranger.valve import TARGET_PSI, Daq, Valve

Floats = NDArray[np.float64]


class Rows(NamedTuple):
    """The columns of a record, each of shape (rows,); `target_in` is of a closed loop."""

    time_s: Floats
    command_psi: Floats
    pressure_psi: Floats
    position_in: Floats
    target_in: Floats | None = None

    def part(self, start: int, stop: int) -> Rows:
        """Rows start..stop."""
        return Rows(*(None if column is None else column[start:stop] for column in self))  # type: ignore[arg-type]


def run_open(valve: Valve, session: Session, noise: Noise, seed: list[int]) -> Rows:
    """All rows of an open-loop session, recorded or not."""
    rows = session.commands_psi.size
    steps = steps_per_row(noise, rows, np.random.default_rng([*seed, 10]))
    time_s = clock_s(steps)
    weather = weather_table(valve, time_s)
    weather[:, TARGET_PSI] += wander_psi(noise, rows, np.random.default_rng([*seed, 11]))
    pressure, position = Plant(valve, float(session.commands_psi[0])).rows(session.commands_psi, steps, weather)
    reader = Reader(valve.daq, noise, rows, seed)
    read = [reader.read(k, float(time_s[k]), float(pressure[k]), float(position[k])) for k in range(rows)]
    return Rows(time_s, session.commands_psi, np.array([a for a, _ in read]), np.array([b for _, b in read]))


def run_closed(valve: Valve, noise: Noise, rng: np.random.Generator, seed: list[int]) -> Rows:
    """A closed loop over six targets, from the fully open valve; the command answers the reading of the row before."""
    target = targets(rng)
    steps = steps_per_row(noise, target.size, np.random.default_rng([*seed, 12]))
    time_s = clock_s(steps)
    weather = weather_table(valve, time_s)
    plant, reader, controller = Plant(valve, REST_PSI), Reader(valve.daq, noise, target.size, [*seed, 13]), Pi()
    command = np.empty(target.size)
    pressure, position = np.empty(target.size), np.empty(target.size)
    following = REST_PSI
    for row in range(target.size):
        command[row] = following
        true_psi, true_in = plant.row(following, int(steps[row]), weather[row])
        pressure[row], position[row] = reader.read(row, float(time_s[row]), true_psi, true_in)
        following = controller.command_psi(float(target[row]), float(position[row]))
    return Rows(time_s, command, pressure, position, target)


def noise_free_reading(valve: Valve, session: Session, seed: list[int]) -> Floats:
    """The recorded position readings [in] without noise, with everything that the valve and its acquisition do."""
    if valve.daq == Daq():
        steps = steps_per_row(QUIET, session.commands_psi.size, np.random.default_rng(0))
        return noise_free(valve, session.commands_psi, steps)[1][session.skipped :]
    return run_open(valve, session, QUIET, seed).position_in[session.skipped :]


def write_csv(rows: Rows, path: Path) -> None:
    """Time to 0.1 ms, pressures to 0.1 mpsi, positions to a micro-inch."""
    columns = {name: column for name, column in rows._asdict().items() if column is not None}
    formats = ["%.6f" if name.endswith("_in") else "%.4f" for name in columns]
    header, table = ",".join(columns), np.column_stack(list(columns.values()))
    np.savetxt(path, table, fmt=formats, delimiter=",", header=header, comments="")


def write_open(rows: Rows, session: Session, folder: Path) -> list[Path]:
    """The session as one CSV, or cut into several; the clock runs on from one to the next."""
    bounds = [session.skipped, *session.cuts, rows.time_s.size]
    paths = [folder / f"{chr(65 + k)}.csv" for k in range(len(bounds) - 1)]
    for path, start, stop in zip(paths, bounds[:-1], bounds[1:], strict=True):
        write_csv(rows.part(start, stop), path)
    return paths
