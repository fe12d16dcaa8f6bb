"""From dial-gauge readings to the calibration of the LVDT: what the signal was, where the stem really stood."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Literal

from pydantic import ValidationError

from hal.calibration import Calibration
from hal.errors import BadInput
from hal.profile import load_profile
from hal.toml_file import toml_text

Pair = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Fit:
    """A calibration, and how far each reading lies from it [in]."""

    calibration: Calibration
    pairs: tuple[Pair, ...]
    residuals_in: tuple[float, ...]

    @property
    def worst_in(self) -> float:
        return max(abs(r) for r in self.residuals_in)

    @property
    def rms_in(self) -> float:
        return math.sqrt(sum(r * r for r in self.residuals_in) / len(self.residuals_in))


def read_pairs(path: Path) -> list[Pair]:
    """A CSV with the columns `signal` and `position_in`. Raises: `BadInput` naming the row."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = csv.DictReader(file)
            names = rows.fieldnames or []
            for name in ("signal", "position_in"):
                if name not in names:
                    raise BadInput(f"{path} has no column '{name}' (it has: {', '.join(names) or 'none'})")
            return [_pair(path, number, row) for number, row in enumerate(rows, start=2)]
    except OSError as error:
        raise BadInput(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise BadInput(f"{path} is not a text file") from error


def _pair(path: Path, row: int, values: dict[str, str | None]) -> Pair:
    numbers = []
    for name in ("signal", "position_in"):
        try:
            number = float(values[name] or "")
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise BadInput(f"{path}, row {row}: {name} is '{values[name]}', which is not a number")
        numbers.append(number)
    return numbers[0], numbers[1]


def fit(
    pairs: Sequence[Pair],
    kind: Literal["two-point", "table"],
    *,
    name: str,
    made: date,
    expires: date | None = None,
    instrument: str = "dial gauge",
) -> Fit:
    """The best straight line (`two-point`), or a table through the means of the readings at each gauge position.

    A table takes out the LVDT's non-linearity; readings at one position, from both directions say, are averaged.
    Raises: `BadInput` for too few readings or a table that turns back.
    """
    places = sorted({position for _, position in pairs})
    if len(places) < 2:
        raise BadInput(f"a calibration needs readings at two positions or more, there is {len(places)}")
    points = _line(pairs, places) if kind == "two-point" else _means(pairs, places)
    try:
        found = Calibration(id=name, made=made, expires=expires, instrument=instrument, points=tuple(points))
    except ValidationError as error:
        why = error.errors()[0]["msg"].removeprefix("Value error, ")
        raise BadInput(f"these readings make no calibration: {why}") from error
    residuals = tuple(found.to_in(signal) - position for signal, position in pairs)
    return Fit(found, tuple(pairs), residuals)


def _means(pairs: Sequence[Pair], places: Sequence[float]) -> list[Pair]:
    groups = [[signal for signal, position in pairs if position == place] for place in places]
    return [(sum(group) / len(group), place) for group, place in zip(groups, places, strict=True)]


def _line(pairs: Sequence[Pair], places: Sequence[float]) -> list[Pair]:
    """The least-squares line, given by its points at the outermost gauge positions (the gauge is the exact side)."""
    n = len(pairs)
    mean_x, mean_y = sum(p for _, p in pairs) / n, sum(s for s, _ in pairs) / n
    spread = sum((p - mean_x) ** 2 for _, p in pairs)
    slope = sum((p - mean_x) * (s - mean_y) for s, p in pairs) / spread
    return [(mean_y + slope * (place - mean_x), place) for place in (places[0], places[-1])]


def check_new(target: Path) -> None:
    """Raises: `BadInput` when `target` exists already."""
    if target.exists():
        raise BadInput(f"{target} exists already; choose another name, calibrations are kept")


def write_profile(source: Path, target: Path, calibration: Calibration) -> None:
    """A copy of a profile with another calibration; comments and order stay as they are.

    Raises: `BadInput` when `target` exists already or the result would be no valid profile.
    """
    import tomlkit

    check_new(target)
    document = tomlkit.parse(toml_text(source))
    table = tomlkit.table()
    for key, value in calibration.model_dump(exclude_none=True).items():
        table[key] = [[round(s, 6), round(p, 6)] for s, p in value] if key == "points" else value
    document["calibration"] = table
    target.write_text(tomlkit.dumps(document), encoding="utf-8")
    load_profile(target)
