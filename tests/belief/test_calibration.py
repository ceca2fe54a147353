"""What an answer is worth: bounds, symmetry, groups, further looks, the file."""

import json
from codecs import BOM_UTF8
from itertools import pairwise
from math import isclose, log
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief import AnswerRates, Apart, Calibration, Curve, Group
from tpvqa.belief.answers.bounds import BOUND
from tpvqa.errors import CalibrationError, WriteError
from tpvqa.pddl import Action, Atom, Conjunction
from tpvqa.questions import ActionQuestion, ActionWay, FactQuestion, FactWay, Way
from tpvqa.vlm import Answer, Reply

ON = FactQuestion("Is it on it?", Way.EFFECT, Atom("on", ("apple", "table")))
P = st.floats(0, 1)
SLOPE = st.floats(0.01, 3)


RATES = AnswerRates(0.8, 0.2, 0.1, 0.1)


def calibration(curve: Curve | None, rates: AnswerRates = RATES) -> Calibration:
    return Calibration(
        vlm="v",
        whole=Group(rates=rates, curve=curve),
        repeat_same_view=0.5,
        repeat_other_view=0.2,
    )


def group(way: Way, predicate: str | None, yes_if_true: float) -> Group:
    return Group(way=way, predicate=predicate, rates=AnswerRates(yes_if_true, 0.1, 0.0, 0.0))


@given(P, SLOPE, st.floats(0, 2), st.floats(0.01, 0.99))
def test_a_symmetric_calibration_is_antisymmetric(
    p: float, slope: float, sign: float, rate: float
) -> None:
    one = calibration(Curve(slope=slope, sign=sign), AnswerRates(rate, 1 - rate, 0.1, 0.1))
    for p_yes, p_no in ((p, 1 - p), (None, None)):
        yes = one.log_ratio(Answer(ON, Reply.YES, p_yes))
        no = one.log_ratio(Answer(ON, Reply.NO, p_no))
        assert isclose(yes, -no, abs_tol=1e-6)


@given(st.none() | P, SLOPE, st.floats(-2, 2), st.sampled_from([Reply.UNKNOWN, Reply.CANNOT_SEE]))
def test_an_abstention_is_worth_nothing(
    p: float | None, slope: float, intercept: float, reply: Reply
) -> None:
    one = calibration(Curve(slope=slope, intercept=intercept))
    assert one.log_ratio(Answer(ON, reply, p)) == 0.0


@given(P, P, SLOPE, st.floats(-2, 2), st.floats(0, 2))
def test_it_grows_with_p_yes_and_is_bounded(
    a: float, b: float, slope: float, intercept: float, sign: float
) -> None:
    one = calibration(Curve(slope=slope, intercept=intercept, sign=sign))
    low, high = (
        one.log_ratio(Answer(ON, Reply.YES if p > 0.5 else Reply.NO, p)) for p in sorted((a, b))
    )
    assert -BOUND <= low <= high <= BOUND


def test_it_grows_strictly_within_its_bounds() -> None:
    one = calibration(Curve(slope=0.7))
    words = {p: Reply.YES if p > 50 else Reply.NO for p in range(1, 100)}
    worths = [one.log_ratio(Answer(ON, word, p / 100)) for p, word in words.items()]
    assert all(a < b for a, b in pairwise(worths))


@given(P)
def test_where_nothing_was_learnt_a_word_counts_that_its_p_yes_contradicts(p: float) -> None:
    one = Calibration.default("v")
    assert one.log_ratio(Answer(ON, Reply.YES, p)) >= 0
    assert one.log_ratio(Answer(ON, Reply.NO, p)) <= 0
    assert one.log_ratio(Answer(ON, Reply.YES, 0.01)) == one.log_ratio(Answer(ON, Reply.YES))


def test_without_p_yes_the_counts_decide() -> None:
    one = calibration(Curve(slope=0.7), AnswerRates(0.9, 0.3, 0.0, 0.0))
    assert one.log_ratio(Answer(ON, Reply.YES)) == pytest.approx(log(0.9 / 0.3))
    assert one.log_ratio(Answer(ON, Reply.NO)) == pytest.approx(log(0.1 / 0.7))


def test_without_data_it_trusts_p_yes_half() -> None:
    one = Calibration.default("v")
    assert one.log_ratio(Answer(ON, Reply.YES, 0.9)) == pytest.approx(log(9) / 2)
    assert one.log_ratio(Answer(ON, Reply.YES)) == pytest.approx(log(0.85 / 0.15))
    assert one.group(ON).rates == AnswerRates(0.85, 0.15, 0.05, 0.05)
    assert (one.repeat(Apart.SAME_VIEW), one.repeat(Apart.OTHER_VIEW)) == (0.5, 0.25)


