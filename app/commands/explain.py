"""Explain an effect: what is claimed, how it is modelled, what it looks like, which experiment shows it.

Without EFFECT, lists all of them. parameter:NAME explains a number of the design model.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from hal.errors import BadInput

if TYPE_CHECKING:
    from twin.explain import Signature, Visibility
    from twin.model.effect import Effect, Form, Parameter


@click.command(name="explain", help=__doc__, short_help=(__doc__ or "").partition("\n")[0])
@click.argument("name", metavar="[EFFECT]", required=False)
@click.option("--form", "form_name", metavar="FORM", help="Which form to simulate; the first one otherwise.")
@click.option("--experiment", "kind", metavar="KIND", help="Experiment to simulate; else the one that shows most.")
@click.option("--out", type=click.Path(path_type=Path), metavar="DIR", help="Also draw the figure, as SVG and PNG.")
@click.option("--json", "as_json", is_flag=True, help="Print it as JSON.")
@click.option("--markdown", is_flag=True, help="Print the page docs/effects.md.")
def command(
    name: str | None, form_name: str | None, kind: str | None, out: Path | None, as_json: bool, markdown: bool
) -> None:
    from twin.model.catalog import effect, effects

    if markdown:
        from twin.report.effects_page import effects_page

        click.echo(effects_page(), nl=False)
        return
    if name is None:
        _list(list(effects().values()), as_json)
        return
    if name.startswith("parameter:"):
        if form_name or kind or out:
            raise BadInput(f"{name} is a number of the design model: --form, --experiment and --out are for effects")
        _number_of_design(name.removeprefix("parameter:"), as_json)
        return
    from app.targets import check_folder
    from twin.explain import KINDS, signature, visibilities

    if out is not None:
        check_folder("--out", out)
    one = effect(name)
    form = _form(one, form_name)
    if kind is not None and kind not in KINDS:
        raise BadInput(f"--experiment {kind}: choose one of {', '.join(KINDS)}")
    seen = visibilities(one, form)
    shown = signature(one, form, kind or seen[0].kind)
    if as_json:
        click.echo(json.dumps(_facts(one) | {"simulated_form": form.name, "experiments": [_plain(v) for v in seen]}))
    else:
        _describe(one)
        _show(one, form, shown, seen)
    if out is not None:
        from twin.report.effect_figure import effect_figure, save_effect_figure

        files = save_effect_figure(effect_figure(one, _size(form, shown), shown), out / f"{name}-{form.name}")
        click.echo(f"drawn: {files[0]}, {files[1]}", err=as_json)


def _number_of_design(name: str, as_json: bool) -> None:
    """What the number of the verdict `parameter:NAME` is, and its value in the default design."""
    from control.design import DesignModel
    from twin.fit.numbers import MEANINGS, NUMBERS, nominal, unit

    if name not in NUMBERS:
        raise BadInput(f"no number of the design is called {name!r}; there are {', '.join(NUMBERS)}")
    design = DesignModel()
    value, its_unit = nominal(design, name), unit(design, name)
    facts = {"name": f"parameter:{name}", "stage": NUMBERS[name], "claim": MEANINGS[name]}
    if as_json:
        click.echo(json.dumps({**facts, "unit": its_unit, "default": value}))
        return
    click.echo(f"parameter:{name} ({NUMBERS[name]}): the design has it with another number. {MEANINGS[name]}")
    click.echo(f"default: {value:.4g} {its_unit}; `lostmotion diagnose --design MODEL.toml` takes another")


def _form(one: Effect, name: str | None) -> Form:
    try:
        return one.forms[0] if name is None else one.form(name)
    except KeyError as error:
        raise BadInput(f"--form {name}: {error.args[0]}") from None


def _list(found: list[Effect], as_json: bool) -> None:
    if as_json:
        click.echo(json.dumps([_facts(one) for one in found]))
        return
    width = max(len(one.name) for one in found)
    for stage in ("ep", "actuator", "sensor"):
        click.echo(f"{stage}:")
        for one in found:
            if one.stage == stage:
                click.echo(f"  {one.name:<{width}}  {one.claim}")
    click.echo("lostmotion explain EFFECT says more")


def _facts(one: Effect) -> dict[str, object]:
    return {
        "name": one.name,
        "stage": one.stage,
        "claim": one.claim,
        "equations": one.equations,
        "source": one.source,
        "evidence": one.evidence,
        "twins": list(one.twins),
        "forms": {f.name: [_number(p) for p in f.parameters] for f in one.forms},
    }


def _number(p: Parameter) -> dict[str, object]:
    from twin.model.effect import Scales

    return {
        "name": p.name,
        "unit": Scales().unit(p.kind),
        "lower": p.lower,
        "upper": p.upper,
        "neutral": p.neutral,
        "doc": p.doc,
    }


def _plain(v: Visibility) -> dict[str, object]:
    return {
        "kind": v.kind,
        "duration_s": round(v.duration_s, 1),
        "rms_percent_of_travel": round(v.rms_percent, 4),
        "beyond_retuning_percent_of_travel": round(v.beyond_retuning_percent, 4),
    }


def _describe(one: Effect) -> None:
    from twin.model.effect import Scales

    click.echo(f"{one.name} ({one.stage}): {one.claim}")
    click.echo(f"equations: {one.equations}")
    click.echo(f"source: {one.source}")
    if one.twins:
        click.echo(f"looks much like: {', '.join(one.twins)}")
    for form in one.forms:
        rival = f": a rival, no form of it ({form.outside})" if form.outside else ""
        click.echo(f"form {form.name}{rival}" + ("" if form.parameters else ": there or not, without a number"))
        for p in form.parameters:
            unit = Scales().unit(p.kind)
            click.echo(f"  {p.name} [{unit}] {p.lower:g} to {p.upper:g}, none at {p.neutral:g}: {p.doc}" if p.size else
                       f"  {p.name} [{unit}] {p.lower:g} to {p.upper:g}, usually {p.neutral:g}: {p.doc}")  # fmt: skip


def _size(form: Form, shown: Signature) -> str:
    from twin.model.effect import Scales

    words = [
        f"{p.name} {v:.3g} {Scales().unit(p.kind)}".removesuffix(" 1")
        for p, v in zip(form.parameters, shown.values, strict=True)
    ]
    return f"{form.name} with {', '.join(words)}" if words else form.name


def _show(one: Effect, form: Form, shown: Signature, seen: tuple[Visibility, ...]) -> None:
    from control.preview import duration_words, with_scale
    from twin.report.sketch import plane

    click.echo(f"\nsimulated: {_size(form, shown)}")
    if not shown.residual_percent.any():
        click.echo("It changes single readings by chance, not the expected trajectory: events in the reading show it.")
        return
    click.echo("experiments by what they show, RMS in % of travel (beyond what re-tuning the design could imitate):")
    for v in seen:
        took = duration_words(v.duration_s)
        click.echo(f"  {v.kind:<10} {v.rms_percent:8.3f} ({v.beyond_retuning_percent:.3f})  {took}")
    click.echo(f"\ndifference of the reading over time, {shown.kind}:")
    for line in with_scale(shown.residual_percent, "% of travel"):
        click.echo(line)
    click.echo(f"\nreading (up) over pressure (right), {shown.kind}: '.' design model, 'o' with {one.name}, '#' both")
    for line in plane((shown.base_pressure, shown.base_position), (shown.pressure, shown.position)):
        click.echo(f"  |{line}")
