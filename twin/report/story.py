"""The diagnosis as a page of Markdown, for places that show no HTML."""

from __future__ import annotations

from collections.abc import Mapping

from twin.diagnosis import Bin, Diagnosis, Share
from twin.report.words import heading, interval, name, number, percent


def story(diagnosis: Diagnosis, position_unit: str = "in") -> str:
    """Verdict, causes, gap, where and what next, as headings and tables."""
    parts = [f"# {heading(diagnosis)}", diagnosis.statement, _gap(diagnosis)]
    if diagnosis.causes:
        parts += ["## Causes", *[_cause(diagnosis, index) for index in range(len(diagnosis.causes))]]
    if diagnosis.confusable:
        parts.append("Not to be told apart with this data: " + "; ".join(_set(group) for group in diagnosis.confusable))
    where = diagnosis.where
    for title, group in (
        ("stage (signals alone)", where.stage),
        ("stage (given the causes)", where.attributed),
        ("direction", where.direction),
        ("regime", where.regime),
    ):
        if group:
            parts.append(_group(title, group))
    for title, bins in ((f"position [{position_unit}]", where.position), ("frequency [Hz]", where.frequency)):
        if bins:
            parts.append(_bins(title, bins))
    if diagnosis.next_experiment:
        parts += ["## Next", diagnosis.next_experiment.why]
    return "\n\n".join(parts)


def _gap(diagnosis: Diagnosis) -> str:
    gap = diagnosis.gap
    closed = gap.reducible_closed
    rows = [
        "| held-out RMS | % of travel |",
        "|---|---|",
        f"| before | {number(gap.before)} |",
        f"| re-tuned only | {number(gap.retuned)} |",
        f"| after | {number(gap.after)} |",
        f"| noise floor | {number(gap.noise_floor)} |",
    ]
    if closed:
        rows.append(
            f"| reducible gap closed | {percent(closed.value, 1)} ({' to '.join(percent(v, 1) for v in closed.ci95)}) |"
        )
    return "\n".join(rows)


def _cause(diagnosis: Diagnosis, index: int) -> str:
    cause = diagnosis.causes[index]
    sizes = [f"{name(key)} {number(e.value)} {e.unit} ({interval(e.ci95)})" for key, e in cause.parameters.items()]
    about = f"**{name(cause.name)}** ({name(cause.stage)}), {percent(cause.probability)}"
    return about + (": " + ", ".join(sizes) if sizes else "")


def _group(title: str, group: Mapping[str, Share]) -> str:
    lines = [f"| {title} | share | 95 % |", "|---|---|---|"]
    lines += [f"| {name(key)} | {percent(s.value)} | {_range(s)} |" for key, s in group.items()]
    return "\n".join(lines)


def _bins(title: str, bins: tuple[Bin, ...]) -> str:
    lines = [f"| {title} | share | 95 % |", "|---|---|---|"]
    lines += [f"| {number(b.low)} to {number(b.high)} | {percent(b.share.value)} | {_range(b.share)} |" for b in bins]
    return "\n".join(lines)


def _range(share: Share) -> str:
    return f"{percent(share.ci95[0])} to {percent(share.ci95[1])}"


def _set(group: tuple[str, ...]) -> str:
    return ", ".join(name(member) for member in group)
