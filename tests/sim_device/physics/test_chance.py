from __future__ import annotations

import numpy as np

from sim_device.physics.chance import normal, uniform


def test_uniform_is_even_and_inside_its_bounds() -> None:
    values = np.array([uniform(np.uint64(7), 3, k) for k in range(20000)])
    assert values.min() > 0.0 and values.max() < 1.0
    counts, _ = np.histogram(values, bins=20, range=(0.0, 1.0))
    assert np.all(np.abs(counts - 1000) < 150)


def test_normal_has_the_moments_of_a_gaussian() -> None:
    values = np.array([normal(np.uint64(7), 3, k) for k in range(20000)])
    assert abs(values.mean()) < 0.03
    assert abs(values.std() - 1.0) < 0.02
    assert abs(np.mean(values**4) - 3.0) < 0.2


def test_streams_seeds_and_neighbours_are_unrelated() -> None:
    def row(seed: int, stream: int, start: int) -> np.ndarray:
        return np.array([normal(np.uint64(seed), stream, k) for k in range(start, start + 5000)])

    base = row(7, 3, 0)
    for other in (row(8, 3, 0), row(7, 4, 0), row(7, 3, 1)):
        assert abs(np.corrcoef(base, other)[0, 1]) < 0.05


def test_the_same_place_gives_the_same_number() -> None:
    assert uniform(np.uint64(1), 2, 3) == uniform(np.uint64(1), 2, 3)
