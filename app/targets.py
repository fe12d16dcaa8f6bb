"""Where a verb may write: found out before any work is done, and never over what it reads or what was recorded."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile

from hal.errors import BadInput


def check_file(option: str, path: Path, inputs: Iterable[Path | None] = (), *, parents: bool = False) -> None:
    """Whether `path` can be written without a loss; `parents`: its folders will be made. Leaves nothing behind.

    Raises: `BadInput` when it is one of `inputs` or a file of a recorded run, by whatever name, or cannot be written.
    """
    try:
        _check_harmless(option, path, inputs)
        if path.exists():
            _probe_file(path)
        elif parents or path.parent.is_dir():
            _probe(path.parent)
        else:
            raise FileNotFoundError(0, f"there is no folder {path.parent}")
    except OSError as error:
        raise BadInput(
            f"{option} {path}: cannot be written ({error.strerror}); name a file in a folder that exists"
        ) from error


def check_apart(targets: Mapping[str, Path | None]) -> None:
    """Raises: `BadInput` when two options name the same file to write."""
    seen: dict[Path, str] = {}
    for option, path in targets.items():
        if path is None:
            continue
        other = seen.setdefault(path.resolve(), option)
        if other != option:
            raise BadInput(f"{option} {path}: {other} writes this file, too; name another")


def check_folder(option: str, folder: Path, inputs: Iterable[Path | None] = (), *, writes: Iterable[str] = ()) -> None:
    """Whether files `writes` can be written into `folder`, which may have to be made; leaves nothing behind.

    Raises: `BadInput` when one of them is among `inputs` or belongs to a recorded run, or the folder is of no use.
    """
    inputs = list(inputs)
    try:
        for name in writes:
            _check_harmless(option, folder / name, inputs)
        _probe(folder)
    except OSError as error:
        raise BadInput(
            f"{option} {folder}: no files can be written there ({error.strerror}); name another folder"
        ) from error


def check_new_run(folder: Path | None) -> None:
    """--out of the verbs that record. Raises: `BadInput` when no run can be recorded into `folder`, if one is named."""
    from logs.writer import check_empty

    if folder is not None:
        check_empty(folder)
        check_folder("--out", folder)


def _check_harmless(option: str, path: Path, inputs: Iterable[Path | None]) -> None:
    from logs.layout import RECORD, is_run_folder

    if not path.exists():
        return
    for each in inputs:
        if each is not None and each.exists() and path.samefile(each):
            raise BadInput(f"{option} {path}: it is the input {each}, and an input is never overwritten; name another")
    real = path.resolve()
    if real.name in RECORD and is_run_folder(real.parent):
        raise BadInput(f"{option} {path}: it is part of a recorded run, which is never overwritten; name another")


def _probe_file(path: Path) -> None:
    """Raises: `OSError` when the file cannot be written; a pipe or a device is not opened, for somebody may wait."""
    if path.is_file() or path.is_dir():
        with path.open("r+b"):
            pass


def _probe(folder: Path) -> None:
    """Raises: `OSError` when no file can be written into `folder`. Permissions alone do not tell (/proc)."""
    made: list[Path] = []
    try:
        for each in reversed([folder, *folder.parents]):
            if not each.exists():
                each.mkdir()
                made.append(each)
        with TemporaryFile(dir=folder):
            pass
    finally:
        for each in reversed(made):
            with suppress(OSError):
                each.rmdir()
