"""What a run looks like in rerun: which column goes where, and in which colour."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from logs.plane import Colour, Plane, design_curves
from logs.recording import FloatArray

if TYPE_CHECKING:
    import rerun as rr

ASKED: Colour = (110, 168, 254)
MEASURED: Colour = (255, 166, 64)
ERROR: Colour = (240, 98, 146)
CLOSING: Colour = (129, 199, 132)
OPENING: Colour = (186, 140, 255)
OTHERS: tuple[Colour, ...] = ((77, 208, 225), (255, 213, 79), (174, 213, 129), (244, 143, 177), (176, 190, 197))
RISING: Colour = (150, 112, 66)
FALLING: Colour = (78, 116, 160)
LEFT_PSI, RIGHT_PSI = 6.0, 2.0  # room beside the design curves
STATES = {
    "idle": 0x78909CFF,
    "conditioning": 0x4DB6ACFF,
    "running": 0x66BB6AFF,
    "settling": 0xFFD54FFF,
    "paused": 0x90A4AEFF,
    "safe": 0x5C9DF5FF,
    "fault": 0xEF5350FF,
}
OTHER_STATE = 0xA1887FFF


@dataclass(frozen=True, slots=True)
class Group:
    """Columns that share a plot: one wide entity, one colour and one name each."""

    entity: str
    columns: tuple[str, ...]
    labels: tuple[str, ...]
    colours: tuple[Colour, ...]
    unit: str


@dataclass(frozen=True, slots=True)
class Scene:
    """Groups of columns, and the plane; made from the columns of a record and its start document."""

    groups: tuple[Group, ...]
    plane: Plane | None
    plane_x: str
    command: str
    position: str
    target: str
    curves: Mapping[str, FloatArray]

    @classmethod
    def of(
        cls, units: Mapping[str, str], start: Mapping[str, object], seen: Mapping[str, FloatArray] | None = None
    ) -> Scene:
        """`units` names the columns and their units; `start` may hold "design" and "bench"; `seen` are the samples."""
        names = {role: _first(units, role) for role in ("command", "pressure", "position", "target")}
        groups = [_pair("/pressure", units, names["command"], names["pressure"])]
        groups.append(_pair("/position", units, names["target"], names["position"]))
        taken = {*names.values(), "time_s", "next_command_psi"} | {n for n in units if n.startswith("next_")}
        groups += _timing(units, taken)
        groups += _rest(units, taken | {"lateness_s", "latency_s"})
        design = start.get("design")
        curves = design_curves(design) if isinstance(design, Mapping) else None
        x_name, y_name = names["pressure"] or names["command"], names["position"]
        bench = start.get("bench")
        info = bench if isinstance(bench, Mapping) else {}
        return cls(
            groups=tuple(group for group in groups if group.columns),
            plane=_plane(units, x_name, y_name, info, curves, seen or {}) if x_name and y_name else None,
            plane_x=x_name,
            command=names["command"],
            position=y_name,
            target=names["target"],
            curves=curves or {},
        )

    def draw_static(self, stream: rr.RecordingStream, states: Sequence[str] = ()) -> None:
        """Logs names, colours, the frame of the plane and the design curves; `states` beyond the usual ones too."""
        import rerun as rr

        for group in self.groups:
            _style(stream, group.entity, group.labels, group.colours)
        if self.target:
            _style(stream, "/error", ("error",), (ERROR,))
        colours = {**STATES, **{state: OTHER_STATE for state in states if state not in STATES}}
        words = rr.StateConfiguration(
            values=list(colours),
            labels=[state.capitalize() for state in colours],
            colors=np.array(list(colours.values()), dtype=np.uint32),
        )
        stream.log("/state/bench", words, static=True)
        if self.plane is not None:
            self.plane.draw_frame(stream)
            for name, colour in (("closing", CLOSING), ("opening", OPENING)):
                if name in self.curves:
                    line = self.curves[name].copy()
                    line[:, 0] = np.clip(line[:, 0], *self.plane.x)
                    self.plane.draw_line(stream, f"design/{name}", [line], colour, 1.3)
                    above = self.plane.y[1] + 0.06 * (self.plane.y[1] - self.plane.y[0])
                    at = (float(line[2][0]), above)
                    self.plane.name_point(stream, f"design/{name}_name", at, f"design {name}", colour)


def _style(stream: rr.RecordingStream, entity: str, names: Sequence[str], colours: Sequence[Colour]) -> None:
    import rerun as rr

    lines = rr.SeriesLines(names=list(names), colors=list(colours), widths=[1.5] * len(names))
    stream.log(entity, lines, static=True)


def _first(units: Mapping[str, str], role: str) -> str:
    """The column of a role: `pressure_psi`, `pressure_percent`, or `pressure`; "" where there is none."""
    plain = [name for name in units if name == role or name in (f"{role}_psi", f"{role}_in", f"{role}_percent")]
    return plain[0] if plain else ""


def _pair(entity: str, units: Mapping[str, str], asked: str, measured: str) -> Group:
    both = [(name, colour) for name, colour in ((asked, ASKED), (measured, MEASURED)) if name]
    columns = tuple(name for name, _ in both)
    labels = tuple(name.partition("_")[0] for name in columns)
    return Group(entity, columns, labels, tuple(colour for _, colour in both), units[columns[0]] if columns else "")


def _timing(units: Mapping[str, str], taken: set[str]) -> list[Group]:
    names = tuple(name for name in ("lateness_s", "latency_s") if name in units and name not in taken)
    return [Group("/timing", names, tuple(name[:-2] for name in names), OTHERS[: len(names)], "s")] if names else []


def _rest(units: Mapping[str, str], taken: set[str]) -> list[Group]:
    """Every other column in a plot of its own, so that nothing recorded stays unseen."""
    rest = [name for name in units if name not in taken]
    return [
        Group(f"/aux/{name}", (name,), (name,), (OTHERS[number % len(OTHERS)],), units[name])
        for number, name in enumerate(rest)
    ]


def _plane(
    units: Mapping[str, str],
    x_name: str,
    y_name: str,
    info: Mapping[str, object],
    curves: Mapping[str, FloatArray] | None,
    seen: Mapping[str, FloatArray],
) -> Plane:
    """The frame: around the design curves and the samples where there are any, else what the bench can do."""
    low, high = (0.0, 100.0) if units[x_name] == "percent" else (3.0, 15.0)
    bottom, top = 0.0, 100.0 if units[y_name] == "percent" else _number(info.get("travel_in"), 0.5625)
    if curves:
        least, most = _number(info.get("command_min"), low), _number(info.get("command_max"), high)
        low = max(min(least, low), float(curves["opening"][1, 0]) - LEFT_PSI)
        high = min(max(most, high), float(curves["closing"][2, 0]) + RIGHT_PSI)
        top = float(curves["closing"][2, 1])
    elif not seen:
        low, high = _number(info.get("command_min"), low), _number(info.get("command_max"), high)
    low, high = _widened(low, high, seen.get(x_name))
    bottom, top = _widened(bottom, top, seen.get(y_name))
    margin = 0.06 * (top - bottom)
    return Plane(
        x=(low, high),
        y=(bottom - margin, top + margin),
        x_label=f"{x_name.partition('_')[0]} [{units[x_name]}]",
        y_label=f"position [{units[y_name]}]",
    )


def _widened(low: float, high: float, values: FloatArray | None) -> tuple[float, float]:
    """A range that holds the samples too, but for the wildest thousandth."""
    good = np.zeros(0) if values is None else values[np.isfinite(values)]
    if not good.size:
        return low, high
    least, most = np.percentile(good, (0.05, 99.95))
    return min(low, float(least)), max(high, float(most))


def _number(value: object, other: float) -> float:
    return float(value) if isinstance(value, int | float) else other
