"""What is right of the answers to a sealed folder, strictly by the names, and what with the sets that were said."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.blind.calibration import Claim, error, honest
from app.blind.mark import Mark, mark
from app.interval import share
from hal.errors import BadInput
from sim_device.sealed import Cause, Label
from twin.fit.numbers import NUMBERS
from twin.model.catalog import effects

#: The classes of a sealed folder, and what a label of ours calls them.
KINDS = {"healthy": "none", "number": "parameter", "single": "effect", "pair": "effects", "outsider": "outsider"}
_NAMED = ("parameter", "effect", "effects")


@dataclass(frozen=True, slots=True)
class Answer:
    """A case with its truth and what was said (`diagnosis.json` with `seconds` and `unseen`, or an `error`).

    `travel_in`: the design's, of which the noise floor is a share.
    """

    case: str
    label: Label
    said: Mapping[str, Any]
    travel_in: float

    @property
    def mark(self) -> Mark:
        return mark(self.label, self.said)

    @property
    def covered(self) -> bool:
        """Whether what was named or said to be like it holds the truth, and nothing was named that is not like it."""
        one = self.mark
        return one.right or (bool(one.claims) and one.covered == len(self.label.causes) and not one.astray)

    @property
    def closure(self) -> float | None:
        """The share of the mean squared gap that is closed on the unseen record, whose readings are without noise.

        None where nothing is wrong with the machine, or where the design misses that record by less than the floor.
        """
        unseen, gap = self.said.get("unseen"), self.said["gap"]
        if unseen is None or self.label.kind == "none" or gap["noise_floor"] is None:
            return None
        floor_in = 0.01 * float(gap["noise_floor"]) * self.travel_in
        before, after = unseen["before_in"], unseen["after_in"]
        return 1.0 - (after / before) ** 2 if before > floor_in else None


def label_of(case: str, sealed: Mapping[str, Any] | None) -> Label:
    """The label of one case of `SEALED.json`.

    Raises: `BadInput` for a case without a class and its true causes, and for a class or a name that nobody knows.
    """
    if sealed is None or not {"cls", "truth"} <= sealed.keys():
        raise BadInput(f"SEALED.json: {case} has no label; give it a class (cls) and its true causes (truth)")
    if sealed["cls"] not in KINDS:
        raise BadInput(f"SEALED.json: {case}: class {sealed['cls']!r} is none of {', '.join(KINDS)}")
    kind = KINDS[sealed["cls"]]
    stages = _stages()
    unknown = [name for name in sealed["truth"] if kind != "outsider" and name not in stages]
    if unknown:
        raise BadInput(
            f"SEALED.json: {case}: cause {unknown[0]!r} is not in the vocabulary (lostmotion explain lists it)"
        )
    causes = tuple(Cause(name, stages.get(name, ""), "", 0.0, "", "") for name in sealed["truth"])
    return Label(kind, "stranger", 0, causes)


def _stages() -> dict[str, str]:
    """The stage of every cause of the vocabulary."""
    numbers = {f"parameter:{name}": stage for name, stage in NUMBERS.items()}
    return numbers | {name: effect.stage for name, effect in effects().items()}


def text(answers: Sequence[Answer]) -> str:
    """The figures with their intervals, the row of the table in docs/strangers.md, and every miss."""
    good = [a for a in answers if "error" not in a.said]
    broken = [f"  {a.case}: ended in an error: {a.said['error']}" for a in answers if "error" in a.said]
    figures = [*_figures(good), "", _row(good)] if good else ["  no case was answered"]
    return "\n".join([*figures, "", "misses:", *map(_miss, _wrong(good)), *broken])


def _of(answers: Sequence[Answer], *kinds: str) -> list[Answer]:
    return [a for a in answers if a.label.kind in kinds]


def _wrong(answers: Sequence[Answer]) -> list[Answer]:
    return [a for a in answers if not a.mark.right]


def _measures(answers: Sequence[Answer]) -> dict[str, list[bool]]:
    named, pairs = _of(answers, *_NAMED), _of(answers, "effects")
    stages = [a.mark.stage for a in named]
    measures: dict[str, list[bool]] = {"all right": [a.mark.right for a in answers]}
    measures["right, or a set holds it"] = [a.covered for a in answers]
    for cls, kind in KINDS.items():
        measures[f"{cls}: right"] = [a.mark.right for a in _of(answers, kind)]
    measures["first cause"] = [a.mark.leading for a in named]
    measures["stage"] = [bool(stage) for stage in stages]
    measures["both of two"] = [a.mark.found == 2 for a in pairs]
    measures["false cause, healthy"] = [bool(a.said["causes"]) for a in _of(answers, "none")]
    return measures


def _figures(answers: Sequence[Answer]) -> Iterator[str]:
    for name, marks in _measures(answers).items():
        yield f"  {name:26}{sum(marks):4} of {len(marks):<4}{share(marks) if marks else '-'}"
    named, closures = claims(answers), _closures(answers)
    yield f"  names in a set, mean      {_set(answers):.2f}"
    if named:
        chance = honest(named)["mean"]
        yield f"  calibration error         {error(named):.3f} ({len(named)} causes; {chance:.3f} by chance alone)"
    sure = [right for p, right in named if p >= 0.96]
    yield f"  true of those said with 0.96 or more: {sum(sure)} of {len(sure)}"
    if closures:
        middle, worst = np.median(closures), min(closures)
        yield f"  closure on an unseen record: median {middle:.4f}, worst {worst:.3f}, n {len(closures)}"
    seconds = [a.said["seconds"] for a in answers]
    yield f"  seconds: median {np.median(seconds):.0f}, at most {max(seconds):.0f}"


def claims(answers: Sequence[Answer]) -> list[Claim]:
    """What was said with which probability, and whether it was true; nothing of what ended in an error."""
    return [claim for a in answers if "error" not in a.said for claim in a.mark.claims]


def _closures(answers: Sequence[Answer]) -> list[float]:
    return [c for a in answers if (c := a.closure) is not None]


def _set(answers: Sequence[Answer]) -> float:
    """Names in the mean set of a cause that was named where one was to be named."""
    sizes = [size for a in _of(answers, *_NAMED) for size in a.mark.set_sizes]
    return sum(sizes) / len(sizes) if sizes else float("nan")


def _row(answers: Sequence[Answer]) -> str:
    """The cells behind plant, seed and commit."""
    measures, healthy = _measures(answers), _of(answers, "none")
    count: Callable[[str], str] = lambda name: f"{sum(measures[name])} of {len(measures[name])}"  # noqa: E731
    counts = [str(len(answers)), count("all right"), f"{sum(not a.said['causes'] for a in healthy)} of {len(healthy)}"]
    counts += [count(name) for name in ("first cause", "stage", "both of two", "outsider: right")]
    named, closures = claims(answers), _closures(answers)
    rest = [f"{_set(answers):.2f}"]
    rest += [f"{error(named):.3f}" if named else "-", f"{np.median(closures):.3f}" if closures else "-"]
    return "| " + " | ".join(counts + rest) + " |"


def _miss(answer: Answer) -> str:
    truth = ", ".join(cause.name for cause in answer.label.causes) or "healthy"
    named = ", ".join(f"{cause['name']} {cause['probability']:.2f}" for cause in answer.said["causes"])
    sets = "; ".join("=".join(names) for names in answer.said["confusable"])
    gap = answer.said["gap"]
    gaps = f"before {gap['before']} retuned {gap['retuned']} after {gap['after']} floor {gap['noise_floor']}"
    return f"  {answer.case}: {truth} -> {answer.said['verdict']}: {named or '-'} [{sets}] {gaps}"
