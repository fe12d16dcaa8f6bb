"""Profiles: what a good one means, and one clear sentence for every bad one."""

from __future__ import annotations

import copy
import tomllib
from typing import Any

import pytest

from hal.errors import BadInput
from hal.profile import FOLDER, Serial, load_profile, parse_profile, profile_names

VIRTUAL = tomllib.loads((FOLDER / "virtual.toml").read_text(encoding="utf-8"))


def changed(path: str, value: Any) -> dict[str, Any]:
    content = copy.deepcopy(VIRTUAL)
    *parents, key = path.split(".")
    place = content
    for parent in parents:
        place = place[parent]
    if value is None:
        del place[key]
    else:
        place[key] = value
    return content


def test_the_virtual_device_is_as_its_specification_says() -> None:
    profile = load_profile("virtual")
    position = profile.signals.position
    assert profile.position_in(position.value(0)) == pytest.approx(0.28125, abs=1e-5)
    assert profile.position_signal(0.5625) == pytest.approx(8.0)
    assert profile.command_unit == "psi"
    assert profile.device_of(position).fc23


@pytest.mark.parametrize("name", profile_names())
def test_every_profile_loads_and_says_where_its_registers_come_from(name) -> None:
    profile = load_profile(name)
    assert profile.name == name
    assert profile.source
    for place, register in profile.every_register().items():
        device = profile.device_of(register)
        assert register.source or device.source, f"{place} has no source"
        assert profile.wire_address(register) >= 0


def test_names_and_paths(tmp_path) -> None:
    copied = tmp_path / "mine.toml"
    copied.write_text((FOLDER / "virtual.toml").read_text(encoding="utf-8"), encoding="utf-8")
    assert load_profile(copied) == load_profile("virtual")
    assert load_profile(str(copied)) == load_profile("virtual")


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        ("serial.boud", 9600, "serial.boud: unknown key; remove it or correct its spelling"),
        ("signals.position.colour", "red", "signals.position.colour: unknown key"),
        ("signals.command", None, "signals.command: missing; add it"),
        ("signals.position.raw", [7, 7], "signals.position: raw \\[7.0, 7.0\\] is an impossible scale"),
        ("devices.bench.id", 248, "devices.bench.id: 248 must be at most 247"),
        ("devices.bench.identity.objects", {"vendor": "x"}, "unknown identification object 'vendor'"),
        ("devices.bench.word_order", "ACBD", "devices.bench.word_order: "),
        ("serial.parity", "X", "serial.parity: "),
        ("safe_command", 21.0, "safe_command 21 is outside limits"),
        ("limits.command_min", 20.0, "limits: command_min 20 must be below command_max 20"),
        ("limits.position_min_in", 1.0, "position_min_in 1 must be below position_max_in"),
        ("signals.pressure.unit", "bar", "signals.pressure.unit is 'bar'"),
        ("signals.position.device", "other", "signals.position.device 'other' is not one of bench"),
        ("calibration", None, r"signals.position is in 'V': a \[calibration\] to in is needed"),
        ("calibration.points", [[0, 0], [0, 1]], "calibration: the signal column of points must rise or fall"),
        ("signals.command.type", "u16", "limits.command_max 20 psi is beyond signals.command, 0 to 10 psi; change the"),
        ("signals.command.unit", "kPa", "signals.command.unit is 'kPa': it must be psi or percent"),
        ("signals.readback.unit", "percent", "signals.readback.unit is 'percent', the command is in psi"),
        ("limits.command_max", float("nan"), "limits.command_max: nan given, it must be finite"),
        ("limits.slew_per_s", float("inf"), "limits.slew_per_s: inf given"),
        ("calibration.points", [[-8.0, 0.0]], "calibration.points: 1 given, at least 2 are needed"),
        ("calibration.points", [[-8.0, "x"], [8.0, 1.0]], "calibration.points, row 1, value 2: 'x' is not a number"),
        ("calibration.points", [[-8.0], [8.0, 1.0]], "calibration.points, row 1, value 2: missing; add it"),
        ("signals.position.raw", [0, 1, 2], "signals.position.raw: 3 given, at most 2 can be"),
        ("limits.slew_per_s", -1.0, "limits.slew_per_s: -1.0 must be more than 0"),
        ("calibration.made", "soon", "calibration.made: 'soon' is not a date like 2026-11-01"),
        ("devices.bench.fc23", "perhaps", "devices.bench.fc23: 'perhaps' is not true or false"),
        ("signals.sequence.address", 1.5, "signals.sequence.address: 1.5 is not a whole number"),
        ("serial", 9600, "serial: 9600 is not a table"),
        ("name", 7, "name: 7 is not a text in quotes"),
        ("name", "", "name: empty; give it a text"),
        ("name", "  ", "name: empty; give it a text"),
        ("devices.bench.id", True, "devices.bench.id: true is not a whole number"),
        ("devices.bench.id", 1.0, "devices.bench.id: 1.0 is not a whole number; write 1"),
        ("devices.bench.address_base", False, "devices.bench.address_base: false is not a whole number"),
        ("devices.bench.fc23", 1, "devices.bench.fc23: 1 is not true or false"),
        ("serial.baud", "38400", "serial.baud: '38400' is not a whole number"),
        ("serial.stop_bits", True, "serial.stop_bits: true is not a whole number"),
        ("limits.slew_per_s", "20", "limits.slew_per_s: '20' is not a number"),
        ("travel_in", True, "travel_in: true is not a number"),
        ("signals.position.raw", [False, 32767], "signals.position.raw, value 1: false is not a number"),
        ("signals.position.sentinels", [True], "signals.position.sentinels, value 1: true is not a whole number"),
        ("calibration.points", [[-8.0, True], [8.0, 1.0]], "calibration.points, row 1, value 2: true is not a number"),
        ("signals.sequence.address", 16, "signals.sequence and signals.readback share the register at address 16"),
        (
            "signals.sequence.address",
            23,
            "signals.aux.supply_psi and signals.sequence share the register at address 23",
        ),
        (
            "signals.sequence.address",
            65536,
            "signals.sequence.address 65536 does not exist: with address_base = 0 a u16",
        ),
        ("signals.command.table", "input", "signals.command.table is 'input', which nobody can write to; give"),
        ("signals.command.table", "coil", "signals.command.table is 'coil', which holds one bit"),
        ("signals.aux.supply_psi.table", "coil", "signals.aux.supply_psi.table is 'coil', which holds one bit"),
        ("devices.bench.watchdog.timeout.table", "input", "devices.bench.watchdog.timeout.table is 'input', which"),
        ("signals.pressure.address", 65535, "a f32 ends at 65534 at the latest"),
    ],
)
def test_every_bad_profile_gets_one_sentence_with_file_and_key(path, value, sentence) -> None:
    content = changed(path, value)
    if path == "signals.command.type":
        content["signals"]["command"] |= {"raw": [0, 65535], "eng": [0.0, 10.0]}  # ends at 10 psi, limits at 20
    with pytest.raises(BadInput, match=f"profile mine.toml: .*{sentence}") as caught:
        parse_profile(content, "mine.toml")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        ("devices.bench.watchdog.timeout_s", 0.04, r"timeout_s 0.04 s is less than a count of its register, 0.1 s"),
        ("devices.bench.watchdog.timeout_s", 7000.0, r"timeout_s 7000 s does not go into its register"),
        ("signals.aux.time_s", {"address": 900}, r"signals.aux.time_s: a record has a column of that name"),
        ("signals.aux.twin_in", {"address": 900}, r"signals.aux.twin_in: a record has a column of that name"),
    ],
)
def test_what_would_be_lost_without_a_word_is_refused(path, value, sentence) -> None:
    with pytest.raises(BadInput, match=sentence):
        parse_profile(changed(path, value), "mine.toml")


