"""The answers of one tick into one sample."""

from __future__ import annotations

import math

from hal.freshness import Freshness
from hal.reply import Reply
from hal.sample import Quality, Reading, Sample
from hal.tick import Block

NO_VALUE = Quality.MISSING | Quality.SENTINEL
Replies = list[tuple[Block, Reply | None]]
_CORE = ("position", "pressure", "readback", "sequence")


def assemble(
    commanded: float | None, time_s: float, replies: Replies, freshness: Freshness, foreign: float | None = None
) -> Sample:
    """The sample of a tick whose write happened at `time_s`; an answer that is None makes its signals MISSING.

    The sequence number vouches for the block it came in, and for no other. Without a command (`commanded` None) the
    read-back takes its place, NaN where there is none. `foreign`: see `Sample.foreign_psi`.
    """
    found: dict[str, Reading] = {}
    for block, reply in replies:
        if reply is None:
            found |= {item.name: Reading(math.nan, time_s, 0.0, Quality.MISSING) for item in block.channels}
            continue
        words, midpoint_s, latency_s = reply.words, reply.midpoint_s, reply.latency_s
        extra = _freshness(block, words, freshness)
        for item in block.channels:
            found[item.name] = item.reading(words, midpoint_s, latency_s, extra)
    readback = _known(found.get("readback"))
    sequence = _known(found.get("sequence"))
    if commanded is None:
        commanded = math.nan if readback is None else readback
    return Sample(
        time_s=time_s,
        commanded_psi=commanded,
        position=found["position"],
        pressure=found.get("pressure"),
        readback_psi=readback,
        foreign_psi=foreign,
        sequence=None if sequence is None else int(sequence),
        aux={name: reading for name, reading in found.items() if name not in _CORE},
    )


def _freshness(block: Block, words: tuple[int, ...], freshness: Freshness) -> Quality:
    item = next((item for item in block.channels if item.name == "sequence"), None)
    return Quality.GOOD if item is None else freshness.judge(int(item.value(words)[0]))


def _known(reading: Reading | None) -> float | None:
    return None if reading is None or reading.quality & NO_VALUE else reading.value
