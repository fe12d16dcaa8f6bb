"""All trials of a blind check as figures, each with its interval.

Faults below the floor are reported apart: nothing can be asked of them but that no false cause is named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from app.blind.calibration import calibration
from app.blind.strength import EDGES, STRATA
from app.interval import by_trial, median, median_by_trial, rate

Line = Mapping[str, Any]

KINDS = ("none", "effect", "parameter", "effects", "outsider")


def score(lines: Sequence[Line]) -> dict[str, Any]:
    """Scores of all trials together and of each family; `broken` are trials that ended in an error."""
    whole = [line for line in lines if "error" not in line]
    families = sorted({line["label"]["family"] for line in whole})
    return {
        "trials": len(lines),
        "broken": [{"trial": line["trial"], "error": line["error"]} for line in lines if "error" in line],
        "all": group(whole),
        "families": {name: group([line for line in whole if line["label"]["family"] == name]) for name in families},
    }


def group(lines: Sequence[Line]) -> dict[str, Any]:
    """The scores of some trials."""
    visible = [line for line in lines if not hidden(line)]
    named = [line for line in visible if line["label"]["kind"] in ("effect", "parameter", "effects")]
    return {
        "trials": len(lines),
        "right": rate([right(line) for line in visible]),
        "by_kind": {kind: rate([right(li) for li in visible if kind_of(li) == kind]) for kind in KINDS},
        "by_stratum": {name: _stratum(lines, name) for name in STRATA},
        "leading": rate([line["mark"]["leading"] for line in named]),
        "top": {str(k): rate([_among(line, k) for line in named]) for k in (1, 2, 3, 5)},
        "sets": _sets(named),
        "stage": rate([li["mark"]["stage"] for li in visible if li["mark"]["stage"] is not None]),
        "signal_stage": rate([li["mark"]["signal_stage"] for li in visible if li["mark"]["signal_stage"] is not None]),
        "false_cause_on_none": rate([bool(li["causes"]) for li in lines if kind_of(li) == "none"]),
        "false_cause_below_floor": rate([bool(li["mark"]["false"]) for li in lines if hidden(li)]),
        "false_cause_visible": rate([bool(li["mark"]["false"]) for li in named]),
        "unexplained_found": rate([li["verdict"] == "unexplained" for li in visible if kind_of(li) == "outsider"]),
        "unexplained_wrongly": rate([li["verdict"] == "unexplained" for li in visible if kind_of(li) != "outsider"]),
        "both_of_two": rate([li["mark"]["found"] == 2 for li in visible if kind_of(li) == "effects"]),
        "both_visible": rate([li["mark"]["found"] == 2 for li in visible if _both_visible(li)]),
        "one_of_two": rate([li["mark"]["found"] >= 1 for li in visible if kind_of(li) == "effects"]),
        "calibration": calibration([[tuple(claim) for claim in line["mark"]["claims"]] for line in lines]),
        "sizes": _sizes(visible),
        "closed_loop": _closed_loop(visible),
        "faults": _faults(lines),
        "confusion": _confusion(visible),
    }


def kind_of(line: Line) -> str:
    return str(line["label"]["kind"])


def right(line: Line) -> bool:
    return bool(line["mark"]["right"])


def _faulty(line: Line) -> bool:
    return kind_of(line) != "none"


def hidden(line: Line) -> bool:
    """Whether the fault moves the position by less than the floor."""
    return _faulty(line) and line["stratum"] == STRATA[0]


def _both_visible(line: Line) -> bool:
    """Whether there are two causes, each of which alone moves the position by more than the floor."""
    return kind_of(line) == "effects" and line["weakest"] >= EDGES[0]


def _stratum(lines: Sequence[Line], name: str) -> dict[str, Any]:
    lines = [line for line in lines if _faulty(line) and line["stratum"] == name]
    return {
        "detected": rate([line["verdict"] != "no_gap" for line in lines]),
        "right": rate([right(line) for line in lines]),
        "right_but_outsiders": rate([right(line) for line in lines if kind_of(line) != "outsider"]),
    }


def _among(line: Line, k: int) -> bool:
    """Whether the ranking's first k hold a true cause; for two causes, whether its first k + 1 hold both."""
    ranks = line["mark"]["ranks"]
    return all(place is not None and place <= k + len(ranks) - 1 for place in ranks)


