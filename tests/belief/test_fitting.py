"""What is learnt from labelled answers: known habits are found again."""

import sys
from dataclasses import replace
from math import log

import numpy as np
import pytest

from tests.belief.talking import trials
from tpvqa.belief import Calibration, LabelledAnswer
from tpvqa.belief.calibrating.fitting import fit
from tpvqa.belief.calibrating.held_out import held_out
from tpvqa.belief.calibrating.runs import runs
from tpvqa.bench.cell import Cell
from tpvqa.bench.labelled import gather
from tpvqa.config import TrialConfig
from tpvqa.errors import CalibrationError, MissingExtraError
from tpvqa.questions import Way
from tpvqa.vlm import Reply
from tpvqa.vlm.metrics import calibration_error


def worth(found: Calibration, reply: Reply, p: float | None = None, predicate: str = "on") -> float:
    return found.group_of(Way.EFFECT, predicate).log_ratio(reply, p)


@pytest.mark.parametrize(("accuracy", "rho"), [(0.8, 0.5), (0.9, 0.0)])
def test_the_oracle_is_recovered_from_trials(accuracy: float, rho: float) -> None:
    spec = f"oracle:{accuracy}:{rho}"
    cell = Cell("serve_breakfast", "tpvqa:3", spec, "symbolic")
    found = fit(gather(cell, TrialConfig(seed=5), range(50)), spec)
    # More than three standard errors of some 450 first answers of each truth, 2,000 pairs.
    rates = found.whole.rates
    assert rates.yes_if_true == pytest.approx(accuracy, abs=0.05)
    assert rates.yes_if_false == pytest.approx(1 - accuracy, abs=0.05)
    assert found.repeat_same_view == pytest.approx(rho, abs=0.06)
    near = found.group_of(Way.EFFECT, "near")
    for reply, p, right in ((Reply.YES, accuracy, 1), (Reply.NO, 1 - accuracy, -1)):
        assert near.log_ratio(reply, p) == pytest.approx(
            right * log(accuracy / (1 - accuracy)), abs=0.5
        )


def test_errors_that_are_looked_at_again_do_not_count_again() -> None:
    rows = list(trials(400, rho=0.8, until_pleased=True))
    right = sum((row.reply is Reply.YES) == row.truth for row in rows) / len(rows)
    assert right < 0.6
    rates = fit(rows, "v").whole.rates
    assert rates.yes_if_true == pytest.approx(0.8, abs=0.04)
    assert rates.yes_if_false == pytest.approx(0.2, abs=0.04)


def test_rho_of_the_same_and_of_another_view() -> None:
    one_view = list(trials(100, rho=0.6, predicate="on"))
    two_views = list(trials(100, rho_elsewhere=0.2, predicate="clean"))
    found = fit(one_view + two_views, "v")
    assert found.repeat_same_view == pytest.approx(0.6, abs=0.06)
    assert found.repeat_other_view == pytest.approx(0.2, abs=0.06)
    assert fit(one_view, "v").repeat_other_view == Calibration.default().repeat_other_view


def test_the_base_rate_is_not_in_it() -> None:
    even, rare = (fit(trials(600, base=base, surer=1.0), "v") for base in (0.5, 0.05))
    for reply, p in ((Reply.YES, 0.8), (Reply.NO, 0.2)):
        assert worth(rare, reply, p) == pytest.approx(worth(even, reply, p), abs=0.35)
        assert abs(worth(even, reply, p)) == pytest.approx(log(4), abs=0.2)


def test_one_row_changes_little_and_many_change_much() -> None:
    default = Calibration.default()
    (row, *_) = trials(1, surer=1.0)
    wrong = replace(row, truth=row.reply is Reply.NO)
    lone = fit([wrong], "v")
    for reply, p in ((Reply.YES, 0.8), (Reply.NO, 0.2), (Reply.YES, None)):
        assert worth(lone, reply, p) == pytest.approx(default.whole.log_ratio(reply, p), abs=0.35)
    bad = fit(trials(200, accuracy=0.5, surer=1.0), "v")
    assert abs(worth(bad, Reply.YES, 0.8)) < 0.2


def test_a_group_of_few_follows_the_others_and_one_of_many_speaks_for_itself() -> None:
    good = list(trials(300, accuracy=0.9, surer=1.0, predicate="on"))
    bad = list(trials(300, accuracy=0.6, surer=1.0, predicate="clean"))
    few, many = fit(good + bad[:3], "v"), fit(good + bad, "v")
    kinds = [(Reply.YES, 0.8), (Reply.YES, None)]
    for reply, p in kinds:
        assert worth(few, reply, p, "clean") == pytest.approx(worth(few, reply, p), abs=0.6)
        assert worth(many, reply, p, "clean") < worth(many, reply, p, "on") - 1


