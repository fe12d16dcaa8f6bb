"""Where a record comes from: what goes into every start document without anyone having to think of it."""

from __future__ import annotations

import platform
import subprocess
import sys
import uuid
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from hal.clock import utc_now

_HOUSE = Path(__file__).resolve().parent.parent


def provenance() -> dict[str, object]:
    """Identity, time, arguments, versions, git state and kind of host of this process, as plain values.

    The host's name and its user are left out on purpose: records are handed to strangers.
    """
    return {
        "uuid": str(uuid.uuid4()),
        "utc": utc_now().isoformat(timespec="milliseconds"),
        "argv": sys.argv[1:],
        "version": package_version(),
        "git": git_state(),
        "python": platform.python_version(),
        "host": f"{platform.system()} {platform.machine()}",
    }


def package_version() -> str:
    try:
        return version("lostmotion")
    except PackageNotFoundError:
        return "unknown"


def git_state() -> str | None:
    """Short commit hash of the checkout the program runs from, with "-dirty" where it was edited; None outside git."""
    if not (_HOUSE / ".git").exists():
        return None
    try:
        said = subprocess.run(
            ["git", "-C", str(_HOUSE), "describe", "--always", "--dirty", "--exclude=*"],
            capture_output=True,
            text=True,
            timeout=5.0,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return said.stdout.strip() or None
