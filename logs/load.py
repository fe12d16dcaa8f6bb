"""Any recording as arrays: a run folder, or a stranger's CSV or Parquet with its own names, units and defects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from hal.counted import counted
from hal.errors import BadInput
from logs import own_times
from logs.assemble import Signals, assemble
from logs.layout import is_run_folder
from logs.long_form import by_tag
from logs.recording import CommandTiming, DataNote, FloatArray, Recording
from logs.roles import NEEDED, QUANTITY, ROLES, Column, Role, assign, parse_pairs, split_header
from logs.run import Run, read_run
from logs.spoken import WRITTEN
from logs.table import Table, read_table
from logs.times import unwrap
from logs.units import HOUSE_UNIT, PERCENT, Conversion, conversion, plain_name


def load_recording(
    path: Path, *, mapping: str | None = None, units: str | None = None, command_timing: CommandTiming = "before"
) -> Recording:
    """Reads `path` into house units (psi, in, s; percent where the file is in percent), checked.

    `mapping` is "time=COL,command=COL,pressure=COL,position=COL,target=COL" ("pressure=" leaves it out), `units` is
    "command=kPa,position=mm,time=ms"; both win over what the headers say. A file with timing "after" is turned into
    "before", so that a recording only ever has the timing "before" or "unknown".
    Raises: `BadInput` with file, row and value for what cannot be used; everything repaired is in `Recording.notes`.
    """
    folder = path if path.is_dir() else path.parent if path.name in ("run.json", "samples.arrows") else None
    given = parse_pairs(units, "--units")
    if folder is None:
        return _load_table(path, parse_pairs(mapping, "--map"), given, command_timing)
    if not is_run_folder(folder):
        raise BadInput(f"{folder}: a folder without run.json is no run; name a run folder, a CSV or a Parquet file")
    if mapping or units:
        raise BadInput(f"{folder}: a recorded run knows its columns and units; leave out --map and --units")
    return recording_of_run(read_run(folder), command_timing)


def recording_of_run(run: Run, command_timing: CommandTiming = "before") -> Recording:
    """The samples of a run in house units, checked and with data-quality notes; of an imported file, as read.

    Raises: `BadInput` when a needed column is missing or no sample is usable.
    """
    if run.imported is not None:
        return run.imported
    where = str(run.path)
    if run.rows < 2:
        held = counted(run.rows, "sample")
        raise BadInput(f"{where}: the run holds {held} ({run.reason}); a recording needs at least 2")
    names = [name for name in run.columns if not name.startswith("next_")]
    columns = assign(names, _as_we_name_them(names), where)
    stated = {role: run.units.get(column.header) or column.unit for role, column in columns.items()}
    notes = _expired(run.start)
    if "pressure" in columns and plain_name(stated["command"]) == PERCENT != plain_name(stated["pressure"]):
        # A positioner is told a position; its command and a pressure have no unit in common.
        notes += (DataNote("the command is a position in percent", "the pressure is left out of the recording"),)
        del columns["pressure"], stated["pressure"]
    signals = Signals(
        values={role: run.columns[column.header] for role, column in columns.items()},
        conversions=_conversions(columns, stated, where),
        headers={role: column.header for role, column in columns.items()},
        quality={name: run.columns[name] for name in names if name == "quality" or name.endswith("_quality")},
        notes=notes,
    )
    # A positioner is told a position in percent; a converter on a bench of this house is told a pressure.
    positioner = plain_name(stated["command"]) == PERCENT
    meta = {
        "positioner": positioner,
        "run": run.start,
        "status": run.status,
        "reason": run.reason,
        "problems": run.problems,
    }
    return assemble(signals, name=run.name, where=where, command_timing=command_timing, meta=meta)


def _conversions(columns: Mapping[Role, Column], stated: Mapping[Role, str], where: str) -> dict[Role, Conversion]:
    """How each column becomes one in house units. Raises: `BadInput` with the file and the column."""
    found = {}
    for role, unit in stated.items():
        try:
            found[role] = conversion(unit, QUANTITY[role])
        except BadInput as error:
            raise BadInput(f"{where}: column '{columns[role].header}': {error}") from error
    return found


def _expired(start: Mapping[str, object]) -> tuple[DataNote, ...]:
    """A note where the run's calibration had expired on the day of the run."""
    profile = start.get("profile")
    calibration = profile.get("calibration") if isinstance(profile, Mapping) else None
    if not isinstance(calibration, Mapping):
        return ()
    until = calibration.get("expires")
    if not isinstance(until, str) or str(start.get("utc", ""))[:10] <= until:  # both are ISO dates
        return ()
    what = f"calibration '{calibration.get('id')}' had expired on {until}, before this was recorded"
    return (DataNote(what, "positions are kept as they are"),)


