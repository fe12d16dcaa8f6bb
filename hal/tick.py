"""What one tick says on the wire: which blocks are read, whether one transaction does it all, how long it takes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from hal.channel import Channel, channel
from hal.device import Device
from hal.pdu import Request, read_registers, write_and_read, write_register, write_registers
from hal.profile import Profile
from hal.register import Register

_SPARE = 0.9  # a tick may fill this share of the wire


@dataclass(frozen=True, slots=True)
class Block:
    """Neighbouring registers of one device that are read together."""

    device: Device
    function: int
    address: int
    count: int
    channels: tuple[Channel, ...]

    def request(self) -> Request:
        return read_registers(self.device.id, self.function, self.address, self.count)


@dataclass(frozen=True, slots=True)
class TickPlan:
    """The blocks of a tick; `joint` is the one that function 23 reads in the transaction that writes the command."""

    device: Device  # the one that takes the command
    command_address: int
    command: Register
    joint: Block | None
    blocks: tuple[Block, ...]  # the others
    held: Block | None = None  # the read-back alone

    def sending(self, command: float) -> tuple[tuple[int, ...], float]:
        """The words that carry a command, and the command that they really are."""
        words = self.command.to_words(command, self.device.word_order)
        return words, self.command.value(self.command.counts(words, self.device.word_order))

    def write_request(self, words: tuple[int, ...]) -> Request:
        """The request that carries the command, and brings `joint` where there is one."""
        unit, address = self.device.id, self.command_address
        if self.joint is not None:
            return write_and_read(unit, address, words, self.joint.address, self.joint.count)
        if self.device.write_fc == 6:
            return write_register(unit, address, words[0])
        return write_registers(unit, address, words)

    def every_block(self) -> tuple[Block, ...]:
        return self.blocks if self.joint is None else (self.joint, *self.blocks)


def plan_tick(profile: Profile) -> TickPlan:
    """Groups the profile's signals into as few reads as the devices allow."""
    command = profile.signals.command
    device = profile.device_of(command)
    wanted = {name: r for name, r in profile.signals.named().items() if name != "command"}
    blocks = _blocks(profile, wanted.items())
    status = device.watchdog.status if device.watchdog else None
    if status is not None:  # only where it costs no transaction of its own
        with_status = _blocks(profile, (wanted | {"watchdog_status": profile.placed(status, command)}).items())
        blocks = with_status if len(with_status) <= len(blocks) else blocks
    joint = None
    if device.fc23:
        joint = next((b for b in blocks if b.device == device and b.function == 3), None)
    others = tuple(block for block in blocks if block is not joint)
    readback = {name: register for name, register in wanted.items() if name == "readback"}
    held = next(iter(_blocks(profile, readback.items())), None)
    return TickPlan(device, profile.wire_address(command), command, joint, others, held)


def _blocks(profile: Profile, registers: Iterable[tuple[str, Register]]) -> tuple[Block, ...]:
    groups: dict[tuple[str, int], list[tuple[int, str, Register]]] = {}
    for name, register in registers:
        function = {"holding": 3, "input": 4, "coil": 1}[profile.table_of(register)]
        if function != 1:
            key = (profile.device_name(register), function)
            groups.setdefault(key, []).append((profile.wire_address(register), name, register))
    found: list[Block] = []
    for (device, function), members in groups.items():
        found += _split(profile, profile.devices[device], function, sorted(members, key=lambda m: m[0]))
    return tuple(found)


def _split(profile: Profile, device: Device, function: int, members: list[tuple[int, str, Register]]) -> list[Block]:
    runs: list[list[tuple[int, str, Register]]] = []
    for member in members:
        start, end = member[0], member[0] + member[2].words
        previous = runs[-1] if runs else None
        if previous and start - _end(previous) <= device.read_gap and end - previous[0][0] <= device.max_read:
            previous.append(member)
        else:
            runs.append([member])
    return [_block(profile, device, function, run) for run in runs]


def _end(run: list[tuple[int, str, Register]]) -> int:
    return max(address + register.words for address, _, register in run)


def _block(profile: Profile, device: Device, function: int, run: list[tuple[int, str, Register]]) -> Block:
    first = run[0][0]
    channels = tuple(channel(profile, name, register, address - first) for address, name, register in run)
    return Block(device, function, first, _end(run) - first, channels)


def requests_of(plan: TickPlan, profile: Profile) -> list[Request]:
    """What a tick sends, with the safe command as an example."""
    words = plan.command.to_words(profile.safe_command, plan.device.word_order)
    return [plan.write_request(words), *(block.request() for block in plan.blocks)]


def min_period_s(plan: TickPlan, profile: Profile) -> float:
    """The shortest tick [s] that the wire carries with a tenth to spare.

    Wire time of every frame, one t3.5 before and one after each request, and the devices' turnaround. Without pacing
    (a line that has no bits) only the turnaround counts.
    """
    return _wire_s(requests_of(plan, profile), profile) / _SPARE


def looking_period_s(plan: TickPlan, profile: Profile) -> float:
    """The shortest tick [s] in which the read-back can be read alone, too."""
    more = () if plan.held is None else (plan.held.request(),)
    return _wire_s((*requests_of(plan, profile), *more), profile) / _SPARE


def _wire_s(requests: Sequence[Request], profile: Profile) -> float:
    paced = profile.serial.pacing == "spec"
    char_s, silence_s = (profile.serial.char_s, profile.serial.silence_s) if paced else (0.0, 0.0)
    turnaround_s = {device.id: device.turnaround_ms / 1000.0 for device in profile.devices.values()}
    total_s = 0.0
    for request in requests:
        chars = len(request.pdu) + 3 + request.size + 3
        total_s += chars * char_s + 2.0 * silence_s + turnaround_s[request.unit]
    return total_s
