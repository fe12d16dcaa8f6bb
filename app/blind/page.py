"""The blind check as one self-contained HTML page: figures with intervals, the calibration curve, every trial."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from app.blind.strength import STRATA
from app.blind.table import fault_rows, number, rows

_TEMPLATE = Path(__file__).parent / "page.html.j2"
_SIZE, _EDGE = 260, 34  # the calibration plot and its margin [px]


def write_page(
    scores: Mapping[str, Any], lines: Sequence[Mapping[str, Any]], protocol: Mapping[str, Any], path: Path
) -> None:
    """Writes the page; it refers to nothing outside itself."""
    path.write_text(render(scores, lines, protocol), encoding="utf-8")


def render(scores: Mapping[str, Any], lines: Sequence[Mapping[str, Any]], protocol: Mapping[str, Any]) -> str:
    """The page as text; the same input gives the same text."""
    import jinja2

    environment = jinja2.Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    groups = {"All trials": scores["all"]}
    if len(scores["families"]) > 1:
        groups |= {f"Family {name}": group for name, group in scores["families"].items()}
    return environment.from_string(_TEMPLATE.read_text(encoding="utf-8")).render(
        protocol=protocol,
        trials=scores["trials"],
        broken=scores["broken"],
        groups=[(title, rows(group), _plot(group["calibration"])) for title, group in groups.items()],
        strata=STRATA,
        faults=fault_rows(scores["all"], STRATA),
        confusion=confusion_matrix(scores["all"]["confusion"]),
        table=[_trial(line) for line in lines if "error" not in line],
    )


def confusion_matrix(entries: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Answers as columns and truths as rows, with the count and whether it is the diagonal."""
    truths = sorted({str(entry["truth"]) for entry in entries})
    said = sorted({str(entry["said"]) for entry in entries})
    counts = {(entry["truth"], entry["said"]): entry["count"] for entry in entries}
    meant = {"none": "no_gap", "outsider": "unexplained"}
    return {
        "said": said,
        "rows": [(t, [(counts.get((t, s), 0), s == meant.get(t, t)) for s in said]) for t in truths],
    }


def _plot(calibration: Mapping[str, Any]) -> list[dict[str, float]]:
    """The points of the calibration curve in pixels, with their interval bars."""

    def x(value: float) -> float:
        return round(_EDGE + value * (_SIZE - 2 * _EDGE), 1)

    return [
        {
            "x": x(point["said"]),
            "y": _SIZE - x(point["right"]),
            "low": _SIZE - x(point["ci95"][0]),
            "high": _SIZE - x(point["ci95"][1]),
            "radius": round(min(3.0 + point["claims"] ** 0.5 / 2.0, 9.0), 1),
            "claims": point["claims"],
        }
        for point in calibration["curve"]
    ]


def _trial(line: Mapping[str, Any]) -> dict[str, Any]:
    """A row of the table of all trials."""
    label = line["label"]
    truth = " + ".join(f"{c['name']} ({c['form']}) {number(c['size'])} {c['unit']}" for c in label["causes"])
    causes = ", ".join(f"{c['name']} {c['probability']:.2f}" for c in line["causes"])
    return {
        "number": line["trial"],
        "seal": line["seal"],
        "family": label["family"],
        "kind": label["kind"],
        "truth": truth or "nothing",
        "ratio": number(line["ratio"]),
        "said": causes or line["verdict"],
        "right": line["mark"]["right"],
        "closed": number(line["closed_loop"]["closed"]),
        "commitment": line["commitment"][:12],
    }
