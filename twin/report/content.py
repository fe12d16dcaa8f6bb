"""From a diagnosis to what the page shows: rows, bars and marks with their places worked out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import ceil

from twin.diagnosis import Bin, Cause, Diagnosis, Gap, Share
from twin.model.catalog import effects
from twin.report.words import SOURCES, interval, name, number, percent

#: A probability that is 0 in its last digit is not impossible.
_NEXT_TO_NOTHING = 1e-9


@dataclass(frozen=True, slots=True)
class Bar:
    """A horizontal bar on a scale of its group; places in percent of the width."""

    label: str
    text: str
    detail: str
    left: float
    width: float
    low: float
    high: float
    zero: float
    tone: str


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a binned group; heights in percent of the scale's top."""

    label: str
    text: str
    height: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Mark:
    """A point on the scale of the gap, in percent of its length."""

    label: str
    text: str
    place: float
    tone: str


def share_bars(group: Mapping[str, Share] | None) -> list[Bar]:
    """Bars of shares on a common scale that holds 0, 1 and every interval; below zero means masking."""
    if not group:
        return []
    low = min(0.0, *(share.ci95[0] for share in group.values()))
    high = max(1.0, *(share.ci95[1] for share in group.values()))
    span = high - low

    def place(value: float) -> float:
        return 100.0 * (value - low) / span

    return [
        Bar(
            label=name(key),
            text=percent(share.value),
            detail=f"95 %: {percent(share.ci95[0])} to {percent(share.ci95[1])}"
            + (", masks another stage" if share.value < 0 else ""),
            left=place(min(share.value, 0.0)),
            width=100.0 * abs(share.value) / span,
            low=place(share.ci95[0]),
            high=place(share.ci95[1]),
            zero=place(0.0),
            tone="minus" if share.value < 0 else "plus",
        )
        for key, share in group.items()
    ]


def top_share(groups: Iterable[tuple[Bin, ...] | None]) -> float:
    """The top of one scale for all binned groups: the highest column or whisker, rounded up to a tenth."""
    highest = max((max(b.share.ci95[1], b.share.value) for bins in groups for b in bins or ()), default=0.0)
    return max(0.1, ceil(10.0 * highest - 1e-9) / 10.0)


def columns(bins: tuple[Bin, ...] | None, top: float, scale: float = 1.0) -> list[Column]:
    """Columns of a binned group up to a share of `top`; bin edges are multiplied by `scale` for their labels."""
    if not bins:
        return []
    return [
        Column(
            label=number(_edge(b.low, b) * scale, 2),
            text=f"{number(_edge(b.low, b) * scale)} to {number(_edge(b.high, b) * scale)}: "
            f"{percent(b.share.value, 1)} ({percent(b.share.ci95[0], 1)} to {percent(b.share.ci95[1], 1)})",
            height=100.0 * max(b.share.value, 0.0) / top,
            low=100.0 * max(b.share.ci95[0], 0.0) / top,
            high=100.0 * max(b.share.ci95[1], 0.0) / top,
        )
        for b in bins
    ]


def _edge(value: float, within: Bin) -> float:
    """The edge of a bin; what is nothing beside the bin's width, like a reading's noise around zero, is zero."""
    return 0.0 if abs(value) < 0.01 * (within.high - within.low) else value


def gap_marks(gap: Gap) -> list[Mark]:
    """Floor, after, re-tuned and before on one scale from 0."""
    top = 1.04 * max(gap.before, gap.retuned, gap.after, gap.noise_floor, 1e-9)
    rows = (
        ("noise floor", gap.noise_floor, "floor"),
        ("after", gap.after, "after"),
        ("re-tuned only", gap.retuned, "retuned"),
        ("before", gap.before, "before"),
    )
    return [Mark(label, f"{number(value)} %", 100.0 * value / top, tone) for label, value, tone in rows]


def cause_rows(causes: tuple[Cause, ...]) -> list[dict[str, object]]:
    """Named causes with claim, equations and source where the catalogue knows them."""
    known = effects()
    rows: list[dict[str, object]] = []
    for cause in causes:
        effect = known.get(cause.name)
        meanings = {p.name: p.doc for f in effect.forms if f.name == cause.form for p in f.parameters} if effect else {}
        rows.append(
            {
                "name": name(cause.name),
                "stage": name(cause.stage),
                "form": name(cause.form) if effect and len(effect.forms) > 1 else "",
                "probability": percent(cause.probability),
                "without": number(cause.heldout_gap_without),
                "claim": effect.claim if effect else "The design model has the effect, with another number.",
                "equations": effect.equations if effect else "",
                "source": effect.source if effect else "",
                "parameters": [
                    (name(key), meanings.get(key, ""), number(e.value), interval(e.ci95), _unit(e.unit))
                    for key, e in cause.parameters.items()
                ],
            }
        )
    return rows


def ranking_rows(diagnosis: Diagnosis) -> list[dict[str, object]]:
    """All candidates with their probability bars, whether named or rejected, and their confusion set."""
    named = {cause.name for cause in diagnosis.causes}
    sets = {member: f"{chr(65 + i)}" for i, group in enumerate(diagnosis.confusable) for member in group}
    return [
        {
            "name": name(line.name),
            "probability": "rejected" if line.rejected else percent(max(line.probability, _NEXT_TO_NOTHING)),
            "width": 100.0 * max(0.0, min(line.probability, 1.0)),
            "gap": number(line.heldout_gap),
            "named": line.name in named,
            "set": sets.get(line.name, ""),
        }
        for line in diagnosis.ranking
    ]


def confusion_lines(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """Letter and members of each set that the data cannot separate."""
    return [(chr(65 + i), ", ".join(name(m) for m in group)) for i, group in enumerate(diagnosis.confusable)]


def tested_rows(diagnosis: Diagnosis) -> list[dict[str, object]]:
    """Per effect: testable or not, and the mildest case that this record could have shown."""
    return [
        {
            "name": name(test.name),
            "testable": test.testable,
            "limit": "-"
            if test.detection_limit is None
            else f"{name(test.parameter)} {number(test.detection_limit, 2)} {_unit(test.unit)}".strip(),
            "reason": test.reason,
        }
        for test in diagnosis.effects_tested
    ]


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


def noise_rows(noise: Mapping[str, object]) -> list[tuple[str, str]]:
    """Per signal its noise, what that was measured from, and how long it remembers."""
    rows = []
    for signal, facts in noise.items():
        if not isinstance(facts, Mapping):
            continue
        floor = f"{number(facts.get('sigma'))} {facts.get('unit', '')}".strip()
        source = SOURCES.get(str(facts.get("source")), "")
        memory = number(facts.get("correlation_samples"), 2)
        rows.append((name(signal), f"{floor} RMS, from {source}; one in {memory} readings is independent"))
    return rows


def plain_rows(mapping: Mapping[str, object]) -> list[tuple[str, str]]:
    """A free mapping as label and text; nested ones flattened one level."""
    rows: list[tuple[str, str]] = []
    for key, value in mapping.items():
        if isinstance(value, Mapping):
            text = ", ".join(f"{name(str(k))} {number(v)}" for k, v in value.items())
        elif isinstance(value, (list, tuple)):
            text = ", ".join(number(v) for v in value)
        else:
            text = name(value) if isinstance(value, str) else number(value)
        rows.append((name(str(key)), text))
    return rows
