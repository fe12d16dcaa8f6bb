"""The scores as rows of words: the same ones for the terminal, the page and the document."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

Row = tuple[str, str, str]  # what, figure, 95 % interval


def rows(group: Mapping[str, Any]) -> list[Row]:
    """The scores of a group of trials, most important first."""
    kinds = group["by_kind"]
    found = [
        ("all right: every cause and no other", *_rate(group["right"])),
        ("  nothing wrong: said so", *_rate(kinds["none"])),
        ("  one effect", *_rate(kinds["effect"])),
        ("  one wrong number", *_rate(kinds["parameter"])),
        ("  two causes", *_rate(kinds["effects"])),
        ("  outsider: said unexplained", *_rate(kinds["outsider"])),
    ]
    for name, stratum in group["by_stratum"].items():
        found.append((f"fault {name} x floor: noticed", *_rate(stratum["detected"])))
        found.append(("  all right", *_rate(stratum["right"])))
    found.append(("first named cause is true", *_rate(group["leading"])))
    found += [(f"truth among the first {k} of the ranking", *_rate(r)) for k, r in group["top"].items()]
    return found + _further(group)


def _further(group: Mapping[str, Any]) -> list[Row]:
    sets, calibration, sizes, closed = (group[key] for key in ("sets", "calibration", "sizes", "closed_loop"))
    return [
        ("truth named or in a confusion set", *_rate(sets["covered"])),
        ("  when any cause was named", *_rate(sets["covered_when_named"])),
        ("mean size of a confusion set", number(sets["mean_size"]), _interval(sets["ci95"])),
        ("stage of the first named cause", *_rate(group["stage"])),
        ("stage by the signals alone (converter or behind)", *_rate(group["signal_stage"])),
        ("false cause although nothing is wrong", *_rate(group["false_cause_on_none"])),
        ("false cause, fault below the floor", *_rate(group["false_cause_below_floor"])),
        ("false cause beside or instead of a true one", *_rate(group["false_cause_visible"])),
        ("outsider noticed as unexplained", *_rate(group["unexplained_found"])),
        ("unexplained although the cause is known", *_rate(group["unexplained_wrongly"])),
        ("both of two causes", *_rate(group["both_of_two"])),
        ("  where each alone is above 1 x floor", *_rate(group["both_visible"])),
        ("at least one of two causes", *_rate(group["one_of_two"])),
        ("expected calibration error", number(calibration["ece"]), _interval(calibration["ci95"])),
        ("  by chance, were every probability true", *_honest(calibration["honest"])),
        ("error of the size, median", *_median(sizes["error"])),
        ("  faults from 3 x floor", *_median(sizes["error_from_3"])),
        ("true size in the 95 % interval", *_rate(sizes["covered"])),
        ("gap closed on an unseen closed-loop record, median", *_median(closed["closed"])),
        ("  where the verdict was right", *_median(closed["closed_when_right"])),
        ("  closed by 0.8 or more", *_rate(closed["closed_above_0.8"])),
        ("updated model made that record worse", *_rate(closed["made_worse"])),
    ]


def fault_rows(group: Mapping[str, Any], strata: Sequence[str]) -> list[list[str]]:
    """Per fault: its name, then per stratum "right/noticed/trials"."""
    return [
        [name, *(_cell(by_stratum.get(stratum)) for stratum in strata)] for name, by_stratum in group["faults"].items()
    ]


def _cell(entry: Mapping[str, Any] | None) -> str:
    return "" if entry is None else f"{entry['right'][0]}/{entry['detected'][0]}/{entry['detected'][1]}"


def _rate(entry: Mapping[str, Any]) -> tuple[str, str]:
    if not entry["of"]:
        return "-", ""
    low, high = entry["ci95"]
    return (
        f"{entry['hits']} of {entry['of']}  {100.0 * entry['share']:.0f} %",
        f"{100.0 * low:.0f} to {100.0 * high:.0f} %",
    )


def _median(entry: Mapping[str, Any]) -> tuple[str, str]:
    return number(entry["median"]) + (f"  (n = {entry['of']})" if entry["of"] else ""), _interval(entry["ci95"])


def _honest(entry: Mapping[str, Any] | None) -> tuple[str, str]:
    """The mean and the range of the calibration error that few claims bring along; nothing for scores from before."""
    return ("-", "") if entry is None else (number(entry["mean"]), _interval(entry["range95"]))


def curve_rows(curve: Sequence[Mapping[str, Any]]) -> list[list[str]]:
    """Per range of probabilities: causes named with one, what was said in the mean, how many were true, interval."""
    return [
        [f"{b['from']:g} to {b['to']:g}", str(b["claims"]), f"{b['said']:.4f}", *_rate(_true(b))]
        for b in reversed(curve)
    ]


def _true(piece: Mapping[str, Any]) -> dict[str, Any]:
    hits = round(piece["right"] * piece["claims"])
    return {"hits": hits, "of": piece["claims"], "share": piece["right"], "ci95": piece["ci95"]}


def _interval(pair: Sequence[float] | None) -> str:
    return "" if pair is None else f"{number(pair[0])} to {number(pair[1])}"


def number(value: float | None) -> str:
    """Three digits, or a dash."""
    return "-" if value is None or math.isnan(value) else f"{value:.3g}"
