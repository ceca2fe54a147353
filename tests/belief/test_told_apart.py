"""What has become next to impossible of a VLM's noise is left out, and comes back."""

from collections.abc import Callable
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.belief.test_evidence import BOOK, FIND, MODEL, TASK
from tpvqa.belief import AnswerRates, Calibration, Group
from tpvqa.belief.answers import told_apart
from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.kinds import KINDS
from tpvqa.belief.answers.told_apart import ToldApart
from tpvqa.belief.answers.trust import GRID, Trust
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import Rates
from tpvqa.belief.weighing import evidence
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.pddl import Literal
from tpvqa.vlm import Answer, Reply

WORTHLESS = np.repeat(np.array(GRID) < 0.2, len(KINDS))
"""Of all that is told apart what answers are worth next to nothing in."""
HOLDING = [
    BOOK.fact(Literal(atom))
    for atom in sorted(TASK.init)
    if atom in TASK.apply(TASK.init, FIND) and atom.predicate in TASK.fluents
    if BOOK.asked(Literal(atom))
]
"""Questions about facts that hold all the time."""
SIZE = len(GRID) * len(KINDS)


class Camera:
    """Shows facts that hold, one after the other, look by look."""

    def __init__(self) -> None:
        calibration = Calibration(
            vlm="",
            whole=Group(rates=AnswerRates(0.9, 0.1, 0, 0), rows=2000),
            repeat_same_view=0.05,
            repeat_other_view=0.05,
        )
        self.belief, self._looks = Belief(MODEL), 0
        self._evidence = Evidence(self.belief, calibration, Trust.after(2000))

    @property
    def worthless(self) -> float:
        """The probability that answers are worth next to nothing."""
        return float(self.belief.noise[WORTHLESS].sum())

    def asked(self, replies: Callable[[], bool], rounds: int) -> int:
        """Ask about all that holds, with an action between two rounds.

        Returns:
            After how many answers they were thought worth next to nothing.
        """
        answers, found = 0, 0
        for _ in range(rounds):
            self.belief.act(FIND, Rates(0.25, 0.25, 0.01))
            self._evidence.acted()
            for question in HOLDING:
                self._looks, answers = self._looks + 1, answers + 1
                reply = Reply.YES if replies() else Reply.NO
                self._evidence.take(question, Answer(question, reply), self._looks, None)
                assert self.belief.noise.sum() == pytest.approx(1, abs=1e-6)
                assert self.belief.masses()[1].sum() == pytest.approx(1, abs=1e-6)
                found = found or answers * (self.worthless > 0.5)
        return found


@pytest.mark.parametrize("seed", range(3))
def test_a_camera_that_is_covered_is_found_out_though_that_was_left_out(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As soon as by a filter that leaves out nothing: from then on answers are a coin's."""
    monkeypatch.setattr(evidence, "MANY", 1)
    random, camera = Random(seed), Camera()
    camera.asked(lambda: True, 80)
    assert camera.worthless < 1e-8
    assert not WORTHLESS[camera.belief.told[camera.belief.told % len(KINDS) == 0]].any()
    found = camera.asked(lambda: random.random() < 0.5, 50)
    assert WORTHLESS[camera.belief.told].any()

    monkeypatch.setattr(evidence, "MANY", 10**9)
    random, everything = Random(seed), Camera()
    everything.asked(lambda: True, 80)
    assert len(everything.belief.told) == SIZE
    assert found == pytest.approx(everything.asked(lambda: random.random() < 0.5, 50), abs=5)
    assert camera.worthless == pytest.approx(everything.worthless, abs=0.02)


@given(st.lists(st.floats(1e-12, 1.0), min_size=SIZE, max_size=SIZE), st.integers(0, 2**32 - 1))
def test_what_is_kept_or_left_out_is_all_there_is(noise: list[float], seed: int) -> None:
    """And every kind of error stays, one column at least, which stands for those left out."""
    powers = np.random.default_rng(seed).uniform(1.0, 9.0, SIZE)
    probable: Floats = np.power(np.array(noise), powers)
    probable = probable / probable.sum()
    kept = np.arange(SIZE)
    for _ in range(2):
        apart = ToldApart.of(probable, kept)
        assert sorted([*apart.columns, *apart.rest]) == list(range(SIZE))
        assert {*(apart.columns % len(KINDS))} == {*range(len(KINDS))}
        assert (apart.columns[apart.stands] % len(KINDS) == apart.rest % len(KINDS)).all()
        assert (kept[apart.taken] % len(KINDS) == apart.columns % len(KINDS)).all()
        assert (probable[apart.rest] <= told_apart.BACK).all()
        kept, probable = apart.columns, probable[::-1].copy()
