"""How far a VLM of which nothing is known is trusted."""

from math import isclose
from pathlib import Path
from runpy import run_path

from tpvqa.belief import Calibration
from tpvqa.belief.answers.trust import GRID, RECORDED, Trust
from tpvqa.vlm import Reply

TOOL = Path(__file__).parents[2] / "tools" / "default_trust.py"


def test_what_is_assumed_is_what_the_shipped_recordings_say() -> None:
    factors = run_path(str(TOOL))["factors"]()
    assert tuple(sorted(round(each, 2) for each in factors.values())) == RECORDED


def test_labels_take_over_from_the_recordings() -> None:
    """A VLM that nobody labelled may be worth little; one with a thousand labels hardly."""

    def hardly(trust: Trust) -> float:
        return sum(w for g, w in zip(GRID, trust.weights, strict=True) if g <= 0.3)

    worth = [hardly(Trust.after(rows)) for rows in (0, 10, 60, 1000)]
    assert worth == sorted(worth, reverse=True)
    assert worth[0] > 0.2 > 0.1 > worth[2] > 0.05 > worth[3]
    assert all(isclose(sum(Trust.after(rows).weights), 1.0, abs_tol=1e-6) for rows in (0, 60))


def test_the_first_answer_of_an_unknown_vlm_is_worth_less_than_the_default_says() -> None:
    ratio = Calibration.default().whole.log_ratio(Reply.YES, None)
    assert 0.4 * ratio < Trust.after(0).ratio(ratio) < 0.8 * ratio
