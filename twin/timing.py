"""Which interval a row's command belongs to, where the file does not say.

A shift of up to one row is a nuisance: the pressure (or else the position) decides between "in force before the row"
and "in force after it". Source: interfaces page, recorded runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from logs.recording import DataNote, Recording
from twin.fit.channel import chain_channel, pressure_channel
from twin.fit.trial import make_trial
from twin.noise.model import NoiseModel
from twin.plant import Plant


def settled_timing(
    recordings: Sequence[Recording], plant: Plant, noise: NoiseModel
) -> tuple[list[Recording], list[DataNote]]:
    """The recordings with timing "before", shifted by one row where that fits clearly better, and a note on it."""
    settled, notes = [], []
    for recording in recordings:
        if recording.command_timing != "unknown":
            settled.append(recording)
            continue
        shifted = replace(recording, command=np.concatenate([recording.command[:1], recording.command[:-1]]))
        better = min((recording, shifted), key=lambda r: _misfit(r, plant, noise))
        how = "after its row" if better is shifted else "before its row"
        notes.append(
            DataNote(f"{recording.name}: command timing unknown", f"read as in force {how}, which fits better")
        )
        settled.append(replace(better, command_timing="before"))
    return settled, notes


def _misfit(recording: Recording, plant: Plant, noise: NoiseModel) -> float:
    trial = make_trial(recording, 0.1)
    use_pressure = recording.pressure is not None and noise.pressure is not None
    channel = pressure_channel([trial], 1.0) if use_pressure else chain_channel([trial], 1.0)
    residuals = channel.residuals(plant)
    return float(residuals @ residuals)
