"""Design numbers that are wrong by less than anybody would put right.

No number of a design is known to a tenth of a percent, and a machine that is its design to the noise's last tenth is
healthy. A number that lies within its tolerance is not off, unless what it does shows clearly: a small error of the
curves' place shifts the whole stroke.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from control.design import DesignModel
from twin.diagnosis import Cause
from twin.fit.numbers import nominal, reference
from twin.judge.gap import GapParts
from twin.judge.remainder import SLIGHT
from twin.where.closure import rms

#: Of a number; the spread of a design number that nobody accuses (`twin.model.effect.Scales.doubt`).
TOLERANCE = 0.01


def within_tolerance(causes: Sequence[Cause], design: DesignModel) -> list[str]:
    """Of the causes the design numbers that are as they should be, but for their tolerance."""
    numbers = [(c, c.name.removeprefix("parameter:")) for c in causes if c.name.startswith("parameter:")]
    return [
        cause.name
        for cause, name in numbers
        if abs(cause.parameters[name].value - nominal(design, name)) < TOLERANCE * reference(design, name)
    ]


def needless_number(parts: GapParts, causes: Sequence[Cause], slight: Collection[str], floor_percent: float) -> str:
    """Of several causes the number in `slight` without which unseen data pass for those of a healthy machine.

    `floor_percent`: the noise in percent of travel. Empty where there is none.
    """
    left = {c.name: parts.without[c.name] for c in causes if c.name in slight and c.name in parts.without}
    name = min(left, key=lambda one: left[one], default="")
    return name if name and len(causes) > 1 and left[name] < SLIGHT * floor_percent else ""


def forgiven(parts: GapParts, causes: Sequence[Cause], slight: Collection[str], floor: float) -> bool:
    """Whether nothing but numbers in `slight` was found behind a gap that passes for none. `floor`: as the parts."""
    return bool(causes) and all(c.name in slight for c in causes) and rms(parts.before) < SLIGHT * floor
