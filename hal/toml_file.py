"""TOML files as editors leave them: some begin a UTF-8 file with a mark (BOM) that TOML itself does not know."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any


def toml_text(path: Path) -> str:
    """The text of a file, without the mark. Raises: `OSError`; `tomllib.TOMLDecodeError` where it is no UTF-8."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise tomllib.TOMLDecodeError(f"byte {error.start + 1} is not UTF-8; save the file as UTF-8") from error


def read_toml(path: Path) -> dict[str, Any]:
    """What a file says. Raises: `OSError`; `tomllib.TOMLDecodeError` where it is no TOML."""
    return tomllib.loads(toml_text(path))
