"""A serial line that is not there: a pseudo-terminal whose far end is the virtual device."""

from __future__ import annotations

import contextlib
import errno
import os
import tty
from pathlib import Path

from hal.errors import PortFault


class PseudoTerminal:
    """`path` is what a master opens as its port; `fd` is the device's end. `link` is an optional stable name for it.

    Raw from the start (the default of a pty echoes and swallows control bytes). One descriptor of the master's side
    stays open here, because otherwise reading fails with EIO whenever no master is connected.
    """

    def __init__(self, link: Path | None = None) -> None:
        self.fd, self._kept_open = os.openpty()
        tty.setraw(self._kept_open)
        self.path = os.ttyname(self._kept_open)
        self._link = None
        if link is not None:
            try:
                _replace_link(link, self.path)
            except PortFault:
                self.close()
                raise
            self._link = link

    @property
    def port(self) -> str:
        """The name to give to a master: the link when there is one."""
        return str(self._link) if self._link is not None else self.path

    def close(self) -> None:
        """Removes the link, if it is still ours, and hangs up."""
        if self._link is not None and os.path.realpath(self._link) == self.path:
            with contextlib.suppress(FileNotFoundError):
                self._link.unlink()
        self._link = None
        for descriptor in (self.fd, self._kept_open):
            os.close(descriptor)


def _replace_link(link: Path, target: str) -> None:
    """A dangling or stale link is replaced; a file that is not a link is somebody's data and stays.

    Raises: `PortFault`.
    """
    try:
        if link.is_symlink():
            link.unlink()
        link.symlink_to(target)
    except OSError as error:
        reason = "a file of that name exists" if error.errno == errno.EEXIST else (error.strerror or str(error))
        raise PortFault(f"cannot make the port link {link}: {reason}; choose another --port-link") from error
