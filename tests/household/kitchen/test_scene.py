"""Kitchens are built and drawn; needs MuJoCo and software GL."""

from collections.abc import Iterator

import numpy as np
import pytest

from tpvqa.chance import chance_array
from tpvqa.errors import UnknownNameError, WorldError
from tpvqa.pddl import Atom, State
from tpvqa_household.kitchen.household import Household, atoms_of_interest
from tpvqa_household.kitchen.sample import pictures
from tpvqa_household.kitchen.scene import KitchenScene
from tpvqa_household.kitchen.states import sample_state

pytestmark = pytest.mark.rendering


@pytest.fixture(scope="module", params=["train", "held_out"])
def scene(request: pytest.FixtureRequest) -> Iterator[KitchenScene]:
    made = KitchenScene(seed=5, split=request.param)
    yield made
    made.close()
    made.close()


def _state(near: str, *more: str, **where: str) -> State:
    places = {"plate": "table", "bread": "counter", "apple": "fridge", "knife": "counter"}
    facts = [Atom.parse(text) for text in more]
    held = {atom.arguments[0] for atom in facts if atom.predicate == "in_hand"}
    facts += [Atom("on", (x, p)) for x, p in (places | where).items() if x not in held]
    return frozenset([Atom("near", (near,)), *facts])


def test_pictures_are_pictures(scene: KitchenScene) -> None:
    scene.arrange(_state("plate"), look=0)
    picture = scene.render()
    assert picture.shape == (224, 224, 3)
    assert picture.dtype == np.uint8
    assert picture.std() > 10


@pytest.mark.parametrize("near", ["plate", "bread", "knife", "table", "counter", "sink", "tv"])
def test_the_near_thing_is_in_view_and_no_other_item_is(scene: KitchenScene, near: str) -> None:
    for look in range(3):
        scene.arrange(_state(near), look=look)
        shown = scene.shown()
        assert shown[Atom("near", (near,))].visible
        for item in {"plate", "bread", "apple", "knife"} - {near}:
            if Household.read(_state(near)).where[item] != near:
                assert scene.pixels()[item] == 0, (item, look)


def test_the_open_fridge_shows_its_apple_only_from_near_the_apple(scene: KitchenScene) -> None:
    scene.arrange(_state("fridge", "opened(fridge)"), look=0)
    hidden = scene.pixels()["apple"] == 0
    assert hidden or scene.wrong > 0  # a table may stand where the robot should: then it says so
    assert scene.shown()[Atom.parse("near(apple)")].visible == hidden
    assert scene.shown()[Atom.parse("opened(fridge)")].visible
    scene.arrange(_state("apple", "opened(fridge)"), look=0)
    assert scene.pixels()["apple"] > 40
    scene.arrange(_state("apple"), look=0)
    assert scene.pixels()["apple"] == 0
    assert not scene.shown()[Atom.parse("near(apple)")].visible


def test_what_is_held_is_in_view(scene: KitchenScene) -> None:
    scene.arrange(_state("tv", "in_hand(plate,left)", "in_hand(knife,right)"), look=1)
    assert scene.pixels()["plate"] > 500
    assert scene.pixels()["knife"] > 100
    assert scene.shown()[Atom.parse("in_hand(plate,left)")].visible


@pytest.mark.parametrize(
    ("fact", "near"),
    [("clean(plate)", "plate"), ("turned_on(tv)", "tv"), ("opened(fridge)", "fridge")],
)
def test_a_fact_changes_the_picture(scene: KitchenScene, fact: str, near: str) -> None:
    scene.arrange(_state(near), look=2)
    without = scene.render()
    scene.arrange(_state(near, fact), look=2)
    assert (scene.render() != without).any()
    assert scene.shown()[Atom.parse(fact)].true


def test_dirt_goes_with_cleaning_and_halves_come_with_cutting(scene: KitchenScene) -> None:
    scene.arrange(_state("plate"), look=0)
    assert scene.pixels()["dirt"] > 20
    scene.arrange(_state("plate", "clean(plate)"), look=0)
    assert scene.pixels()["dirt"] == 0
    scene.arrange(_state("apple", "halved(apple)", apple="table"), look=0)
    assert scene.pixels()["apple"] > 40


def test_the_same_look_is_the_same_picture_and_another_is_not(scene: KitchenScene) -> None:
    scene.arrange(_state("bread"), look=7)
    first = scene.render()
    scene.arrange(_state("tv", "turned_on(tv)"), look=3)
    scene.arrange(_state("bread"), look=7)
    assert (scene.render() == first).all()
    scene.arrange(_state("bread"), look=8)
    assert (scene.render() != first).any()


def test_steady_things_stay_where_they_are(scene: KitchenScene) -> None:
    where = []
    for look in range(3):
        scene.arrange(_state("bread"), look=look, placement="live", steady=True)
        where.append(scene.data.body("bread").xpos.copy())
    assert np.allclose(where[0], where[1])
    assert np.allclose(where[0], where[2])


def test_every_fact_is_judged_and_truth_is_the_states(scene: KitchenScene) -> None:
    for look in range(6):
        state = sample_state(chance_array(look, 0, "test"))
        view = scene.views()[look % len(scene.views())]
        scene.arrange(state, look=look, view=view)
        shown = scene.shown()
        assert set(shown) == set(atoms_of_interest())
        assert {atom for atom, fact in shown.items() if fact.true} == state


def test_a_view_that_does_not_exist_is_refused(scene: KitchenScene) -> None:
    with pytest.raises(UnknownNameError, match="overview"):
        scene.arrange(_state("tv"), look=0, view="overviw")


def test_nothing_arranged_is_nothing_to_draw() -> None:
    made = KitchenScene(seed=1)
    with pytest.raises(WorldError, match="arrange"):
        made.render()
    made.close()


def test_dropped_things_lie_on_the_floor_and_rest(scene: KitchenScene) -> None:
    for item in ("plate", "bread", "apple", "knife"):
        pose = scene.drop(item, at=np.array([0.0, -2.0, 1.0]), key=("test", 0))
        again = scene.drop(item, at=np.array([0.0, -2.0, 1.0]), key=("test", 0))
        assert np.allclose(pose.position, again.position)
        assert np.allclose(pose.axes @ pose.axes.T, np.eye(3), atol=1e-6)
        high = max(scene.furniture.models[item].extent)
        assert -0.02 < pose.position[2] < high, item


def test_what_is_in_the_open_fridge_is_nearly_always_hidden() -> None:
    state = _state("fridge", "opened(fridge)")
    hidden = 0
    for seed in range(4):
        scene = KitchenScene(seed=seed)
        for look in range(3):
            scene.arrange(state, look=look)
            hidden += scene.pixels()["apple"] == 0
        scene.close()
    assert hidden >= 10


def test_training_pictures_repeat_and_mostly_show_what_they_are_about() -> None:
    first = list(pictures(3, 12))
    again = list(pictures(3, 12))
    for a, b in zip(first, again, strict=True):
        assert (a.pixels == b.pixels).all()
        assert a.state == b.state
    good = 0
    for picture in first:
        near = Household.read(picture.state).near
        good += picture.shown[Atom("near", (near,))].visible or picture.info["view"] == "overview"
    assert good >= 9
