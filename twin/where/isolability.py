"""What the measured signals can tell apart at all, whatever the method: structural isolability of the chain's stages.

A fault can be told from another if it still breaks an overdetermined part of the equations after the other's equation
has been taken away. Source: Krysander, Åslund & Nyberg, "An efficient algorithm for finding minimal overconstrained
subsystems for model-based diagnosis", IEEE Trans. SMC-A 38, 2008; Dulmage & Mendelsohn, "Coverings of bipartite
graphs", 1958.
"""

from __future__ import annotations

from collections.abc import Mapping

# stage -> the unknown signals its equation ties together; the demanded command u is known
_CHAIN: Mapping[str, frozenset[str]] = {
    "link": frozenset({"latched"}),
    "ep": frozenset({"latched", "pressure"}),
    "actuator": frozenset({"pressure", "position"}),
    "sensor": frozenset({"position"}),  # its reading is known
}
# a further signal is one equation more: what it measures
_SIGNALS: Mapping[str, str] = {
    "pressure": "pressure",
    "command_readback": "latched",
    "second_position": "position",
}
_ADVICE: Mapping[str, str] = {
    "pressure": "a pressure signal",
    "command_readback": "read-back of the command register",
    "second_position": "a second position signal (dial gauge, limit switch or hard-stop contact)",
}


def isolable_groups(signals: frozenset[str]) -> list[frozenset[str]]:
    """Groups of stages that the command, the position reading and `signals` cannot tell apart; singles are isolable.

    `signals` is a subset of pressure, command_readback, second_position; a pressure sensor joins as a stage of its own.
    Raises: KeyError for an unknown signal.
    """
    equations = {**_CHAIN, **{f"{name}_sensor": frozenset({_SIGNALS[name]}) for name in sorted(signals)}}
    faults = [*_CHAIN, *(["pressure_sensor"] if "pressure" in signals else [])]
    groups: list[set[str]] = []
    for fault in faults:
        for group in groups:
            if all(not _isolable(equations, fault, other) or not _isolable(equations, other, fault) for other in group):
                group.add(fault)
                break
        else:
            groups.append({fault})
    return [frozenset(group) for group in groups]


def describe(signals: frozenset[str]) -> list[str]:
    """Sentences for a report: which stages these signals separate, and which one further signal would do."""
    groups = isolable_groups(signals)
    lines = [_sentence(groups)]
    for extra in _SIGNALS:
        if extra not in signals:
            more = isolable_groups(signals | {extra})
            split = [group for group in groups if not any(group <= other for other in more)]
            if split:
                lines.append(f"{_ADVICE[extra].capitalize()} would split {_names(split)}.")
    return lines


def _sentence(groups: list[frozenset[str]]) -> str:
    joint = [group for group in groups if len(group) > 1]
    if not joint:
        return "The signals can tell every stage from every other."
    return f"The signals alone cannot tell apart {_names(joint)}."


def _names(groups: list[frozenset[str]]) -> str:
    order = [*_CHAIN, "pressure_sensor"]
    words = {"link": "command link", "ep": "E/P transducer", "sensor": "position sensor"}
    return "; ".join(
        " | ".join(words.get(name, name.replace("_", " ")) for name in sorted(group, key=order.index))
        for group in groups
    )


def _isolable(equations: Mapping[str, frozenset[str]], fault: str, other: str) -> bool:
    """Whether the fault's equation stays in the overdetermined part without the other's."""
    return fault in _overdetermined({name: unknowns for name, unknowns in equations.items() if name != other})


def _overdetermined(equations: Mapping[str, frozenset[str]]) -> set[str]:
    """Equations reached by alternating paths from those left over by a maximum matching (Dulmage-Mendelsohn)."""
    owner: dict[str, str] = {}

    def augment(equation: str, seen: set[str]) -> bool:
        for unknown in sorted(equations[equation] - seen):
            seen.add(unknown)
            if unknown not in owner or augment(owner[unknown], seen):
                owner[unknown] = equation
                return True
        return False

    reached = {equation for equation in equations if not augment(equation, set())}
    frontier = list(reached)
    while frontier:
        for unknown in equations[frontier.pop()]:
            if unknown in owner and owner[unknown] not in reached:
                reached.add(owner[unknown])
                frontier.append(owner[unknown])
    return reached
