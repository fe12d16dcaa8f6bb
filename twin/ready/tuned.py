"""A design made to fit records as well as its own numbers can, for when the records are all that is known of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from control.design import DesignModel
from control.identify_stops import travel_between_stops
from logs.recording import Recording
from twin.choose.stages import driven_about
from twin.fit.case import Case, make_case
from twin.fit.channel import chain_channel, position_channel, pressure_channel
from twin.fit.fitting import Fit
from twin.fit.retuning import retuned
from twin.noise.model import estimate_noise
from twin.ready.thin import look_at
from twin.record.pieces import cut_at_holes
from twin.record.sensing import sense


def retuned_fit(case: Case) -> Fit:
    """Only the design's own numbers, fitted to the whole chain."""
    return retuned(chain_channel(case.trials, case.sigma_y), case.base, case.scales)


def tuned_to(recordings: Sequence[Recording], design: DesignModel) -> DesignModel:
    """`design`, in the recordings' units, with all its numbers fitted to them.

    What is identified stage by stage leaves the lag of a converter whose pressure nobody measured at its default; held
    against such a design, the default itself would be found at fault. Where the pressure was measured each stage gets
    its numbers from its own signal, so that a fault of the valve does not bend the converter's; and where the record
    rests at both stops they give the travel.
    """
    pieces, _ = cut_at_holes(recordings)
    noise = estimate_noise(pieces)
    design = replace(design, travel=travel_between_stops(pieces, design) or design.travel)
    sensing = sense(pieces, noise, design)
    look, _ = look_at(make_case(pieces, design, (), sensing.bad_rows, noise, sensing.coarseness))
    if look.sigma_p is None:
        return retuned_fit(look).plant.design
    first = retuned(pressure_channel(look.trials, look.sigma_p), look.base, look.scales)
    channel = position_channel(driven_about(first.plant, look), look.sigma_y)
    return retuned(channel, first.plant, look.scales).plant.design
