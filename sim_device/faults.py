"""What a bad line can do to a reply: late, noisy, flipped, lost, cut, mislabelled, refused, echoed."""

from __future__ import annotations

from dataclasses import dataclass, fields

from hal.errors import BadInput


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
    wrong_transaction: float = 0.0
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

    def refuse(self, names: tuple[str, ...], why: str) -> None:
        """Raises: `BadInput` when one of the faults `names` is asked for."""
        for name in names:
            if getattr(self, name):
                raise BadInput(f"wire fault '{name}': {why}")


FRACTIONS = tuple(item.name for item in fields(WireFaults) if item.default == 0.0 and isinstance(item.default, float))


@dataclass(frozen=True)
class Emission:
    """What the line carries for one reply: `data` after `delay_s` [s]; empty when the reply is lost."""

    delay_s: float
    data: bytes


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
