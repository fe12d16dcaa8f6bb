"""The program, called as anybody calls it, on one thread, so that several may run side by side."""

from __future__ import annotations

import os
import subprocess
import sys

LIMIT_S = 900.0
_ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


def call(*words: str) -> None:
    """`lostmotion` with these words.

    Raises: `subprocess.CalledProcessError` with what it said where it ends with an error, `subprocess.TimeoutExpired`
    where it has not ended after `LIMIT_S`.
    """
    command, environment = [sys.executable, "-m", "app", *words], os.environ | _ONE_THREAD
    subprocess.run(command, env=environment, check=True, capture_output=True, text=True, timeout=LIMIT_S)
