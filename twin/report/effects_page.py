"""The page `docs/effects.md`, drawn from what is found in `twin/effects`."""

from __future__ import annotations

from twin.model.catalog import effects
from twin.model.effect import Effect, Form, Scales

_HEAD = """# Effects

What the diagnosis knows about: {count} causes in {forms} forms. This page is generated, do not edit it:
`lostmotion explain --markdown > docs/effects.md`. `lostmotion explain EFFECT` simulates one and shows what it looks
like. Numbers are those of the thesis's valve in psi, in and s; other valves scale them by travel and by pressure span.

A new effect is one file in `twin/effects` that defines `EFFECT`; nothing else has to know of it.
"""

_STAGES = {
    "ep": "E/P converter: command to pressure",
    "actuator": "Actuator: pressure to stem",
    "sensor": "Sensor: stem to reading",
}


def effects_page() -> str:
    """The whole page as Markdown."""
    found = effects().values()
    parts = [_HEAD.format(count=len(found), forms=sum(len(e.forms) for e in found))]
    for stage, title in _STAGES.items():
        parts.append(f"\n## {title}\n")
        parts += [_section(one) for one in found if one.stage == stage]
    return "".join(parts)


def _section(one: Effect) -> str:
    lines = [
        f"\n### {one.name}\n",
        one.claim,
        "",
        f"- Equations: `{one.equations}`",
        f"- Source: {one.source}",
        f"- Recognised by: {'the trajectory' if one.evidence == 'trajectory' else 'events in the reading'}",
    ]
    if one.twins:
        lines.append(f"- Looks much like: {', '.join(one.twins)}")
    lines += ["", "| form | parameter | unit | range | none at | meaning |", "|---|---|---|---|---|---|"]
    for form in one.forms:
        lines += _rows(form)
    return "\n".join(lines) + "\n"


def _rows(form: Form) -> list[str]:
    if not form.parameters:
        return [f"| {form.name} | | | | | there or not, without a number |"]
    note = " (design models only)" if form.described else " (a rival: named in words only)" if form.outside else ""
    name = form.name + note
    return [
        f"| {name} | {p.name} | {Scales().unit(p.kind)} | {p.lower:g} .. {p.upper:g} | "
        f"{f'{p.neutral:g}' if p.size else 'shape'} | {p.doc} |"
        for p in form.parameters
    ]