def test_words_that_are_the_same_stand_in_for_each_other() -> None:
    one = Calibration(
        vlm="v",
        groups=(group(Way.PRECONDITION, "on", 0.91), group(Way.ALTERNATIVE, "near", 0.92)),
        ways=(group(Way.PRECONDITION, None, 0.93), group(Way.DID, None, 0.94)),
        whole=Group(rates=AnswerRates(0.95, 0.1, 0.0, 0.0)),
        repeat_same_view=0.5,
        repeat_other_view=0.2,
    )

    def rate(way: FactWay, predicate: str) -> float:
        return one.group(FactQuestion("?", way, Atom(predicate))).rates.yes_if_true

    def rate_of_action(way: ActionWay) -> float:
        wash = Action("wash", (), Conjunction(), ())
        return one.group(ActionQuestion("?", way, wash)).rates.yes_if_true

    assert rate(Way.PRECONDITION, "on") == rate(Way.ALTERNATIVE, "on") == 0.91
    assert rate(Way.EFFECT, "on") == 0.91
    assert rate(Way.PRECONDITION, "near") == 0.92
    assert rate(Way.EFFECT, "clean") == rate(Way.ALTERNATIVE, "clean") == 0.93
    assert rate_of_action(Way.SUCCESSFUL) == 0.94
    assert rate_of_action(Way.POSSIBLE) == 0.95


@given(
    st.lists(st.sampled_from(list(Way)), unique=True),
    st.floats(0, 1),
    st.floats(0, 5, allow_nan=False),
)
def test_the_file_gives_back_what_was_written(
    tmp_path_factory: pytest.TempPathFactory, ways: list[Way], rate: float, slope: float
) -> None:
    rates = AnswerRates(max(rate, 1 - rate), min(rate, 1 - rate), 0.5, 0.25)
    kinds = tuple(Group(way=way, predicate="on", rates=rates) for way in ways)
    one = Calibration(
        vlm="openai:ü",
        rows=7,
        groups=kinds,
        whole=Group(rates=rates, curve=Curve(slope=slope)),
        repeat_same_view=rate,
        repeat_other_view=0.1,
        notices=("look out",),
    )
    path = tmp_path_factory.mktemp("file") / "new" / "c.json"
    one.group(ON)  # what is indexed for speed must not be part of it
    one.save(path)
    assert Calibration.load(path) == one
    assert [each.name for each in path.parent.iterdir()] == ["c.json"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('"version": 1', '"version": 2'), ["another version", "tpvqa calibrate"]),
        (('"yes_if_true": 0.85', '"yes_if_true": 1.85'), ["yes_if_true", "less than or equal"]),
        (('"whole"', '"hole"'), ["whole", "Field required"]),
        (("{", "["), ["Invalid JSON"]),
        (('"rows": 0', '"rows": 0, "rows": 1'), ["'rows' is given twice", "tpvqa calibrate"]),
        (
            ('"vlm": "v"', '"vlm": "v\udce9"'),
            [":3:", "0xe9 is not UTF-8", "save the file"],
        ),
        (('"rows": 0', '"rows": -5'), ["rows", "greater than or equal to 0"]),
        (('"rows": 0', '"rows": true'), ["rows", "valid integer"]),
        (('"rows": 0', f'"rows": {10**30}'), ["rows", "less than or equal"]),
        (('"yes_if_true": 0.85', '"yes_if_true": 0.05'), ["takes a yes for a no", "anew"]),
        (('"slope": 0.5', '"slope": -5.0'), ["takes a yes for a no", "anew"]),
    ],
)
def test_a_broken_file_is_named_with_its_fault_and_a_remedy(
    tmp_path: Path, change: tuple[str, str], words: list[str]
) -> None:
    path = tmp_path / "c.json"
    Calibration.default("v").save(path)
    text = path.read_text()
    assert change[0] in text
    path.write_text(text.replace(*change), errors="surrogateescape")
    with pytest.raises(CalibrationError) as error:
        Calibration.load(path)
    for word in (str(path), *words):
        assert word in str(error.value)


def test_a_byte_order_mark_is_no_fault(tmp_path: Path) -> None:
    path, one = tmp_path / "c.json", Calibration.default("v")
    one.save(path)
    path.write_bytes(BOM_UTF8 + path.read_bytes())
    assert Calibration.load(path) == one


def test_a_missing_file_and_one_that_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(CalibrationError, match=r"c\.json.*tpvqa calibrate --out"):
        Calibration.load(tmp_path / "c.json")
    (tmp_path / "folder").mkdir()
    with pytest.raises(WriteError, match="--out"):
        Calibration.default("v").save(tmp_path / "folder")
    assert [each.name for each in tmp_path.iterdir()] == ["folder"]


@pytest.mark.parametrize("lasting", [[0.0] * 9, [0.5, 0.5], [2.0, *[0.0] * 8], "often"])
def test_how_errors_last_is_checked(tmp_path: Path, lasting: object) -> None:
    path = tmp_path / "c.json"
    told = Calibration.default("a").model_dump(mode="json")
    path.write_text(json.dumps({**told, "lasting": lasting}))
    with pytest.raises(CalibrationError, match="lasting"):
        Calibration.load(path)


def test_a_file_that_does_not_say_how_errors_last_can_be_read(tmp_path: Path) -> None:
    path = tmp_path / "c.json"
    told = Calibration.default("a").model_dump(mode="json", exclude={"lasting"})
    path.write_text(json.dumps(told))
    assert Calibration.load(path).lasting_share == 0
