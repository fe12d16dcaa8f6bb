"""One diagnosis against one truth: what was right, what was not, strictly by the names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim_device.sealed import Label

Said = Mapping[str, Any]  # the content of a diagnosis.json


@dataclass(frozen=True, slots=True)
class Mark:
    """`right`: everything as it is: the causes and no others, `no_gap` for none, `unexplained` for an outsider.

    `leading`: the cause named first is a true one (none and outsider: as `right`). `ranks`: per true cause its place in
    the ranking from 1, or None. `covered`: true causes that are named or in the confusion set of one that is;
    `set_sizes`: per named cause how many names its confusion set has, itself included. `false`: named and not true;
    `astray`: false ones whose confusion set holds no true cause either. `stage`: the first named cause is in the
    right stage; `signal_stage`: the larger share of the error by the signals alone is in the right half of the chain.
    `claims`: (probability, right) of every cause named.
    """

    right: bool
    leading: bool
    found: int
    covered: int
    ranks: tuple[int | None, ...]
    set_sizes: tuple[int, ...]
    false: tuple[str, ...]
    astray: tuple[str, ...]
    stage: bool | None
    signal_stage: bool | None
    claims: tuple[tuple[float, bool], ...]


def mark(label: Label, said: Said) -> Mark:
    """Marks a diagnosis; `said` is the content of its diagnosis.json."""
    truth = [cause.name for cause in label.causes] if label.kind != "outsider" else []
    named = [str(cause["name"]) for cause in said["causes"]]
    sets = {name: _set_of(name, said["confusable"]) for name in named}
    reach = set().union(*sets.values())
    right = _right(label, said, truth, named)
    return Mark(
        right=right,
        leading=named[0] in truth if truth and named else right,
        found=sum(name in named for name in truth),
        covered=sum(name in reach for name in truth),
        ranks=tuple(_rank(name, said["ranking"]) for name in truth),
        set_sizes=tuple(len(names) for names in sets.values()),
        false=tuple(name for name in named if name not in truth),
        astray=tuple(name for name in named if not sets[name] & set(truth)),
        stage=_stage(label, said),
        signal_stage=_signal_stage(label, said),
        claims=tuple((float(cause["probability"]), cause["name"] in truth) for cause in said["causes"]),
    )


def _right(label: Label, said: Said, truth: Sequence[str], named: Sequence[str]) -> bool:
    match label.kind:
        case "none":
            return bool(said["verdict"] == "no_gap")
        case "outsider":
            return bool(said["verdict"] == "unexplained")
        case _:
            return sorted(named) == sorted(truth)


def _set_of(name: str, confusable: Sequence[Sequence[str]]) -> set[str]:
    """The cause and everything that it cannot be told from."""
    return {name}.union(*(names for names in confusable if name in names))


def _rank(name: str, ranking: Sequence[Mapping[str, Any]]) -> int | None:
    return next((place for place, line in enumerate(ranking, start=1) if line["name"] == name), None)


def _stage(label: Label, said: Said) -> bool | None:
    """None where nothing is wrong, or nothing was named."""
    if not label.causes or not said["causes"]:
        return None
    return said["causes"][0]["stage"] in {cause.stage for cause in label.causes}


def _signal_stage(label: Label, said: Said) -> bool | None:
    """The converter against what follows it, which is as far as pressure and position reach; None without a split."""
    shares = said["where"]["stage"]
    halves = {"ep" if cause.stage == "ep" else "actuator_or_sensor" for cause in label.causes}
    if shares is None or len(halves) != 1:
        return None
    return max(("ep", "actuator_or_sensor"), key=lambda half: shares[half]) in halves
