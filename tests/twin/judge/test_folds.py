"""What is held out is predicted by the fit that left it out."""

from __future__ import annotations

import numpy as np
import pytest

from tests.twin.judged import a_record
from tests.twin.trials import DESIGN
from twin.fit.case import make_case
from twin.fit.channel import chain_channel
from twin.fit.fitting import fit
from twin.fit.space import make_space
from twin.judge.heldout import fold_weights, predict_heldout
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant


def test_a_row_is_predicted_by_the_fit_that_has_not_seen_it(monkeypatch: pytest.MonkeyPatch) -> None:
    case = make_case([a_record(Plant(DESIGN))], DESIGN)
    channel = chain_channel(case.trials, case.sigma_y)
    none = fit(channel, make_space(case.base, (), (), case.scales), [np.zeros(0)])
    off = Inserted("lvdt_calibration", effect("lvdt_calibration").form("zero"), (0.1,))

    def told(_fits: object, _channels: object, weights: np.ndarray) -> list[Plant]:
        return [case.base.having([off]) if weights[0] == 0.0 else case.base]  # off: has not seen the first block

    monkeypatch.setattr("twin.judge.heldout.refitted", told)
    monkeypatch.setattr("twin.judge.heldout.combined", lambda _base, plants: plants[0])
    error = predict_heldout(case, case.base, [none], [channel])
    unseen, counts = fold_weights(case.trials)[0] == 0.0, np.isfinite(error)
    assert np.mean(error[unseen & counts]) == pytest.approx(-0.1, abs=0.005)
    assert np.mean(error[~unseen & counts]) == pytest.approx(0.0, abs=0.005)
