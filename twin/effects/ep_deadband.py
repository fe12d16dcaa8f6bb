"""The converter ignores command changes inside a band: pilot overlap, or a small hysteresis of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from logs.recording import Recording
from twin.kernels.ep_slots import EP_BAND, EP_BAND_MODE, EP_CHAMBER, EP_LEAK, EP_SHUT, EP_ZERO
from twin.model.coefficients import Coefficients
from twin.model.effect import Apply, Effect, Form, Parameter, Scales
from twin.model.held_band import likely_bands

#: What is accepted depends on all that was accepted before: a band that is off by half a percent soon loses step.
_LOOKS = 400
#: Bands that a fit starts from where a pressure was measured.
_TRIED = 8
_STARTS = (0.015, 0.05, 0.15, 0.4)


def _band(doc: str, smooth: bool) -> tuple[Parameter]:
    return (
        Parameter(
            name="band",
            kind="pressure",
            lower=0.0,
            upper=1.5,
            starts=_STARTS,
            scale=0.15,
            doc=doc,
            smooth=smooth,
            looks=_LOOKS,
        ),
    )


def _held(records: Sequence[Recording], scales: Scales) -> list[tuple[float, ...]]:
    """Bands by which the recorded pressure follows the command best; as the parameter says where none was recorded."""
    best = likely_bands(records, _TRIED)
    return [*((band,) for _, band in best), *((start * scales.pressure,) for start in _STARTS)] if best else []


def _mode(mode: float) -> Apply:
    def apply(c: Coefficients, values: Sequence[float]) -> None:
        c.ep[EP_BAND] = values[0]
        c.ep[EP_BAND_MODE] = mode if values[0] > 0.0 else 0.0

    return apply


def _leaks(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_BAND, EP_LEAK]] = values
    c.ep[EP_BAND_MODE] = 3.0 if values[0] > 0.0 else 0.0


def _shut(c: Coefficients, values: Sequence[float]) -> None:
    _mode(3.0)(c, values)
    c.ep[EP_CHAMBER] = 1.0 + values[1] if values[0] > 0.0 else 0.0


def _one_side(c: Coefficients, values: Sequence[float]) -> None:
    # A port that is overlapped alone: half the band to each side of what is aimed at, which lies half of it beside.
    _mode(3.0)(c, (0.5 * abs(values[0]),))
    c.ep[EP_ZERO] -= 0.5 * values[0]


def _gated(c: Coefficients, values: Sequence[float]) -> None:
    _mode(5.0)(c, values)
    c.ep[EP_SHUT] = values[1]


_ONE_SIDE = Parameter(
    name="band",
    kind="pressure",
    lower=-1.5,
    upper=1.5,
    starts=(-0.3, -0.08, 0.08, 0.3),
    scale=0.15,
    doc="pressure error at which the port that fills begins to open; below 0 the one that exhausts, the other at once",
)
#: In which step it opens depends on the band, but not on all that came before: a pilot that has shut has forgotten.
_LATCH = replace(_band("pressure error at which the pilot opens in full", False)[0], looks=100)
_SHUTS = Parameter(
    name="shuts",
    kind="fraction",
    lower=0.02,
    upper=0.95,
    starts=(0.25, 0.6),
    scale=0.3,
    doc="error at which it shuts again, as a share of that",
    neutral=0.5,
    size=False,
)
_LEAK = Parameter(
    name="leak",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.02, 0.15),
    scale=0.1,
    doc="flow for each unit of the error inside the band, as a share of that outside",
    size=False,
)

#: Behind a shut booster it is the stem alone that moves the pressure. One that always opened never showed by how much.
_ROOM = Parameter(
    name="room",
    kind="fraction",
    lower=-0.95,
    upper=3.0,
    starts=(-0.5, 0.2),
    scale=0.5,
    doc="by how much more the stem sweeps than a machine whose pilot never shut had shown",
    size=False,
)

EFFECT = Effect(
    name="ep_deadband",
    stage="ep",
    claim="The converter ignores command changes inside a band.",
    equations="hold: the goal v follows u when |u - v| > band; play: v = max(u - band, min(u + band, v)); "
    "overlap: no flow while |u - p| <= band, outside it flow counts from the edge (or in full); "
    "overlap_one_side: none for errors between 0 and the band; "
    "latched: in full from |u - p| = band until shuts band; "
    "overlap_and_chamber: likewise, air of the booster times 1 + room; "
    "overlap_leaking: tau dp/dt = e - max(-band, min(e, band)) + leak e, e = u - p",
    source="Merritt, Hydraulic Control Systems (Wiley 1967), ch. 5 (overlapped valves); IEC 61298-2 (dead band)",
    forms=(
        Form(
            "hold",
            _band("command change from the last accepted command that is still ignored", False),
            _mode(1.0),
            _held,
        ),
        Form("play", _band("half width of the hysteresis between command and goal", True), _mode(2.0)),
        Form("overlap", _band("pressure error at which the pilot begins to open", True), _mode(3.0)),
        Form(
            "overlap_leaking",
            (*_band("pressure error at which the pilot begins to open beyond its leak", True), _LEAK),
            _leaks,
        ),
        Form(
            "overlap_and_chamber",
            (*_band("pressure error at which the pilot of a booster begins to open", True), _ROOM),
            _shut,
            by_pressure=True,
        ),
        Form("overlap_abrupt", _band("pressure error at which the pilot opens in full", True), _mode(4.0)),
        Form("overlap_one_side", (_ONE_SIDE,), _one_side),
        Form("overlap_latched", (_LATCH, _SHUTS), _gated),
    ),
    erratic=True,
)
