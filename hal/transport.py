"""Bytes out, bytes in: serial ports and pseudo-terminals (opened by pyserial, then read raw) and TCP sockets."""

from __future__ import annotations

import contextlib
import errno
import math
import os
import select
import socket
import sys
import termios
from pathlib import Path
from typing import Protocol

from hal.errors import PortFault
from hal.port import PortName
from hal.profile import Serial


class SettingRefused(PortFault):
    """The port is there, and its driver cannot do these line settings."""


class Transport(Protocol):
    """A line of bytes. Raises: `PortFault` from everything but `close` when the port is gone."""

    def open(self) -> None: ...

    def close(self) -> None: ...

    def write(self, data: bytes) -> None: ...

    def read(self, timeout_s: float) -> bytes:
        """What has arrived, after waiting at most `timeout_s` for the first byte; b"" when nothing came."""


class FdTransport:
    """What ports and sockets have in common: a non-blocking file descriptor that can be polled."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._fd = -1
        self._readable = select.poll()
        self._writable = select.poll()

    def _attach(self, fd: int) -> None:
        self._fd = fd
        self._readable = select.poll()
        self._readable.register(fd, select.POLLIN)
        self._writable = select.poll()
        self._writable.register(fd, select.POLLOUT)

    def _detach(self) -> None:
        """A closed descriptor's number may soon be somebody else's file."""
        self._fd = -1
        self._readable = select.poll()
        self._writable = select.poll()

    def read(self, timeout_s: float) -> bytes:
        # Rounding up keeps a short rest of a timeout from becoming a busy loop.
        if not self._readable.poll(math.ceil(timeout_s * 1000.0) if timeout_s > 0.0 else 0):
            return b""
        try:
            data = os.read(self._fd, 4096)
        except BlockingIOError:
            return b""
        except OSError as error:
            raise self._gone(error) from error
        if not data:  # readable and yet nothing to read: the other end has hung up
            raise self._gone(None)
        return data

    def write(self, data: bytes) -> None:
        while data:
            try:
                data = data[os.write(self._fd, data) :]
            except BlockingIOError:
                if not self._writable.poll(1000):
                    raise PortFault(f"port {self.name} takes no bytes; is flow control on?") from None
            except OSError as error:
                raise self._gone(error) from error

    def _gone(self, error: OSError | None) -> PortFault:
        detail = f" ({error.strerror})" if error and error.strerror else ""
        return PortFault(f"port {self.name} is gone{detail}: unplugged, or the other end has closed it")


class SerialTransport(FdTransport):
    """A serial port or pty, opened for this process alone as far as the system can promise it."""

    def __init__(self, name: str, settings: Serial) -> None:
        super().__init__(name)
        self._settings = settings
        self._serial: object | None = None

    def open(self) -> None:
        """Raises: `PortFault` with what to do: no such port, no permission, busy, not a serial port."""
        import serial

        s = self._settings
        try:
            parity = parity_of(self.name, s)
            port = serial.Serial(self.name, s.baud, parity=parity, stopbits=s.stop_bits, timeout=0, exclusive=True)
        except termios.error as error:
            line = f"{s.baud} 8{s.parity}{s.stop_bits}"
            raise SettingRefused(f"port {self.name} cannot be set to {line}; its driver refuses that") from error
        except (serial.SerialException, OSError, ValueError) as error:
            raise PortFault(_why_not(self.name, error)) from error
        with contextlib.suppress(AttributeError, ValueError, OSError):  # not every adapter has such a mode
            port.set_low_latency_mode(True)  # an FTDI adapter otherwise holds bytes back for up to 16 ms
        self._serial = port
        self._attach(port.fileno())

    def close(self) -> None:
        self._detach()
        if self._serial is not None:
            with contextlib.suppress(OSError):
                self._serial.close()  # type: ignore[attr-defined]
            self._serial = None


class TcpTransport(FdTransport):
    """A TCP connection that carries the bytes as they are."""

    def __init__(self, port: PortName, connect_timeout_s: float = 3.0) -> None:
        super().__init__(port.text)
        self._address = (port.host, port.number)
        self._connect_timeout_s = connect_timeout_s
        self._socket: socket.socket | None = None

    def open(self) -> None:
        """Raises: `PortFault` when nobody listens there."""
        try:
            link = socket.create_connection(self._address, timeout=self._connect_timeout_s)
        except OSError as error:
            reason = error.strerror or str(error)
            number = self._address[1]  # the name may leave it out
            tried = "" if self.name.rstrip("/").endswith(f":{number}") else f", TCP port {number} tried"
            raise PortFault(
                f"port {self.name} cannot be reached ({reason}{tried}); is the gateway on, and the address right?"
            ) from error
        link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        link.setblocking(False)
        self._socket = link
        self._attach(link.fileno())

    def close(self) -> None:
        self._detach()
        if self._socket is not None:
            self._socket.close()
            self._socket = None


def parity_of(name: str, settings: Serial) -> str:
    """The parity to open the port with: none on a pseudo-terminal, which has no bits and cannot be set to any.

    Source: Linux, admin-guide/devices: character devices 136 to 143 are the slaves of pseudo-terminals.
    """
    try:
        pseudo = sys.platform == "linux" and 136 <= os.major(Path(name).stat().st_rdev) <= 143
    except OSError:
        pseudo = False
    return "N" if pseudo else settings.parity


def _why_not(name: str, error: Exception) -> str:
    number = getattr(error, "errno", None)
    if number == errno.ENOENT:
        return f"there is no port {name}; `lostmotion ports` lists the ports of this machine"
    if number in (errno.EACCES, errno.EPERM):
        return f"no permission to open port {name}; add your user to the group that owns it (often dialout)"
    if number in (errno.EBUSY, errno.EAGAIN) or "exclusively lock" in str(error):
        return f"port {name} is busy: another program has it open; close that one first"
    if number in (errno.ENOTTY, errno.EINVAL, errno.EISDIR, errno.ENXIO) or "configure port" in str(error):
        return f"{name} is not a serial port; `lostmotion ports` lists the ports of this machine"
    return f"port {name} cannot be opened: {error}"


def make_transport(port: PortName, settings: Serial) -> Transport:
    """The transport for a port name; nothing is opened yet."""
    return SerialTransport(port.text, settings) if port.kind == "serial" else TcpTransport(port)
