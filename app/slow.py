"""A word to the operator when something takes unusually long, so that nobody takes it for a hang."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

import click

# The timer does not know whether numba compiles or a busy machine only loads what was compiled before.
STARTING = "starting the virtual valve; the first time after an installation it is compiled, which takes up to a minute"


@contextmanager
def say_if_slow(text: str, after_s: float = 1.5, say: Callable[[str], None] | None = None) -> Iterator[None]:
    """Says `text` when what is done inside takes longer than `after_s` of real time."""
    timer = threading.Timer(after_s, say or partial(click.echo, err=True), (text,))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
