"""The table of everything that can be wrong with a virtual valve, for the documentation."""

from __future__ import annotations

from sim_device.physics.catalog import imperfections, names, parameters
from sim_device.physics.imperfection import Imperfection

HEAD = ("effect", "stage", "small / medium / large", "what is done", "forms")


def markdown(plant: str) -> str:
    """The Markdown table of plant `plant`: effects, then design numbers, then outsiders."""
    known = imperfections(plant)
    items = [item for item in known if not item.outsider]
    items += [*parameters(plant), *(item for item in known if item.outsider)]
    lines = [_row(HEAD), _row(["---"] * len(HEAD)), *(_row(_cells(item)) for item in items)]
    return "\n".join(lines) + "\n"


def _cells(item: Imperfection) -> list[str]:
    unit = "" if item.unit == "1" else f" {item.unit}"
    sizes = " / ".join(f"{size:g}" for size in item.sizes) + unit
    name = f"`{item.name}`" + (" (outsider)" if item.outsider else "")
    forms = ", ".join(item.forms) if len(item.forms) > 1 else ""
    return [name, item.stage, ("± " if item.signed else "") + sizes, item.claim, forms]


def _row(cells: list[str] | tuple[str, ...]) -> str:
    return "| " + " | ".join(cells) + " |"


def refreshed(text: str) -> str:
    """`text` with the table between each pair of marks `<!-- PLANT -->` and `<!-- end -->` made anew."""
    parts = text.split("<!-- ")
    for index, part in enumerate(parts):
        plant, mark, _ = part.partition(" -->\n")
        if mark and plant in names():
            parts[index] = f"{plant} -->\n{markdown(plant)}"
    return "<!-- ".join(parts)
