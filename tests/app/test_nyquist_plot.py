"""The Nyquist picture can be read: a colour and a name with units for every curve, marked intersections."""

from __future__ import annotations

from matplotlib.figure import Figure as Canvas

from app.gallery.figure import Number
from app.gallery.nyquist_plot import nyquist
from app.gallery.page import _pivot
from app.hunting import gains
from control.analysis.limit_cycle import predict
from control.analysis.loop import LinearLoop
from control.design import DesignModel

DESIGN = DesignModel()


def test_every_curve_has_a_colour_and_a_name_of_its_own() -> None:
    loops = [loop for loop in gains(LinearLoop("p", 3.0)) if loop.law == "pi"]
    axes = Canvas().subplots()
    nyquist(axes, loops, DESIGN)
    curves = {str(line.get_label()): line for line in axes.get_lines() if not str(line.get_label()).startswith("_")}
    assert len(curves) == len(loops) + 1
    assert len({str(line.get_color()) for line in curves.values()}) == len(curves)
    assert all("psi/in" in name and "psi/(in s)" in name for name in curves if name.startswith("PI"))
    assert axes.get_aspect() == 1.0


def test_an_intersection_is_marked_and_named() -> None:
    loop = LinearLoop("p_incremental", 3.0)
    cycle = predict(loop, DESIGN)[-1]
    axes = Canvas().subplots()
    nyquist(axes, [loop], DESIGN)
    assert any(f"A = {cycle.pressure_psi:.2f} psi, {cycle.omega:.2f} rad/s" in str(x.get_label()) for x in axes.lines)
    assert sum(line.get_marker() == "o" for line in axes.lines) == len(predict(loop, DESIGN))


def test_numbers_with_other_columns_make_another_table() -> None:
    numbers = [
        Number("slow: swing", None, 1.0, "%", 1),
        Number("quick: swing", None, float("nan"), "%", 1, "none"),
        Number("quick: period", None, 2.0, "s", 1),
        Number("0.2 s: border", None, 3.0, "psi/in", 1),
        Number("all", None, 4.0, "", 0),
    ]
    lines = _pivot(numbers)
    assert "| slow | 1.0 |  |" in lines
    assert "| quick | none | 2.0 |" in lines
    assert lines.index("| | border [psi/in] |") == lines.index("| quick | none | 2.0 |") + 2
    assert lines[2].startswith("| all |")
