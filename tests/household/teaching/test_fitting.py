"""The heads: against scikit-learn; what is held back; where pictures end."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from sklearn.linear_model import LogisticRegression

from tpvqa.errors import TrainingError
from tpvqa.training.example import Example
from tpvqa_household.embedded.taught.sight import WIDE
from tpvqa_household.teaching.heads import FOLDS, fit_heads, folds_of
from tpvqa_household.teaching.kinds import FALSE_ALARMS, known_pictures
from tpvqa_household.teaching.lessons import lessons_of
from tpvqa_household.teaching.logistic import even, fitted
from tpvqa_household.teaching.variants import variant


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("strength", [0.1, 10.0, 1000.0])
def test_coefficients_are_those_of_scikit_learn(seed: int, strength: float) -> None:
    rng = np.random.default_rng(seed)
    count, wide = int(rng.integers(6, 60)), int(rng.integers(1, 30))
    x = rng.normal(size=(count, wide))
    y = (x[:, 0] + rng.normal(size=count) > rng.normal()).astype(np.int64)
    y[:2] = 0, 1
    weight = even(y, float(count))
    ours = fitted(x, y.astype(float), weight, strength)
    model = LogisticRegression(C=strength, tol=1e-10, max_iter=100_000)
    model.fit(x, y, sample_weight=weight)
    theirs = np.concatenate([model.coef_[0], model.intercept_])
    np.testing.assert_allclose(ours, theirs, rtol=2e-3, atol=2e-3 * np.abs(theirs).max())
    again = fitted(x, y.astype(float), weight, strength, start=rng.normal(size=wide + 1))
    np.testing.assert_allclose(again, ours, rtol=1e-4, atol=1e-4 * np.abs(ours).max())


@given(st.lists(st.integers(0, 7), min_size=1, max_size=40), st.integers(0, 3))
def test_a_group_is_in_one_fold(names: list[int], seed: int) -> None:
    folds = folds_of(np.array([str(name) for name in names]), seed)
    assert len(set(zip(names, folds.tolist(), strict=True))) == len(set(names))
    sizes = np.bincount([fold for _, fold in set(zip(names, folds.tolist(), strict=True))])
    assert sizes.max() <= -(-len(set(names)) // FOLDS)


def test_heads_learn_and_are_as_sure_as_they_are_right() -> None:
    rng = np.random.default_rng(3)
    shown = rng.normal(size=(400, 12))
    spread = shown @ rng.normal(size=(12, 2 * WIDE)) + 0.3 * rng.normal(size=(400, 2 * WIDE))
    features = spread.astype(np.float32)
    truth = np.stack([shown[:, 0] * 6, shown[:, 1] * 3 - shown[:, 2]], 1)
    labels = (truth + rng.logistic(size=truth.shape) > 0).astype(np.int64)
    labels[rng.random(labels.shape) < 0.1] = -1
    learnt, new = slice(0, 300), slice(300, None)
    fit = fit_heads(features[None, learnt], labels[learnt], np.arange(300).astype(str))
    odds = features[new] @ fit.weights.T + fit.bias
    for column in range(2):
        known = labels[new][:, column] >= 0
        y, z = labels[new][known, column], odds[known, column]
        signed = np.where(y == 1, z, -z)
        best = np.where(y == 1, truth[new][known, column], -truth[new][known, column])
        assert np.logaddexp(0, -signed).mean() < np.logaddexp(0, -best).mean() + 0.08
        assert (signed > 0).mean() > (best > 0).mean() - 0.06
        held = fit.held_back[:, column]
        assert np.isnan(held).tolist() == (labels[learnt][:, column] < 0).tolist()


def test_labels_that_hang_on_nothing_are_not_believed() -> None:
    rng = np.random.default_rng(4)
    features = rng.normal(size=(60, 2 * WIDE)).astype(np.float32)
    labels = rng.integers(0, 2, (60, 3))
    fit = fit_heads(features[None], labels, np.arange(60).astype(str))
    new = rng.normal(size=(100, 2 * WIDE)).astype(np.float32) @ fit.weights.T + fit.bias
    assert np.abs(new).mean() < 0.5


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 1000))
def test_few_pictures_like_those_taught_are_taken_for_unlike(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mixed = rng.normal(size=(6, 40))
    kinds = (rng.normal(size=(400, 6)) @ mixed + rng.normal(size=(400, 40)) * 0.3).astype(
        np.float32
    )
    known = known_pictures(kinds[:200], folds_of(np.arange(200).astype(str), 0))
    alarms = (known.distance(kinds[200:]) > 1).mean()
    assert alarms <= FALSE_ALARMS + 0.06
    assert (known.distance(kinds[200:] + 8) > 1).all()


def test_views_of_a_picture_are_not_told_apart_from_it_when_it_is_held_back() -> None:
    """Heads that the second view of a picture taught would know it by heart."""
    rng = np.random.default_rng(5)
    seen = rng.normal(size=(60, 2 * WIDE)).astype(np.float32)
    labels = rng.integers(0, 2, (60, 1))
    fit = fit_heads(np.stack([seen, seen]), labels, np.arange(60).astype(str))
    right = (fit.held_back[:, 0] > 0) == (labels[:, 0] == 1)
    assert 0.25 < right.mean() < 0.75


def test_another_view_keeps_left_and_right_and_the_first_is_the_picture() -> None:
    picture = Image.new("RGB", (90, 60), "black")
    picture.paste((250, 20, 20), (0, 0, 40, 60))
    assert variant(picture, "a", 0, 3) is picture
    others = [np.asarray(variant(picture, "a", number, 3)) for number in range(1, 6)]
    for other in others:
        assert other.shape == (60, 90, 3)
        assert other[20:40, 10:30, 0].mean() > 100
        assert other[20:40, 60:80].max() < 60
    assert not np.array_equal(others[0], others[1])
    assert np.array_equal(others[0], np.asarray(variant(picture, "a", 1, 3)))


def test_a_table_of_what_is_taught_holds_each_answer_once() -> None:
    def one(picture: int, text: str, *, truth: bool) -> Example:
        return Example(bytes([picture]), "image/png", text, truth, "lit")

    said = [one(n, "Is the lamp lit?", truth=n % 2 == 0) for n in range(8)]
    said += [one(n, "is lamp lit", truth=n % 2 == 0) for n in range(7)]
    said += [one(7, "Is the lamp lit", truth=True)]  # and not: nothing is known of it
    said += [one(n, "Is there a lamp?", truth=True) for n in range(8)]
    table = lessons_of(said)
    assert table.questions == ["is lamp lit"]
    assert table.labels[:, 0].tolist() == [1, 0, 1, 0, 1, 0, 1, -1]
    assert table.unlearnt == {"is there lamp": "taught with 8 yes and 0 no; it needs 3 of each"}
    with pytest.raises(TrainingError, match="no words"):
        lessons_of([one(1, "The?!", truth=True)])


@given(
    st.lists(st.tuples(st.integers(0, 9), st.sampled_from([1, 0, -1])), min_size=1, max_size=40),
    st.integers(0, 3),
)
def test_both_answers_are_in_several_folds_where_several_groups_have_them(
    rows: list[tuple[int, int]], seed: int
) -> None:
    groups, labels = np.array([str(g) for g, _ in rows]), np.array([label for _, label in rows])
    folds = folds_of(groups, seed, labels)
    pairs = set(zip(groups.tolist(), folds.tolist(), strict=True))
    assert len(pairs) == len(set(groups.tolist()))
    with_yes = {g for g, label in rows if label == 1}
    yes_alone = with_yes - {g for g, label in rows if label == 0}
    spread = {fold for g, fold in pairs if int(g) in yes_alone}
    assert len(spread) == min(FOLDS, len(yes_alone))
