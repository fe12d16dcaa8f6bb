"""Names of ports: `/dev/ttyUSB0`, a pty, `COM3`, `rtu+tcp://HOST:PORT`, `tcp://HOST:PORT`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from hal.errors import BadInput


@dataclass(frozen=True, slots=True)
class PortName:
    """Where the bench is. `kind`: `serial` (RTU on a tty), `rtu+tcp` (RTU frames in a socket), `tcp` (Modbus TCP)."""

    kind: str
    text: str
    host: str = ""
    number: int = 0


def parse_port(text: str) -> PortName:
    """Raises: `BadInput` for a URL that is none of the forms above, or HOST:PORT without its kind."""
    if "://" not in text:
        if not text.strip():
            raise BadInput("the port is empty; `lostmotion ports` lists the serial ports")
        if re.fullmatch(r"[^/\s]+:\d+", text) and not Path(text).exists():
            raise BadInput(
                f"port '{text}' is no serial port of this machine; a TCP port is written tcp://{text}, "
                f"or rtu+tcp://{text} for RTU frames"
            )
        return PortName("serial", text)
    parts = urlsplit(text)
    if parts.scheme not in ("rtu+tcp", "tcp"):
        raise BadInput(
            f"port '{text}': unknown kind '{parts.scheme}'; use a path, rtu+tcp://HOST:PORT or tcp://HOST:PORT"
        )
    try:
        number = parts.port if parts.port is not None else 502
    except ValueError as error:
        raise BadInput(f"port '{text}': the TCP port must be a number from 1 to 65535") from error
    if not parts.hostname or not 1 <= number <= 65535 or parts.path.strip("/"):
        raise BadInput(f"port '{text}' must look like {parts.scheme}://HOST:PORT")
    return PortName(parts.scheme, text, parts.hostname, number)


def list_serial_ports() -> list[dict[str, str]]:
    """The serial ports of this machine as plain values: `port`, `description`, `serial_number`, `by_id`."""
    from serial.tools.list_ports import comports

    stable = {str(link.resolve()): str(link) for link in sorted(Path("/dev/serial/by-id").glob("*"))}
    return [
        {
            "port": port.device,
            "description": port.description if port.description not in (None, "n/a") else "serial port",
            "serial_number": port.serial_number or "",
            "by_id": stable.get(port.device, ""),
        }
        for port in sorted(comports(), key=lambda port: port.device)
    ]
