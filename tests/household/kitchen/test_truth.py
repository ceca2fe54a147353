"""What a picture shows, from made-up pixel counts."""

from collections.abc import Mapping

from tpvqa.pddl import Atom
from tpvqa_household.kitchen.household import Household
from tpvqa_household.kitchen.truth import Shown, objections, shown

SEEN = {"left": 500, "right": 500, "table": 20_000, "floor": 9000, "plate": 900, "dirt": 200}


def _at(near: str, *, held: Mapping[str, str] | None = None, **where: str) -> Household:
    everywhere = {"plate": "table", "bread": "counter", "apple": "fridge", "knife": "counter"}
    held = held or {}
    places = {x: p for x, p in (everywhere | where).items() if x not in held.values()}
    return Household(near=near, held=held, where=places)


def _shown(household: Household, pixels: Mapping[str, int], text: str) -> Shown:
    return shown(household, pixels, size=224)[Atom.parse(text)]


def test_the_near_thing_is_seen_and_other_things_are_seen_to_be_missing() -> None:
    household = _at("plate")
    assert _shown(household, SEEN, "near(plate)") == Shown(true=True, visible=True)
    assert _shown(household, SEEN, "near(bread)") == Shown(true=False, visible=True)
    assert _shown(household, SEEN, "near(table)") == Shown(true=False, visible=False)


def test_a_thing_that_is_near_but_hidden_cannot_be_judged() -> None:
    assert not _shown(_at("apple"), {"fridge": 20_000}, "near(apple)").visible


def test_a_held_thing_is_not_near_but_looks_as_if_it_were() -> None:
    household = _at("tv", held={"left": "bread"})
    pixels = {"tv": 5000, "bread": 2000, "left": 300, "right": 300}
    assert not _shown(household, pixels, "near(bread)").visible
    assert _shown(household, pixels, "in_hand(bread,left)") == Shown(true=True, visible=True)
    assert _shown(household, pixels, "in_hand(bread,right)") == Shown(true=False, visible=True)
    assert _shown(household, pixels, "on(bread,counter)") == Shown(true=False, visible=True)


def test_hands_out_of_view_tell_nothing() -> None:
    pixels = {"plate": 900, "left": 5, "right": 500}
    assert not _shown(_at("plate"), pixels, "in_hand(bread,left)").visible


def test_dirt_that_is_covered_is_not_seen() -> None:
    assert _shown(_at("plate"), SEEN, "clean(plate)") == Shown(true=False, visible=True)
    assert not _shown(_at("plate"), SEEN | {"dirt": 0}, "clean(plate)").visible


def test_a_few_pixels_of_dirt_are_not_seen() -> None:
    for peeping in (14, 50, 99):
        assert not _shown(_at("plate"), SEEN | {"dirt": peeping}, "clean(plate)").visible
    assert _shown(_at("plate"), SEEN | {"dirt": 100}, "clean(plate)").visible


def test_the_fridge_hides_what_is_in_it_until_the_robot_looks_inside() -> None:
    household = Household(near="fridge", where=_at("fridge").where, opened=True)
    assert not _shown(household, {"fridge": 20_000}, "on(apple,fridge)").visible
    assert _shown(household, {"fridge": 20_000, "inside": 4000}, "opened(fridge)").visible


def test_thresholds_grow_with_the_picture() -> None:
    large = shown(_at("knife"), {"knife": 60, "left": 900, "right": 900}, size=448)
    assert not large[Atom.parse("near(knife)")].visible


def test_nothing_is_near_a_camera_that_is_not_the_robots() -> None:
    found = shown(_at("plate"), SEEN, size=224, first_person=False)
    assert not found[Atom.parse("near(plate)")].visible
    assert not found[Atom.parse("in_hand(bread,left)")].visible
    assert found[Atom.parse("on(plate,table)")] == Shown(true=True, visible=True)


def test_a_good_picture_has_no_objections_and_a_bad_one_has() -> None:
    household = _at("plate")
    assert objections(household, SEEN, size=224) == 0
    assert objections(household, SEEN | {"plate": 10}, size=224) > 0
    assert objections(household, SEEN | {"bread": 300}, size=224) > 0
    assert objections(household, SEEN | {"tv": 300}, size=224) > 0
    assert objections(household, SEEN | {"floor": 0}, size=224) > 0
