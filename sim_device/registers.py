"""A map of registers, each a named cell that knows how to be read and, perhaps, written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

from sim_device.codec import decode, encode, width
from sim_device.pdu import COIL, HOLDING, ILLEGAL_ADDRESS, ILLEGAL_VALUE, INPUT, Refused


@dataclass(frozen=True)
class Cell:
    """One number in the map: `read` gives its raw value, `write` takes it, `accepts` says whether it would."""

    name: str
    address: int
    read: Callable[[], float]
    write: Callable[[float], None] | None = None
    accepts: Callable[[float], bool] = lambda _: True
    kind: str = "u16"
    order: str = "ABCD"
    tables: frozenset[int] = frozenset((HOLDING,))

    @cached_property
    def size(self) -> int:
        """How many registers it takes."""
        return width(self.kind)


class RegisterMap:
    """Cells by address. A request may cover many cells; it may not touch a register that is not there.

    Raises: `ValueError` when two cells want the same register.
    """

    def __init__(self, cells: Iterable[Cell]) -> None:
        self.cells = tuple(cells)
        self._at: dict[tuple[int, int], tuple[Cell, int]] = {}
        for cell in self.cells:
            for table in cell.tables:
                self._place(cell, table)
        for cell in self.cells:
            self._mirror(cell)

    def _place(self, cell: Cell, table: int) -> None:
        for offset in range(cell.size):
            key = (table, cell.address + offset)
            if key in self._at:
                raise ValueError(f"'{cell.name}' and '{self._at[key][0].name}' share register {key[1]}")
            self._at[key] = (cell, offset)

    def _mirror(self, cell: Cell) -> None:
        """As in most modules, what can be read with function 3 can be read with 4 and the other way round."""
        for table in {HOLDING, INPUT} - cell.tables:
            free = all((table, cell.address + offset) not in self._at for offset in range(cell.size))
            if free and COIL not in cell.tables:
                self._place(cell, table)

    def check_read(self, table: int, address: int, count: int) -> None:
        for at in range(address, address + count):
            if (table, at) not in self._at:
                raise Refused(ILLEGAL_ADDRESS)

    def read(self, table: int, address: int, count: int) -> Sequence[int]:
        self.check_read(table, address, count)
        words: list[int] = []
        whole: list[int] = []
        shown: Cell | None = None
        for at in range(address, address + count):
            cell, offset = self._at[(table, at)]
            if cell is not shown:  # a number is measured once, so that its words belong together
                whole, shown = encode(cell.read(), cell.kind, cell.order), cell
            words.append(whole[offset])
        return words

    def check_write(self, table: int, address: int, values: Sequence[int]) -> None:
        for cell, value in self._numbers(table, address, values):
            if cell.write is None:
                raise Refused(ILLEGAL_ADDRESS)
            if not cell.accepts(value):
                raise Refused(ILLEGAL_VALUE)

    def write(self, table: int, address: int, values: Sequence[int]) -> None:
        for cell, value in self._numbers(table, address, values):
            assert cell.write is not None  # check_write came first
            cell.write(value)

    def _numbers(self, table: int, address: int, values: Sequence[int]) -> list[tuple[Cell, float]]:
        """The cells that a write covers with their new raw values; a half-written number keeps its other half."""
        found: list[tuple[Cell, float]] = []
        at, end = address, address + len(values)
        while at < end:
            entry = self._at.get((table, at))
            if entry is None:
                raise Refused(ILLEGAL_ADDRESS)
            cell, offset = entry
            span = min(cell.size - offset, end - at)
            words = list(values[at - address : at - address + span])
            if span < cell.size:
                held = encode(cell.read(), cell.kind, cell.order)
                words = held[:offset] + words + held[offset + span :]
            found.append((cell, decode(words, cell.kind, cell.order)))
            at += span
        return found


BOTH = frozenset((HOLDING, INPUT))
