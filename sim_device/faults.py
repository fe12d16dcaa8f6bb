"""What a bad line does to a reply: late, noisy, flipped, lost, cut, mislabelled, refused, echoed. Seeded."""

from __future__ import annotations

import random
from dataclasses import dataclass, fields

from hal.errors import BadInput
from sim_device.crc import sealed


@dataclass(frozen=True)
class WireFaults:
    """Fractions of the replies (0 to 1, drawn independently of each other) that suffer each fault.

    A late reply waits `late_from` to `late_to` times `timeout_s` [s, real time of the line], and so does everything
    behind it, because a slave answers in order.
    """

    late: float = 0.0
    noise_before: float = 0.0
    noise_after: float = 0.0
    bit_flip: float = 0.0
    drop: float = 0.0
    truncate: float = 0.0
    wrong_unit: float = 0.0
    wrong_function: float = 0.0
    exception: float = 0.0
    local_echo: bool = False
    late_from: float = 0.9
    late_to: float = 3.5
    timeout_s: float = 0.1
    exception_code: int = 6
    exception_burst: int = 1  # how many replies in a row one exception fault refuses
    seed: int = 0

    def __post_init__(self) -> None:
        for name in FRACTIONS:
            value = getattr(self, name)
            if not 0.0 <= value <= 1.0:
                raise BadInput(f"wire fault '{name}' is {value}, but a fraction of replies lies between 0 and 1")
        if not 0.0 <= self.late_from <= self.late_to:
            raise BadInput(f"late replies from {self.late_from} to {self.late_to} timeouts: the range must not fall")

    @property
    def any(self) -> bool:
        return self.local_echo or any(getattr(self, name) > 0.0 for name in FRACTIONS)


FRACTIONS = tuple(item.name for item in fields(WireFaults) if item.default == 0.0 and isinstance(item.default, float))


@dataclass(frozen=True)
class Emission:
    """What the line carries for one reply: `data` after `delay_s` [s]; empty when the reply is lost."""

    delay_s: float
    data: bytes


class FaultyLine:
    """Applies `WireFaults` to RTU frames; the same seed and the same replies give the same faults."""

    def __init__(self, faults: WireFaults) -> None:
        self.faults = faults
        self.injected = dict.fromkeys((*FRACTIONS, "local_echo"), 0)
        self._random = random.Random(faults.seed)
        self._refusals_left = 0

    def emit(self, request: bytes, reply: bytes) -> Emission:
        """`request` and `reply` are whole frames with CRC."""
        faults = self.faults
        body = self._mislabelled(reply)
        delay_s = 0.0
        if self._strikes("late"):
            delay_s = faults.timeout_s * self._random.uniform(faults.late_from, faults.late_to)
        if self._strikes("bit_flip"):
            at = self._random.randrange(8 * len(body))
            body = body[: at // 8] + bytes((body[at // 8] ^ (1 << at % 8),)) + body[at // 8 + 1 :]
        if self._strikes("truncate"):
            body = body[: self._random.randrange(1, len(body))]
        if self._strikes("drop"):
            body = b""
        if self._strikes("noise_before"):
            body = self._noise() + body
        if self._strikes("noise_after"):
            body += self._noise()
        if faults.local_echo:
            self.injected["local_echo"] += 1
            body = request + body
        return Emission(delay_s, body)

    def _mislabelled(self, reply: bytes) -> bytes:
        """A reply that is intact on the wire and not the one that was asked for."""
        body = reply[:-2]
        if self._strikes("exception"):
            self._refusals_left = self.faults.exception_burst
        if self._refusals_left > 0:
            self._refusals_left -= 1
            body = bytes((body[0], body[1] | 0x80, self.faults.exception_code))
        if self._strikes("wrong_unit"):
            body = bytes((body[0] % 247 + 1,)) + body[1:]
        if self._strikes("wrong_function"):
            body = bytes((body[0], body[1] ^ 0x07)) + body[2:]
        return sealed(body)

    def _strikes(self, name: str) -> bool:
        fraction = getattr(self.faults, name)
        hit = bool(fraction > 0.0 and self._random.random() < fraction)
        self.injected[name] += hit
        return hit

    def _noise(self) -> bytes:
        return self._random.randbytes(self._random.randint(1, 6))


def parse_faults(specs: tuple[str, ...], *, seed: int = 0, timeout_s: float = 0.1) -> WireFaults:
    """Faults from words such as `late=0.05:0.9-3.5`, `bit_flip=0.03`, `exception=0.01:6x20`, `local_echo`.

    Raises: `BadInput` naming the word that cannot be understood.
    """
    settings: dict[str, float | int | bool] = {"seed": seed, "timeout_s": timeout_s}
    for spec in specs:
        name, _, text = spec.replace("-", "_", spec.partition("=")[0].count("-")).partition("=")
        if name == "local_echo" and not text:
            settings["local_echo"] = True
            continue
        amount, _, detail = text.partition(":")
        try:
            if name not in FRACTIONS:
                raise ValueError(name)
            settings[name] = float(amount)
            if detail and name == "late":
                settings["late_from"], settings["late_to"] = (float(part) for part in detail.split("-"))
            elif detail and name == "exception":
                code, _, burst = detail.partition("x")
                settings["exception_code"], settings["exception_burst"] = int(code), int(burst or 1)
            elif detail:
                raise ValueError(detail)
        except ValueError:
            raise BadInput(
                f"wire fault '{spec}' cannot be understood; write NAME=FRACTION with NAME one of "
                f"{', '.join(FRACTIONS)} (late=0.05:0.9-3.5, exception=0.01:6x20), or local_echo"
            ) from None
    return WireFaults(**settings)  # type: ignore[arg-type]  # the names were checked above
