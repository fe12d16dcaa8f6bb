"""Lines typed while something else goes on: nobody waits for the keyboard, because a bench has to be served."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Iterator


def typed_lines() -> Iterator[str | None]:
    """Lines of standard input as they come; None each time nothing has been typed. Ends with the input.

    A last line need not end with a newline.
    """
    stdin, text = sys.stdin.fileno(), ""
    while True:
        line, newline, rest = text.partition("\n")
        if newline:
            text = rest
            yield line.strip()
        elif select.select([stdin], [], [], 0.0)[0]:
            data = os.read(stdin, 4096)
            if not data:
                if text.strip():
                    yield text.strip()
                return
            text += data.decode("utf-8", "replace")
        else:
            yield None
