"""docs/profiles.md names every key that a profile can have."""

from __future__ import annotations

from pathlib import Path

import pytest

from hal.calibration import Calibration
from hal.device import Device, Identity, Resync, Watchdog
from hal.profile import Limits, Profile, Serial, Signals
from hal.register import Register, Transmitter

TEXT = (Path(__file__).parents[2] / "docs" / "profiles.md").read_text(encoding="utf-8")
PARTS = (Profile, Serial, Limits, Device, Identity, Resync, Watchdog, Signals, Register, Transmitter, Calibration)


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.__name__)
def test_every_key_is_described(part) -> None:
    missing = [key for key in part.model_fields if f"`{key}" not in TEXT and f"{key} =" not in TEXT]
    assert [key for key in missing if f".{key}]" not in TEXT and f"[{key}" not in TEXT] == []
