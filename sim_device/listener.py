"""The same line over a socket: Modbus TCP, and RTU frames over TCP."""

from __future__ import annotations

import contextlib
import ipaddress
import socket
import struct
import threading
from collections.abc import Callable

from hal.errors import BadInput, PortFault
from sim_device.faulty_stream import FaultyStream, mbap
from sim_device.line import Line

RTU_SCHEME, TCP_SCHEME = "rtu+tcp://", "tcp://"


def parse_address(text: str) -> tuple[str, str, int]:
    """`HOST:PORT`, `tcp://HOST:PORT` or `rtu+tcp://HOST:PORT` as (scheme, host, port).

    Raises: `BadInput`.
    """
    scheme = RTU_SCHEME if text.startswith(RTU_SCHEME) else TCP_SCHEME
    host, colon, port = text.removeprefix(scheme).rpartition(":")
    if not colon or not host or not port.isdecimal() or int(port) > 65535:
        raise BadInput(f"'{text}' is not an address to listen on; write HOST:PORT, for example 127.0.0.1:5020")
    return scheme, host.strip("[]"), int(port)


class Listener:
    """Accepts masters on `address` and serves each in a thread of its own, until closed.

    Loopback only unless `allow_remote`: a virtual valve on a network is found by things that look for real ones.
    """

    def __init__(
        self,
        address: str,
        serve_rtu: Callable[[int], None],
        line: Line,
        *,
        allow_remote: bool,
        faults: FaultyStream | None = None,
    ) -> None:
        self._scheme, host, port = parse_address(address)
        if not allow_remote and not _is_loopback(host):
            raise BadInput(f"'{host}' is not this machine's loopback address; the virtual device listens on 127.0.0.1")
        try:
            family = socket.AF_INET6 if ":" in host else socket.AF_INET
            self._socket = socket.create_server((host, port), family=family, backlog=8)
        except OSError as error:
            raise PortFault(f"cannot listen on {host}:{port}: {error.strerror or error}; choose another") from error
        shown = f"[{host}]" if ":" in host else host
        self.url = f"{self._scheme}{shown}:{self._socket.getsockname()[1]}"
        self._serve_rtu = serve_rtu
        self._line = line
        self._faults = faults
        self._closing = threading.Event()
        self._connections: set[socket.socket] = set()
        self._threads: list[threading.Thread] = []
        self._accepting = threading.Thread(target=self._accept, name="virtual-device-accept", daemon=True)
        self._accepting.start()

    def close(self) -> None:
        self._closing.set()
        for item in (self._socket, *self._connections):
            with contextlib.suppress(OSError):
                item.shutdown(socket.SHUT_RDWR)
        self._socket.close()
        for thread in (self._accepting, *self._threads):
            thread.join(timeout=2.0)

    def _accept(self) -> None:
        while True:
            try:
                connection, _ = self._socket.accept()
            except OSError:
                return
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._connections.add(connection)
            thread = threading.Thread(target=self._serve, args=(connection,), name="virtual-device-tcp", daemon=True)
            self._threads = [item for item in self._threads if item.is_alive()] + [thread]
            thread.start()

    def _serve(self, connection: socket.socket) -> None:
        with connection, contextlib.suppress(OSError):
            if self._scheme == RTU_SCHEME:
                self._serve_rtu(connection.fileno())
            else:
                serve_mbap(connection, self._line, self._send)
        self._connections.discard(connection)

    def _send(self, connection: socket.socket, number: int, unit: int, pdu: bytes) -> None:
        """Sends a reply; what is behind it waits as long as a late one does, because a slave answers in order."""
        data = mbap(number, unit, pdu)
        if self._faults is not None:
            emission = self._faults.emit(number, unit, pdu)
            self._closing.wait(emission.delay_s)
            data = emission.data
        connection.sendall(data)


def serve_mbap(connection: socket.socket, line: Line, send: Callable[[socket.socket, int, int, bytes], None]) -> None:
    """Answers Modbus TCP requests until the far end closes, or sends what cannot be a request (then hangs up).

    Source: Modbus Messaging on TCP/IP V1.0b, section 3.1.3.
    """
    with connection.makefile("rb") as stream:
        while True:
            head = stream.read(7)
            if len(head) < 7:
                return
            transaction, protocol, length, unit = struct.unpack(">HHHB", head)
            if protocol != 0 or not 2 <= length <= 254:
                return  # out of step: there is no way to find the next header in a stream
            pdu = stream.read(length - 1)
            if len(pdu) < length - 1:
                return
            reply = line.tcp(unit, pdu)
            if reply is not None:
                send(connection, transaction, unit, reply)


def _is_loopback(host: str) -> bool:
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