def _sets(named: Sequence[Line]) -> dict[str, Any]:
    """How often the named causes or what they cannot be told from hold every true cause, and how large the sets are."""
    trials = [line["mark"]["set_sizes"] for line in named]
    sizes = [size for trial in trials for size in trial]
    interval = list(by_trial(trials, lambda some: sum(some) / len(some))) if sizes else None
    covered = [line["mark"]["covered"] == len(line["label"]["causes"]) for line in named]
    spoken = [c for c, line in zip(covered, named, strict=True) if line["causes"]]
    mean = sum(sizes) / len(sizes) if sizes else None
    return {"covered": rate(covered), "covered_when_named": rate(spoken), "mean_size": mean, "ci95": interval}


def _sizes(lines: Sequence[Line]) -> dict[str, Any]:
    checks = [check for line in lines for check in line["sizes"]]
    large = [line for line in lines if line["ratio"] >= 3.0]
    return {
        "error": median_by_trial([[check["error"] for check in line["sizes"]] for line in lines]),
        "error_from_3": median_by_trial([[check["error"] for check in line["sizes"]] for line in large]),
        "covered": rate([check["covered"] for check in checks]),
    }


def _closed_loop(lines: Sequence[Line]) -> dict[str, Any]:
    """Closure on records in closed loop that the diagnosis never saw, of faults that show there."""
    seen = [line for line in lines if _faulty(line) and line["closed_loop"]["closed"] is not None]
    healthy = [li for li in lines if not _faulty(li)]
    return {
        "closed": median([line["closed_loop"]["closed"] for line in seen]),
        "closed_when_right": median([line["closed_loop"]["closed"] for line in seen if right(line)]),
        "closed_above_0.8": rate([line["closed_loop"]["closed"] >= 0.8 for line in seen]),
        "made_worse": rate([_worse(line) for line in lines]),
        "made_worse_when_healthy": rate([_worse(line) for line in healthy]),
    }


def _worse(line: Line) -> bool:
    """Whether the updated model is clearly worse than the design on the record it never saw."""
    return bool(line["closed_loop"]["after"] > 1.1 * line["closed_loop"]["before"])


def _faults(lines: Sequence[Line]) -> dict[str, Any]:
    """Per single fault and stratum: how often something was noticed, and how often it was right."""
    single = [line for line in lines if len(line["label"]["causes"]) == 1]
    names = sorted({line["label"]["causes"][0]["name"] for line in single})
    return {name: _by_stratum([li for li in single if li["label"]["causes"][0]["name"] == name]) for name in names}


def _by_stratum(lines: Sequence[Line]) -> dict[str, Any]:
    def hits(name: str, test: Callable[[Line], bool]) -> list[int]:
        marks = [test(line) for line in lines if line["stratum"] == name]
        return [sum(marks), len(marks)]

    return {
        name: {"detected": hits(name, lambda li: li["verdict"] != "no_gap"), "right": hits(name, right)}
        for name in STRATA
        if any(line["stratum"] == name for line in lines)
    }


def _confusion(lines: Sequence[Line]) -> list[dict[str, Any]]:
    """How often each truth was answered by what: the first named cause, or `no_gap`, or `unexplained`."""
    pairs = Counter((_truth(line), _said(line)) for line in lines if kind_of(line) != "effects")
    return [{"truth": truth, "said": said, "count": count} for (truth, said), count in sorted(pairs.items())]


def _truth(line: Line) -> str:
    kind = kind_of(line)
    return kind if kind in ("none", "outsider") else str(line["label"]["causes"][0]["name"])


def _said(line: Line) -> str:
    return str(line["causes"][0]["name"] if line["causes"] else line["verdict"])
