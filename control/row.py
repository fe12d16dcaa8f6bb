"""One tick as a row of the record: which columns there are, in which units, and what goes into them.

Row k holds the readings of tick k, the command in force over the interval that ends with them, and the command that
goes out with them (docs/architecture.md, "Time and commands in a record").
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from hal.bench import BenchInfo
from hal.sample import Quality, Reading, Sample

NAN = math.nan


def columns_of(info: BenchInfo, *, closed_loop: bool, aux_units: Mapping[str, str]) -> dict[str, str]:
    """The columns of a record made on this bench and their units. Commands in percent are named so."""
    unit = info.command_unit
    columns = {"time_s": "s", f"command_{unit}": unit}
    if info.has_pressure:
        columns["pressure_psi"] = "psi"
    columns["position_in"] = "in"
    if closed_loop:
        columns["target_in"] = "in"
    columns |= {f"next_command_{unit}": unit, "lateness_s": "s", "latency_s": "s", "quality": ""}
    if info.has_pressure:
        columns["pressure_quality"] = ""
    columns |= {"sequence": "", "step": ""}
    return columns | {name: aux for name, aux in aux_units.items() if name not in columns}


def row_of(
    sample: Sample,
    *,
    unit: str,
    origin_s: float,
    in_force: float,
    lateness_s: float,
    step: int,
    target_in: float,
    aux: Sequence[str] = (),
) -> dict[str, float]:
    """The row of one sample; `in_force` is the command that held until now. Columns that do not apply are left out."""
    position = sample.position
    row = {
        "time_s": sample.time_s - origin_s,
        f"command_{unit}": in_force,
        "position_in": position.value,
        f"next_command_{unit}": sample.commanded_psi,
        "lateness_s": lateness_s,
        "latency_s": position.latency_s,
        "quality": float(position.quality),
        "step": float(step),
    }
    if sample.pressure is not None:
        row["pressure_psi"] = sample.pressure.value
        row["pressure_quality"] = float(sample.pressure.quality)
    if sample.sequence is not None:
        row["sequence"] = float(sample.sequence)
    if not math.isnan(target_in):
        row["target_in"] = target_in
    for name in aux:
        if name in sample.aux:
            row[name] = sample.aux[name].value
    return row


def missing_sample(time_s: float, commanded: float, *, has_pressure: bool) -> Sample:
    """What a tick without a trusted reply leaves: the time, the command that was sent, and nothing read."""
    nothing = Reading(NAN, time_s, 0.0, Quality.MISSING)
    return Sample(time_s, commanded, nothing, nothing if has_pressure else None)
