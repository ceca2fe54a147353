"""What is labelled next, and when there is enough."""

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.labelling.robot import Truths
from tpvqa.errors import WriteError
from tpvqa.labelling import Asking, Given, Session
from tpvqa.labelling.labels import Said
from tpvqa.labelling.order import ENOUGH, Order
from tpvqa.questions import Way
from tpvqa.vlm import Reply

WAYS = (Way.PRECONDITION, Way.EFFECT)


def asking(
    number: int, way: Way, subject: str, reply: Reply, p_yes: float | None, times: int = 1
) -> Asking:
    answers = (Given(way, reply, p_yes, 0, None, person=False),) * times
    text = f"{subject} {number}?"
    return Asking(Path("e"), number, text, subject, (f"({subject})",), "", answers, ())


ASKINGS = st.lists(
    st.tuples(
        st.sampled_from(WAYS),
        st.sampled_from(["on", "open", "clean"]),
        st.sampled_from(list(Reply)),
        st.sampled_from([None, 0.05, 0.4, 0.6, 0.9]),
        st.integers(1, 3),
    ),
    min_size=1,
    max_size=25,
).map(lambda rows: [asking(number, *row) for number, row in enumerate(rows)])
ANSWERS: list[Said] = ["yes", "no", "cannot see"]
SAID = st.sampled_from(ANSWERS)


@settings(max_examples=50, deadline=None)
@given(ASKINGS, st.data())
def test_every_question_comes_once_and_the_error_never_grows(
    askings: Sequence[Asking], data: st.DataObject
) -> None:
    order, known = Order(askings), dict[int, Said]()

    def label_of(each: Asking) -> Said | None:
        return known.get(id(each))

    before = order.standing(label_of)
    while (each := order.next(label_of)) is not None:
        assert id(each) not in known
        known[id(each)] = data.draw(SAID)
        after = order.standing(label_of)
        assert after.error <= before.error + 1e-12
        assert after.after <= after.error + 1e-12
        assert after.left == before.left - 1
        before = after
    assert len(known) == len(askings)
    assert before.enough


@settings(max_examples=50, deadline=None)
@given(ASKINGS, st.data())
def test_weights_put_right_what_was_chosen(askings: Sequence[Asking], data: st.DataObject) -> None:
    order, known = Order(askings), dict[int, Said]()
    for _ in range(data.draw(st.integers(0, len(askings)))):
        each = order.next(lambda asked: known.get(id(asked)))
        assert each is not None
        known[id(each)] = data.draw(SAID)
    weights = order.weights(lambda asked: known.get(id(asked)))
    assert set(weights) == {key for key, said in known.items() if said != "cannot see"}
    groups = Counter(each.group for each in askings if id(each) in weights)
    total: Counter[tuple[Way, str]] = Counter()
    for each in askings:
        if id(each) in weights:
            total[each.group] += weights[id(each)]  # type: ignore[assignment]
    for group, count in groups.items():
        assert abs(total[group] - count) < 1e-9


def test_shares_of_yes_are_those_of_all_answers() -> None:
    """Yes is rare, labelled oftener than it comes, and counts as often as it comes."""
    rare = [asking(n, Way.EFFECT, "on", Reply.YES, None) for n in range(6)]
    usual = [asking(n, Way.EFFECT, "on", Reply.NO, None) for n in range(100, 118)]
    order, known = Order([*usual, *rare]), dict[int, Said]()
    for _ in range(10):
        each = order.next(lambda asked: known.get(id(asked)))
        assert each is not None
        known[id(each)] = "no"
    labelled = [each for each in rare if id(each) in known]
    assert len(labelled) > 2  # 2.5 would come by chance
    weights = order.weights(lambda asked: known.get(id(asked)))
    share = sum(weights[id(each)] for each in labelled) / sum(weights.values())
    assert abs(share - 6 / 24) < 1e-9


def test_what_is_asked_often_and_little_known_comes_first() -> None:
    seldom = [asking(n, Way.EFFECT, "on", Reply.YES, None) for n in range(10)]
    often = [asking(n, Way.EFFECT, "open", Reply.YES, None, times=9) for n in range(10)]
    order, known = Order([*seldom, *often]), dict[int, Said]()
    subjects = []
    for _ in range(12):
        each = order.next(lambda asked: known.get(id(asked)))
        assert each is not None
        known[id(each)] = "yes"
        subjects.append(each.subject)
    assert subjects[0] == "open"
    assert Counter(subjects)["open"] > Counter(subjects)["on"]


def test_near_the_boundary_comes_first() -> None:
    sure = [asking(n, Way.EFFECT, "on", Reply.YES, 0.95) for n in range(4)]
    near = [asking(n, Way.EFFECT, "on", Reply.YES, 0.55) for n in range(10, 14)]
    first = Order([*sure, *near]).next(lambda _: None)
    assert first in near


def test_sixty_labels_or_so_are_enough(folders: list[Path], truths: Truths) -> None:
    with Session(folders) as session:
        assert not session.progress.standing.enough
        count = 0
        while not session.progress.standing.enough:
            now = session.now
            assert now is not None
            right = truths[str(now.episode), now.of_vlm[0].look, now.text]
            session.say("yes" if right else "no")
            count += 1
        assert 20 < count < 90
        standing = session.progress.standing
        assert standing.error <= ENOUGH or standing.left == 0


def test_back_skip_and_a_label_anew(folders: list[Path]) -> None:
    with Session(folders) as session:
        assert not session.back()
        first = session.now
        assert first is not None
        session.say("yes")
        second = session.now
        assert second is not None
        assert second is not first
        session.skip()
        assert session.now is not second
        assert session.back()
        assert session.now is second
        assert session.back()
        assert session.now is first
        session.say("no")
        assert session.label_of(first) == "no"
        assert session.now is second  # what was skipped and come back to is open again
    with Session(folders) as again:
        assert again.progress.labels == 1
        assert again.now is not None
        assert again.now.key == second.key


def test_a_label_that_cannot_be_written_is_asked_again(
    folders: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_descriptor: int) -> None:
        raise OSError(28, os.strerror(28))

    with Session(folders) as session:
        now = session.now
        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", full)
            with pytest.raises(WriteError):
                session.say("yes")
        assert session.now is now
        assert session.progress.labels == 0
        session.say("no")
        assert session.progress.labels == 1
