from __future__ import annotations

from datetime import date

import pytest

from hal.dial_gauge import fit, read_pairs, write_profile
from hal.errors import BadInput
from hal.profile import FOLDER, load_profile

DAY = date(2026, 11, 21)


def test_two_points_are_the_least_squares_line() -> None:
    # signal = 16 * position - 4, with errors that cancel
    pairs = [(-4.0 + 0.01, 0.0), (-4.0 - 0.01, 0.0), (0.0 + 0.02, 0.25), (0.0 - 0.02, 0.25), (4.0, 0.5)]
    found = fit(pairs, "two-point", name="x", made=DAY)
    (low, first), (high, last) = found.calibration.points
    assert (first, last) == (0.0, 0.5)
    assert low == pytest.approx(-4.0)
    assert high == pytest.approx(4.0)
    assert found.worst_in == pytest.approx(0.02 / 16)
    assert found.rms_in == pytest.approx((2 * (0.01 / 16) ** 2 + 2 * (0.02 / 16) ** 2) ** 0.5 / 5**0.5)


def test_a_table_goes_through_the_means_and_takes_out_the_curvature() -> None:
    places = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]
    pairs = [(10 * p - 3 * p * p + d, p) for p in places for d in (-0.01, 0.01)]
    found = fit(pairs, "table", name="x", made=DAY)
    assert [p for _, p in found.calibration.points] == places
    assert found.worst_in < 0.0016
    assert fit(pairs, "two-point", name="x", made=DAY).worst_in > 5 * found.worst_in


def test_readings_that_make_no_calibration() -> None:
    with pytest.raises(BadInput, match="at two positions or more, there is 1"):
        fit([(1.0, 0.1), (1.1, 0.1)], "table", name="x", made=DAY)
    with pytest.raises(BadInput, match="the signal column of points must rise or fall strictly"):
        fit([(1.0, 0.0), (2.0, 0.1), (1.5, 0.2)], "table", name="x", made=DAY)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a,b\n1,2\n", "has no column 'signal'"),
        ("signal,position_in\n1,2\nx,3\n", "row 3: signal is 'x', which is not a number"),
        ("signal,position_in\n1\n", "row 2: position_in is 'None'"),
        ("signal,position_in\nnan,0\n", "row 2: signal is 'nan'"),
        ("", "has no column"),
    ],
)
def test_bad_files_are_named_with_their_row(tmp_path, text, sentence) -> None:
    path = tmp_path / "gauge.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(BadInput, match=sentence):
        read_pairs(path)
    with pytest.raises(BadInput, match="cannot be read"):
        read_pairs(tmp_path / "none.csv")


def test_the_new_profile_is_the_old_one_with_another_calibration(tmp_path) -> None:
    target = tmp_path / "mine.toml"
    found = fit([(-5.0, 0.0), (5.0, 0.5)], "two-point", name="new", made=DAY, expires=date(2027, 1, 1))
    write_profile(FOLDER / "virtual.toml", target, found.calibration)
    old, new = load_profile("virtual"), load_profile(target)
    assert new.calibration == found.calibration
    assert new.model_copy(update={"calibration": old.calibration}) == old
    assert "# One read of 9 registers" in target.read_text(encoding="utf-8"), "comments are kept"
    with pytest.raises(BadInput, match="exists already"):
        write_profile(FOLDER / "virtual.toml", target, found.calibration)