def _as_we_name_them(names: Sequence[str]) -> dict[Role, str]:
    """The columns of a run on our own bench, which need no guesses; none where it is in other units."""
    ours: dict[Role, str] = {role: f"{role}_{HOUSE_UNIT[QUANTITY[role]]}" for role in ROLES}
    if any(ours[role] not in names for role in NEEDED):
        return {}
    return {role: name if name in names else "" for role, name in ours.items()}


def _load_table(
    path: Path, mapping: Mapping[Role, str], units: Mapping[Role, str], command_timing: CommandTiming
) -> Recording:
    table = by_tag(read_table(path))
    if not table.has_header and not mapping:
        raise BadInput(
            f"{path}: the file has no header; add a line such as time_s,command_psi,position_in, "
            "or name the columns by number, as in --map time=1,command=2,position=3"
        )
    columns = assign(table.headers, mapping, str(path))
    stated = {role: _unit(role, columns, units, table) for role in columns}
    conversions = _conversions(columns, stated, str(path))
    values, own = _values(table, columns, "time" in mapping, conversions["time"].scale)
    signals = Signals(
        values=values,
        conversions=conversions,
        headers={role: column.header for role, column in columns.items()},
        unsaid=tuple(role for role, unit in stated.items() if not unit),
        notes=(*table.notes, *_said_instead(table, columns), *own),
        locate=table.locate,
    )
    foreign = tuple(role for role, unit in stated.items() if _foreign(signals, role, unit))
    meta = {"file": str(path), "foreign": foreign, WRITTEN: stated}
    return assemble(signals, name=path.stem, where=str(path), command_timing=command_timing, meta=meta)


def _values(
    table: Table, columns: Mapping[Role, Column], one_time: bool, unit_s: float
) -> tuple[Mapping[Role, FloatArray], tuple[DataNote, ...]]:
    """The columns as numbers, in the rows of the position where each has times of its own and none is chosen for all.

    `unit_s`: that of the times [s]. Raises: `BadInput` where those are written in different ways.
    """
    clock = {} if one_time else own_times.clocks(table.headers, columns)
    kinds = {(table.is_calendar(header), _written(own_times.clock(header), table)) for header in clock.values()}
    if len(kinds) > 1:
        named = " and ".join(f"'{header}'" for header in dict.fromkeys(clock.values()))
        raise BadInput(
            f"{table.where}: the times in {named} are not written alike; give them one unit, or map one time"
        )
    raw = {role: table.number(header, since_first=False) for role, header in clock.items()}
    if not raw or own_times.in_step(raw):
        return {role: table.number(column.header) for role, column in columns.items()}, ()
    # each clock runs over, or passes midnight, in a row of its own
    lifted = {role: unwrap(times, unit_s) for role, times in raw.items()}
    values = {role: table.number(columns[role].header) for role in raw}
    found = own_times.at_positions(values, {role: times for role, (times, _) in lifted.items()})
    return found, (own_times.note(columns, found["time"].size), *lifted["position"][1])


def _said_instead(table: Table, columns: Mapping[Role, Column]) -> Iterator[DataNote]:
    """What a historian wrote instead of readings; a row without a time is said to be one elsewhere."""
    for column in (column for role, column in columns.items() if role != "time"):
        for word, (count, first) in table.states(column.header).items():
            yield DataNote(f"{column.header}: '{word}' in place of a value", "taken as missing", count, first)


def _foreign(signals: Signals, role: Role, unit: str) -> bool:
    """Whether a column was written in another unit than the house's; a range says what it stands for itself."""
    return signals.conversions[role].scale != 1.0 and "(" not in unit


def _unit(role: Role, columns: Mapping[Role, Column], units: Mapping[Role, str], table: Table) -> str:
    """The unit of a column: as the operator says, as the file says, as its partner's is; "" where nobody says."""
    if table.is_calendar(columns[role].header):
        return "s"
    if role in units:
        return units[role]
    own = _written(columns[role], table)
    partner = _PARTNER.get(role)
    if partner is None or partner not in columns:
        return own
    beside = _written(columns[partner], table)
    # The operator's word on one of a pair holds for both where the file treats them alike, or is silent on this one.
    return (units.get(partner) or own or beside) if own in ("", beside) else own


_PARTNER: Mapping[Role, Role] = {
    "command": "pressure",
    "pressure": "command",
    "position": "target",
    "target": "position",
}


def _written(column: Column, table: Table) -> str:
    return table.header_units.get(column.header, "") or column.unit


def headers_of(path: Path) -> tuple[Column, ...]:
    """The columns of a stranger's file, for telling an operator what could be mapped."""
    return tuple(split_header(header) for header in read_table(path).headers)
