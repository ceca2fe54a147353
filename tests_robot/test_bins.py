"""Robosuite's pick-and-place by the toys' robot."""

from collections.abc import Iterator
from threading import Event

import numpy as np
import pytest

from tpvqa import Atom, Task, TpvqaError, load_task
from tpvqa.errors import PluginError
from tpvqa.tasks import find_task
from tpvqa.worlds import Report
from tpvqa_robots.bins.scene import AT, HALF, SOURCE, THINGS
from tpvqa_robots.bins.world import APART, BinsWorld, spots
from tpvqa_robots.mishaps import Mishaps


@pytest.fixture(scope="module")
def groceries() -> Task:
    files = find_task("sort_groceries")
    assert files.default_world == "bins"
    return load_task(files.domain, files.problem)


@pytest.fixture
def bins(groceries: Task) -> Iterator[BinsWorld]:
    made = BinsWorld(groceries, seed=1)
    yield made
    made.close()


def test_a_thing_goes_from_the_big_bin_into_its_own(bins: BinsWorld, groceries: Task) -> None:
    begun = bins.snapshot()
    assert all(bins.truth.holds(Atom("in", (name, SOURCE))) for name in THINGS)
    for name, words, then in (
        ("pick_up", ("cereal", "big_bin"), Atom("in_hand", ("cereal",))),
        ("place", ("cereal", "cereal_bin"), Atom("in", ("cereal", "cereal_bin"))),
    ):
        done = bins.execute(groceries.action(name, words))
        assert (done.report, bins.truth.holds(then)) == (Report.DONE, True), done.message
    missing = bins.execute(groceries.action("place", ("milk", "milk_bin")))
    assert (missing.report, missing.message) == (Report.FAILED, "milk is not in the hand")
    assert bins.truth.holds(Atom("in", ("milk", SOURCE)))
    bins.restore(begun)
    assert bins.truth.holds(Atom("in", ("cereal", SOURCE)))


def test_a_grasp_beside_the_thing_takes_nothing(groceries: Task) -> None:
    world = BinsWorld(groceries, mishaps=Mishaps(bad=1.0), seed=1)
    done = world.execute(groceries.action("pick_up", ("milk", "big_bin")), cancel=Event())
    assert done.report is Report.DONE  # the skill does not know; the fingers do
    assert [fact.probability > 0.5 for fact in done.facts] == [True]
    assert not world.truth.holds(Atom("in_hand", ("milk",)))
    world.close()


def test_things_stand_apart_within_the_big_bin() -> None:
    for seed in range(50):
        found = list(spots(seed, 0).values())
        for i, spot in enumerate(found):
            assert abs(spot.x - AT[SOURCE][0]) < HALF[0]
            assert abs(spot.y - AT[SOURCE][1]) < HALF[1]
            for other in found[:i]:
                assert np.hypot(spot.x - other.x, spot.y - other.y) >= APART


def test_what_it_does_not_know_is_refused(task: Task, groceries: Task) -> None:
    with pytest.raises(TpvqaError, match="'bins' cannot tell when"):
        BinsWorld(task)
    with pytest.raises(PluginError, match=r"'bins' does not understand 'appendix'.*bins:slip"):
        BinsWorld.from_spec("appendix", task=groceries, seed=0, episode=0)
