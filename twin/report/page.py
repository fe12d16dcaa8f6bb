"""The report: one self-contained HTML page that an operator prints and a professor checks."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from twin.diagnosis import Diagnosis
from twin.report.content import (
    cause_rows,
    columns,
    confusion_lines,
    gap_marks,
    noise_rows,
    plain_rows,
    ranking_rows,
    share_bars,
    tested_rows,
    top_share,
)
from twin.report.series import Series
from twin.report.signature import signature_rows
from twin.report.words import heading, interval, name, number, percent

_TEMPLATE = Path(__file__).parent / "template.html.j2"
_HERE = Path()


def write_report(diagnosis: Diagnosis, series: Series, path: Path) -> None:
    """Writes the page; nothing in it refers to anything outside it. Takes a second or two, whatever the rows."""
    path.write_text(render(diagnosis, series, path.parent), encoding="utf-8")


def render(diagnosis: Diagnosis, series: Series, folder: Path = _HERE) -> str:
    """The page as text; the same input gives the same text. `folder` is where it and the next experiment lie."""
    import jinja2

    proposed = diagnosis.next_experiment

    environment = jinja2.Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    template = environment.from_string(_TEMPLATE.read_text(encoding="utf-8"))
    return template.render(
        d=diagnosis,
        next_file=folder / proposed.file if proposed is not None and proposed.file else "",
        verdict=heading(diagnosis),
        figures=_figures(diagnosis, series),
        records=_records(series),
        causes=cause_rows(diagnosis.causes),
        ranking=ranking_rows(diagnosis),
        confusion=confusion_lines(diagnosis),
        tests=tested_rows(diagnosis),
        marks=gap_marks(diagnosis.gap),
        signature=signature_rows(diagnosis.residual_signature),
        noise=noise_rows(diagnosis.noise),
        closed_loop=plain_rows(diagnosis.closed_loop),
        name=name,
        number=number,
        percent=percent,
        interval=interval,
        **_where(diagnosis, series),
    )


def _where(diagnosis: Diagnosis, series: Series) -> dict[str, object]:
    where = diagnosis.where
    minutes = where.time is not None and where.time[-1].high > 600.0
    top = top_share((where.position, where.pressure, where.time, where.frequency))
    return {
        "chain": _chain(diagnosis),
        "stage": share_bars(where.stage),
        "measured": series.pressure is not None,
        "attributed": share_bars(where.attributed),
        "direction": share_bars(where.direction),
        "regime": share_bars(where.regime),
        "top": percent(top),
        "binned": [
            ("position", "% of travel", columns(where.position, top, 100.0 / series.travel)),
            ("pressure", series.pressure_unit, columns(where.pressure, top)),
            ("run time", "min" if minutes else "s", columns(where.time, top, 1.0 / 60.0 if minutes else 1.0)),
            ("frequency", "Hz", columns(where.frequency, top)),
        ],
    }


def _chain(diagnosis: Diagnosis) -> dict[str, str]:
    """What each box of the chain says about its share of the gap; without a gap there is nothing to say."""
    boxes = ("ep", "actuator", "sensor")
    if diagnosis.verdict == "no_gap":
        return dict.fromkeys(boxes, "no gap")
    shares = diagnosis.where.attributed or diagnosis.where.stage or {}
    joint = shares.get("actuator_or_sensor")
    together = f"{percent(joint.value)} with its neighbour" if joint else "share not known"
    return {key: f"{percent(shares[key].value)} of the gap" if key in shares else together for key in boxes}


def _figures(diagnosis: Diagnosis, series: Series) -> dict[str, str]:
    """The drawn figures by name; text is drawn here so that no figure can fail for want of rows."""
    from twin.report.figures import close_up, over_time, planes, pressure_close_up, residual_shape

    if series.time_s.size < 100:
        return {}
    floor = diagnosis.gap.noise_floor
    converter = series.pressure_after is not None and _concerns_converter(diagnosis)
    return {
        "pressure": pressure_close_up(series) if converter else "",
        "close_up": close_up(series, floor),
        "planes": planes(series),
        "over_time": over_time(series, floor),
        "residual_shape": residual_shape(series, floor),
    }


def _concerns_converter(diagnosis: Diagnosis) -> bool:
    """Whether a cause is one of the converter, or what nothing explains is in the pressure."""
    unexplained = diagnosis.residual_signature.get("signal") == "pressure"
    return unexplained or any(c.stage == "ep" for c in diagnosis.causes)


def _records(series: Series) -> list[tuple[str, str]]:
    """Name and a line of facts of each recording."""
    which = np.zeros(series.time_s.size, dtype=np.int64) if series.record is None else series.record
    rows: list[tuple[str, str]] = []
    for number_, label in enumerate(series.names):
        at = np.flatnonzero(which == number_)
        if at.size > 1:
            duration = float(series.time_s[at[-1]] - series.time_s[at[0]])
            rate = (at.size - 1) / duration if duration > 0 else float("nan")
            held = 100.0 * float(np.mean(series.heldout[at]))
            rows.append((label, f"{at.size:,} rows, {duration:,.0f} s at {rate:.3g} Hz, {held:.0f} % held out in turn"))
    return rows