def test_a_group_that_never_saw_a_yes_be_right_keeps_the_curve_of_the_others() -> None:
    rows = list(trials(200, surer=1.0, predicate="on"))
    rows += trials(200, surer=1.0, predicate="clean", base=0.0)
    found = fit(rows, "v")
    assert worth(found, Reply.NO, 0.2, "clean") == pytest.approx(
        worth(found, Reply.NO, 0.2, "on"), abs=0.25
    )


def test_words_alone_teach_counts() -> None:
    found = fit(trials(200), "v")
    assert found.whole.curve is None
    assert worth(found, Reply.YES) == pytest.approx(log(4), abs=0.25)
    assert worth(found, Reply.YES, 0.99) == worth(found, Reply.YES)


def test_yes_that_means_no_is_said_so_and_worth_nothing() -> None:
    rows = [replace(row, truth=not row.truth) for row in trials(100, surer=1.0)]
    found = fit(rows, "v")
    assert any("worded the other way round" in notice for notice in found.notices)
    silent = fit([replace(row, p_yes=None) for row in rows], "v")
    for calibration in (found, silent):
        for reply, p in ((Reply.YES, 0.8), (Reply.NO, 0.2), (Reply.YES, None), (Reply.NO, None)):
            assert worth(calibration, reply, p) == pytest.approx(0, abs=0.02)
    assert fit(trials(100, surer=1.0), "v").notices == ()


def test_few_answers_that_are_wrong_by_chance_are_not_worth_nothing() -> None:
    others = list(trials(60, surer=1.0, predicate="on"))
    own = [row for row in trials(40, surer=1.0, predicate="clean") if row.look == 0]
    wrong = [row for row in own if (row.reply is Reply.YES) != row.truth]
    worths = []
    for count in (4, 12, 36):
        found = fit([*others, *wrong[:count]], "v")
        worths.append(worth(found, Reply.YES, 0.8, "clean"))
    assert worths[0] > 0.2
    assert worths[0] > worths[1] > worths[2] > 0
    assert worths[2] < 0.1


def test_noise_never_gives_a_negative_slope() -> None:
    found = fit(trials(30, accuracy=0.5, surer=1.0), "v")
    curves = [each.curve for each in (found.whole, *found.ways, *found.groups)]
    assert all(curve is not None and curve.slope >= 0 for curve in curves)


def test_abstentions_are_counted_and_break_no_run() -> None:
    def at(look: int, reply: Reply, text: str = "?") -> LabelledAnswer:
        return LabelledAnswer(Way.EFFECT, "on", text, True, reply, None, "t", look, "front")

    rows = [at(0, Reply.CANNOT_SEE), at(1, Reply.YES), at(2, Reply.UNKNOWN), at(3, Reply.YES)]
    once = fit(rows, "v")
    assert once.whole.rates.abstain_if_true == pytest.approx((1 + 15 * 0.05) / 16)
    assert once.whole.rates.yes_if_true == pytest.approx((1 + 15 * 0.85) / 16)
    assert once.pairs_same_view == 1
    assert fit(rows, "v", chosen_looks=False).whole.rates.yes_if_true > once.whole.rates.yes_if_true


def test_nothing_to_learn_from_is_an_error() -> None:
    with pytest.raises(CalibrationError, match="no yes or no of v among 0"):
        fit([], "v")


def test_without_scikit_learn_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sklearn.linear_model", None)
    with pytest.raises(MissingExtraError, match=r"tpvqa\[calibrate\]"):
        fit(trials(2, surer=1.0), "v")


def test_an_overconfident_vlm_is_reliable_after_on_trials_that_were_not_learnt_from() -> None:
    judged = held_out(trials(150, surer=3.0), "v")
    truth = np.array([each.row.truth for each in judged])
    before = np.array([each.before for each in judged])
    after = np.array([each.after for each in judged], float)
    assert len(judged) == 150 * 5  # first answers alone
    ece_before, ece_after = calibration_error(before, truth), calibration_error(after, truth)
    assert ece_before is not None
    assert ece_after is not None
    assert ece_before > 0.15
    assert ece_after < 0.05


def test_a_single_trial_has_no_after() -> None:
    assert {each.after for each in held_out(trials(1), "v")} == {None}


def test_a_fact_that_changed_is_answered_afresh_and_a_repeat_on_one_picture_tells_nothing() -> None:
    def at(look: int, truth: bool, reply: Reply) -> LabelledAnswer:
        return LabelledAnswer(Way.EFFECT, "on", "?", truth, reply, None, "t", look, "front")

    yes, no = Reply.YES, Reply.NO
    placed = list(runs([at(0, True, yes), at(0, True, yes), at(1, True, no), at(2, False, no)]))
    assert [each.first for each in placed] == [True, False, False, True]
    assert [each.first_answer for each in placed] == [True, False, False, True]
    assert [each.last and each.last.look for each in placed] == [None, None, 0, None]
