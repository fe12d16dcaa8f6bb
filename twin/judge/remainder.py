"""How much of a gap causes may leave where no fit has seen it, and explain it all the same."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence

from twin.choose.outside import NUMBERS_LEAVE
from twin.diagnosis import Cause
from twin.model.catalog import effects

#: Of the noise; a design that misses by less has no gap worth a word, when its only cause was taken back.
SLIGHT = 1.3
#: Of a gap of so many times the noise, one cause that leaves this share of the squares does not explain it, nor do
#: several behind the same signal that leave half of that, nor one with more numbers than `FREE`: they can imitate more.
#: That is forgiven where all of a record is explained to its noise.
#: An erratic cause (its jumps follow no model for long) may leave more, and so may any beside a smaller gap, those
#: of the converter for which the measured pressure speaks, and a single law of few numbers by which all of the record
#: is explained to its noise: it may have been fitted without the only block in which it shows.
CLEAR, LEFT, ERRATIC, FREE = 2.5, 0.08, 0.2, 5
#: Of the noise; a cause with so many numbers that leaves more may leave half of that share only.
CURVE = 2.0
#: Of what re-tuned numbers leave of the squares, beyond which a cause that leaves something clear explains nothing.
NUMBERS_DO = 0.8


def leaves_too_much(
    before: float,
    after: float,
    floor: float,
    causes: Sequence[Cause],
    apart: bool,
    exact: bool,
    shown: Collection[str] = (),
) -> bool:
    """Whether the causes leave too much of the gap; errors [any unit] before and after, and the noise under them.

    `apart`, `exact`, `shown`: as in `twin.judge.upheld.upheld`.
    """
    left, gap = after**2 - floor**2, before**2 - floor**2
    if before <= CLEAR * floor:
        # a cause before a measured pressure has that to show for itself
        behind = any(not apart or c.stage != "ep" for c in causes)
        return behind and before > SLIGHT * floor and left > ERRATIC * gap
    numbers = all(c.name.startswith("parameter:") for c in causes)
    if numbers and not exact and after > NUMBERS_LEAVE * floor:
        return True
    known = effects()
    erratic = any(c.name in known and known[c.name].erratic for c in causes)
    told = all(c.name in shown for c in causes)
    several = max(Counter(apart and c.stage == "ep" for c in causes).values()) > 1
    many = any(len(c.parameters) > FREE for c in causes) and not exact
    plain = exact and len(causes) == 1 and len(causes[0].parameters) <= FREE
    share = (ERRATIC if erratic or told or plain else LEFT) * (0.5 if several or many else 1.0)
    # what a free curve leaves is not for want of the right form
    return left > share * (0.5 if many and after > CURVE * floor else 1.0) * gap


def no_better_than_numbers(retuned: float, after: float, floor: float, causes: Sequence[Cause], told: bool) -> bool:
    """Whether causes leave much, and nearly all that other numbers leave without them; errors as above.

    Not asked of an erratic cause, whose path no model follows for long, nor where the pressure has `told` them.
    """
    known = effects()
    if told or any(c.name in known and known[c.name].erratic for c in causes):
        return False
    return after > CLEAR * floor and after**2 - floor**2 > NUMBERS_DO * (retuned**2 - floor**2)
