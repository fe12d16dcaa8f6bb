"""The table of a run: rates with Wilson's 95 % intervals, calibration of the probabilities, and every miss."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

Line = dict[str, Any]
_Z = 1.959964  # 95 %


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a rate."""
    if count == 0:
        return 0.0, 1.0
    rate, z2 = hits / count, _Z * _Z
    middle = (rate + z2 / (2 * count)) / (1 + z2 / count)
    half = _Z * np.sqrt(rate * (1 - rate) / count + z2 / (4 * count * count)) / (1 + z2 / count)
    return float(max(middle - half, 0.0)), float(min(middle + half, 1.0))


def calibration_error(named: Sequence[Line], key: str) -> float:
    """Expected calibration error over ten bins of the named causes' probabilities."""
    if not named:
        return 0.0
    probability = np.array([one["probability"] for one in named])
    right = np.array([one[key] for one in named], dtype=float)
    bins = np.minimum((probability * 10).astype(int), 9)
    gaps = [
        np.sum(bins == k) * abs(right[bins == k].mean() - probability[bins == k].mean())
        for k in range(10)
        if np.any(bins == k)
    ]
    return float(np.sum(gaps) / probability.size)


def _rate(name: str, lines: Iterable[Line], hit: Callable[[Line], bool | None]) -> str:
    hits = [value for line in lines if (value := hit(line)) is not None]
    low, high = wilson(sum(hits), len(hits))
    share = f"{100 * sum(hits) / len(hits):5.1f} %" if hits else "    - "
    return f"  {name:34}{sum(hits):4}/{len(hits):<4}{share}  [{100 * low:.0f}, {100 * high:.0f}]"


def _miss(line: Line) -> str:
    truth = ", ".join(
        f"{one['name']}/{one['form']} {one['grade']} {one['size']:.3g} {one['unit']}"
        f" (x{one['ratio']:.1f}, own {one['own']:.1f})"
        for one in line["label"]["causes"]
    )
    named = ", ".join(f"{one['name']} {one['probability']:.2f}" for one in line["answer"]["causes"])
    sets = "; ".join("=".join(names) for names in line["answer"]["confusable"])
    gap = line["answer"]["gap"]
    gaps = f"before {gap['before']} retuned {gap['retuned']} after {gap['after']} floor {gap['noise_floor']}"
    return (
        f"  #{line['case']} {truth or 'healthy'}\n     -> {line['answer']['verdict']}: {named or '-'} [{sets}] {gaps}"
    )


def _median(values: Sequence[float]) -> str:
    return f"{np.median(values):.3g} (worst {np.min(values):.3g}, n {len(values)})" if values else "-"


def summary(lines: Sequence[Line]) -> str:
    """All that is to be said about the cases, as text."""
    good = [line for line in lines if "error" not in line]
    text = [f"{len(lines)} cases, {len(lines) - len(good)} errors"]
    for kind in dict.fromkeys(line["label"]["kind"] for line in good):
        text.append(_rate(f"{kind}: right", [x for x in good if x["label"]["kind"] == kind], lambda x: x["right"]))
    for grade in ("small", "medium", "large"):
        ones = [x for x in good if x["label"]["kind"] in ("effect", "parameter")]
        ones = [x for x in ones if x["label"]["causes"][0]["grade"] == grade]
        text.append(_rate(f"one cause, {grade}: right", ones, lambda x: x["right"]))
    inside = [x for x in good if x["label"]["kind"] != "outsider"]
    for key in ("right", "right_or_confusable", "first_right", "stage_right", "in_confusion_set"):
        text.append(_rate(f"in vocabulary: {key}", inside, lambda x, key=key: x[key]))  # type: ignore[misc]
    text.append(_rate("in vocabulary: a false cause", inside, lambda x: bool(x["false"])))
    text.append(_rate("outsider: a false cause", [x for x in good if x not in inside], lambda x: bool(x["false"])))
    text.append(_rate("true size in its 95 % interval", good, lambda x: x.get("size_covered")))
    named = [one for line in good for one in line["named"]]
    text.append(f"  calibration error {calibration_error(named, 'right'):.3f}, confusable counted as right ")
    text[-1] += f"{calibration_error(named, 'right_or_confusable'):.3f} ({len(named)} named causes)"
    shares = [x["closure"]["share"] for x in good if (x.get("closure") or {}).get("share") is not None]
    text.append(f"  closure on an unseen closed loop: median {_median(shares)}")
    text.append(f"  seconds: median {np.median([x['seconds'] for x in good] or [0.0]):.1f}")
    text.append("misses:")
    text += [_miss(line) for line in good if not line["right"]]
    text += [f"  #{line['case']} error: {line['error']}" for line in lines if "error" in line]
    return "\n".join(text)
