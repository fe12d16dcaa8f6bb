"""Who the virtual device says it is: the objects of function 43, MEI type 14 (read device identification)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

_BASIC, _REGULAR, _EXTENDED, _INDIVIDUAL = 1, 2, 3, 4
_CONFORMITY_REGULAR_AND_INDIVIDUAL = 0x82
_LAST_OF = {_BASIC: 0x02, _REGULAR: 0x06, _EXTENDED: 0xFF}
_ROOM = 253 - 7  # longest PDU less the head of this reply


@dataclass(frozen=True)
class Identity:
    """Objects by number: 0 vendor, 1 product code, 2 revision, 3 URL, 4 product, 5 model, 6 application.

    Source: Modbus Application Protocol V1.1b3, section 6.21.
    """

    objects: Mapping[int, str]

    def reply(self, access: int, first: int) -> bytes | None:
        """What follows the echoed access code: conformity, more, next, number, objects. None: no such object."""
        if access == _INDIVIDUAL:
            if first not in self.objects:
                return None
            return bytes((_CONFORMITY_REGULAR_AND_INDIVIDUAL, 0, 0, 1)) + _encoded(first, self.objects[first])
        if access not in _LAST_OF:
            return None
        wanted = [number for number in sorted(self.objects) if number <= _LAST_OF[access]]
        # An unknown start object means: from the beginning.
        pending = [number for number in wanted if number >= first] if first in wanted else wanted
        body, sent = b"", 0
        for number in pending:
            entry = _encoded(number, self.objects[number])
            if len(body) + len(entry) > _ROOM:
                break
            body, sent = body + entry, sent + 1
        more = sent < len(pending)
        head = (_CONFORMITY_REGULAR_AND_INDIVIDUAL, 0xFF if more else 0, pending[sent] if more else 0, sent)
        return bytes(head) + body


def _encoded(number: int, text: str) -> bytes:
    raw = text.encode("ascii", "replace")[: _ROOM - 2]
    return bytes((number, len(raw))) + raw
