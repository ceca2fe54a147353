"""Pictures on disk, and which questions training asks about them."""

from pathlib import Path

import numpy as np

from tests.household.training.household import facts, shows
from tpvqa.chance import chance_array
from tpvqa_household.kitchen.household import FIXTURES, ITEMS, Household
from tpvqa_household.training import shards
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.data import Pictures
from tpvqa_household.training.facts import FactTable
from tpvqa_household.training.labels import Label
from tpvqa_household.training.sampling import Sampler, answer_class
from tpvqa_household.training.states import random_household

ASKING = Asking.about("clean_dishes")


def part(seed: int, count: int = 40) -> shards.Shard:
    """Random states with noise for pictures, everything near or held in view."""
    rng = chance_array(seed, 0, "test")
    households = [random_household(rng) for _ in range(count)]
    pixels = rng.integers(0, 256, (count, 8, 8, 3), dtype=np.uint8)
    tables = [{**facts(h), **shows(h.near, *h.held.values())} for h in households]
    things = (*ITEMS, *FIXTURES)
    info = [
        {"pixels": {t: 9999 * (t == h.near or t in h.hand_of) for t in things}} for h in households
    ]
    return shards.Shard(pixels, FactTable.of(tables), info)


def test_a_part_is_read_as_it_was_written(tmp_path: Path) -> None:
    written = part(3)
    shards.write(shards.path_of(tmp_path, "train", 3), written)
    read = shards.read(shards.path_of(tmp_path, "train", 3))
    np.testing.assert_array_equal(read.pixels, written.pixels)
    np.testing.assert_array_equal(read.table.true, written.table.true)
    np.testing.assert_array_equal(read.table.visible, written.table.visible)
    assert read.table.atoms == written.table.atoms
    assert list(read.info) == list(written.info)


def test_pictures_grow_with_their_folder_and_keep_to_their_seeds(tmp_path: Path) -> None:
    about = (ASKING.subjects, ASKING.actions)
    pictures = Pictures(tmp_path, "train", *about, seeds=range(10))
    assert pictures.refresh() == 0
    shards.write(shards.path_of(tmp_path, "train", 1), part(1))
    shards.write(shards.path_of(tmp_path, "train", 10), part(10))
    assert pictures.refresh() == 40
    second = part(2)
    shards.write(shards.path_of(tmp_path, "train", 2), second)
    assert pictures.refresh() == 80
    np.testing.assert_array_equal(pictures.pixels(np.array([40, 79])), second.pixels[[0, 39]])


def test_every_way_of_asking_has_its_share(tmp_path: Path) -> None:
    shards.write(shards.path_of(tmp_path, "train", 0), part(0, 200))
    pictures = Pictures(tmp_path, "train", ASKING.subjects, ASKING.actions)
    pictures.refresh()
    sampler = Sampler(ASKING.subjects, ASKING.lexicon, pictures.labels, per_share=2)
    asked = sampler.draw(np.arange(200), np.random.default_rng(0))
    assert asked.tokens.shape[:2] == (200, 10)
    words = np.array(["", *ASKING.lexicon.vocabulary])
    first = words[asked.tokens[:, :, :3]]
    ways = {
        "possible": (first[:, :, 0] == "could") | (first[:, :, 2] == "possible"),
        "did": first[:, :, 0] == "did",
    }
    for way, place in (("possible", slice(4, 6)), ("did", slice(8, 10))):
        assert ways[way][:, place].mean() > 0.3
        assert not ways[way][:, :4].any()
    # No answer drowns the others.
    shares = np.bincount(asked.answers[asked.answers >= 0], minlength=3) / asked.answers.size
    assert shares[0] > 0.25
    assert shares[1] > 0.25


def test_the_same_seed_asks_the_same(tmp_path: Path) -> None:
    shards.write(shards.path_of(tmp_path, "train", 0), part(0))
    pictures = Pictures(tmp_path, "train", ASKING.subjects, ASKING.actions)
    pictures.refresh()
    sampler = Sampler(ASKING.subjects, ASKING.lexicon, pictures.labels)
    one, two = (sampler.draw(np.arange(8), np.random.default_rng(5)) for _ in range(2))
    np.testing.assert_array_equal(one.tokens, two.tokens)
    np.testing.assert_array_equal(one.answers, two.answers)


def test_an_inverted_wording_turns_the_answer_round() -> None:
    assert answer_class(Label.YES) == answer_class(Label.NO, inverted=True) == 0
    assert answer_class(Label.HARD_NO) == answer_class(Label.YES, inverted=True) == 1
    assert answer_class(Label.CANNOT_SEE, inverted=True) == 2
    assert answer_class(Label.UNCLEAR) == -1


def test_random_households_can_be_read_back() -> None:
    rng = chance_array(1, 0, "test")
    for _ in range(200):
        household = random_household(rng)
        assert Household.read(household.state()) == household
