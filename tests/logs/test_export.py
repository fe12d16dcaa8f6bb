"""Export into what is no file."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest

from logs.export import write_csv
from logs.run import Run


@pytest.mark.skipif(sys.platform != "linux", reason="needs /proc/self/fd")
def test_a_pipe_is_written_to_and_not_replaced() -> None:
    run = Run(path=Path("x"), start={}, columns={"time_s": np.arange(3.0)}, units={"time_s": "s"})
    reader, writer = os.pipe()
    write_csv(run, Path(f"/proc/self/fd/{writer}"))
    os.close(writer)
    with os.fdopen(reader) as pipe:
        assert pipe.read().split() == ["time_s", "0", "1", "2"]