def test_a_timeout_beyond_the_scale_of_its_register_is_refused() -> None:
    content = changed("devices.bench.watchdog.timeout_s", 100.0)
    content["devices"]["bench"]["watchdog"]["timeout"] |= {"raw": [0, 255], "eng": [0.0, 25.5]}
    with pytest.raises(BadInput, match=r"timeout_s 100 s is beyond its register, 0 to 25.5"):
        parse_profile(content, "mine.toml")


def test_two_devices_need_to_be_told_apart() -> None:
    content = changed("devices.second", {"id": 1})
    for register in [*content["signals"]["aux"].values(), *_registers(content)]:
        register["device"] = "bench"
    with pytest.raises(BadInput, match="unit id 1 is given twice"):
        parse_profile(content, "x")
    content["devices"]["second"]["id"] = 2
    assert set(parse_profile(content, "x").devices) == {"bench", "second"}
    del content["signals"]["command"]["device"]
    with pytest.raises(BadInput, match=r"signals.command.device '' is not one of bench, second"):
        parse_profile(content, "x")


def _registers(content: dict[str, Any]) -> list[dict[str, Any]]:
    return [register for name, register in content["signals"].items() if name != "aux"]


def test_addresses_counted_from_one() -> None:
    content = changed("devices.bench.address_base", 1)
    with pytest.raises(BadInput, match=r"signals.command.address 0 does not exist on a device with address_base = 1"):
        parse_profile(content, "x")
    for register in [*content["signals"]["aux"].values(), *_registers(content)]:
        register["address"] += 1
    content["signals"]["sequence"]["address"] = 65536
    del content["devices"]["bench"]["watchdog"]
    profile = parse_profile(content, "x")
    assert profile.wire_address(profile.signals.command) == 0
    assert profile.signals.sequence is not None
    assert profile.wire_address(profile.signals.sequence) == 65535


def test_a_float_command_may_go_beyond_the_two_points_that_convert_its_unit() -> None:
    content = changed("signals.command.raw", [0, 100])  # a register in percent of 30 psi
    content["signals"]["command"]["eng"] = [0.0, 15.0]
    assert parse_profile(content, "x").signals.command.value(120) == pytest.approx(18.0)


def test_files_that_cannot_be_read(tmp_path) -> None:
    with pytest.raises(BadInput, match=r"there is no profile 'virtul'; there are .*virtual"):
        load_profile("virtul")
    with pytest.raises(BadInput, match=r"none\.toml cannot be read: No such file"):
        load_profile(tmp_path / "none.toml")
    broken = tmp_path / "broken.toml"
    broken.write_text("name = \n", encoding="utf-8")
    with pytest.raises(BadInput, match=r"broken\.toml is not valid TOML: .*line 1"):
        load_profile(broken)
    broken.write_bytes(b"\xff\xfe")
    with pytest.raises(BadInput, match="is not valid TOML"):
        load_profile(broken)


@pytest.mark.parametrize(
    ("baud", "parity", "stop_bits", "char_us", "silence_us"),
    # The table of the physical wire limit: t3.5 is 3.5 characters up to 19200 baud and 1750 us above.
    [
        (9600, "N", 1, 1041.7, 3646),
        (9600, "E", 1, 1145.8, 4010),
        (19200, "N", 1, 520.8, 1823),
        (38400, "E", 1, 286.5, 1750),
    ],
)
def test_character_and_silence_times(baud, parity, stop_bits, char_us, silence_us) -> None:
    serial = Serial(baud=baud, parity=parity, stop_bits=stop_bits)
    assert 1e6 * serial.char_s == pytest.approx(char_us, abs=0.05)
    assert 1e6 * serial.silence_s == pytest.approx(silence_us, abs=0.6)
