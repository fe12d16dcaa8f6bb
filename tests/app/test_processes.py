"""Several processes: the same results in the same order, and none left when it ends."""

from __future__ import annotations

import math
import multiprocessing
import os
import time
from collections.abc import Generator
from typing import Any, cast

import pytest

from app.processes import in_order
from hal.errors import JobFailed


def test_results_come_in_the_order_of_the_work() -> None:
    todo = [30, 2, 20, 1]
    assert list(in_order(math.factorial, todo, 2)) == list(in_order(math.factorial, todo, 1))


def test_left_early_no_process_stays() -> None:
    """Not even one that is in the middle of something long."""
    results = cast("Generator[None, Any, None]", in_order(time.sleep, [0.0, 60.0, 60.0], 2))
    assert next(results) is None
    assert multiprocessing.active_children()
    results.close()
    # Killed; but it is a thread of the pool that buries it, which has to get its turn.
    until = time.monotonic() + 30.0
    while multiprocessing.active_children() and time.monotonic() < until:
        time.sleep(0.01)
    assert not multiprocessing.active_children()


def test_a_worker_that_is_killed_is_said() -> None:
    with pytest.raises(JobFailed, match="a worker was killed"):
        list(in_order(os._exit, [3], 2))
