"""The checksum, against values that were printed elsewhere."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_device.crc import crc16, sealed


@pytest.mark.parametrize(
    ("body", "wire"),
    [
        ("02 07", "41 12"),  # Modbus over serial line V1.02, section 6.2.2
        ("01 03 00 00 00 0a", "c5 cd"),
        ("11 03 00 6b 00 03", "76 87"),
        ("11 10 00 01 00 02 04 00 0a 01 02", "c6 f0"),
    ],
)
def test_checksums_of_published_frames(body: str, wire: str) -> None:
    assert sealed(bytes.fromhex(body)) == bytes.fromhex(body + wire)


def test_the_check_value_of_the_catalogue_of_crcs() -> None:
    assert crc16(b"123456789") == 0x4B37


@given(st.binary(min_size=1, max_size=252), st.data())
def test_no_single_bit_flip_goes_unnoticed(body: bytes, data: st.DataObject) -> None:
    frame = bytearray(sealed(body))
    bit = data.draw(st.integers(0, 8 * len(frame) - 1))
    frame[bit // 8] ^= 1 << bit % 8
    assert crc16(bytes(frame)) != 0
