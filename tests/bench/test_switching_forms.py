"""What the bench that counts switching forms calls a change."""

from __future__ import annotations

import pytest

from bench.switching_forms import changes_percent, excitation, pairs


@pytest.mark.parametrize(
    ("host", "other", "changed"),
    [
        (("stiction", "target_sticks"), ("friction_in_motion", "partial"), True),
        (("stiction", "target_sticks"), ("spring_asymmetry", "hinged_mid"), False),
    ],
)
def test_an_effect_of_hardly_any_size_changes_another_law_or_nothing(
    host: tuple[str, str], other: tuple[str, str], changed: bool
) -> None:
    assert (host, other) in set(pairs())
    by = changes_percent(host, other, excitation())
    assert by > 1.0 if changed else by < 1e-3
