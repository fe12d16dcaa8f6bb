"""Words that a plant's historian writes in the place of a value that it does not have.

Source: the SYSTEM digital state set of the PI Data Archive (AVEVA, Data Archive Administration), which any numeric
point may hold; of its states those that say that there is no usable value.
"""

from __future__ import annotations

STATES = frozenset(
    word.casefold()
    for word in (
        *("No Data", "No Sample", "No Result", "Pt Created", "Arc Off-line", "Arc Offline", "Archive Offline"),
        *("Bad", "Bad Data", "Bad Input", "Bad Output", "Bad Quality", "Bad_Quality", "Invalid Data", "Invalid Float"),
        *("I/O Timeout", "Scan Timeout", "Scan Off", "Comm Fail", "Not Connect", "Configure", "Access Denied"),
        *("Shutdown", "Intf Shut", "Out of Serv", "Unit Down", "Equip Fail", "DCS Failed", "Failed", "Error"),
        *("Calc Failed", "Calc Off", "Over Range", "Under Range"),
    )
)


def is_state(cell: str) -> bool:
    """Whether a cell says why there is no value in it."""
    return cell.casefold() in STATES
