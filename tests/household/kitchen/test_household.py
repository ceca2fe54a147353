import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.chance import chance_array
from tpvqa.errors import WorldError
from tpvqa.pddl import Atom
from tpvqa_household.kitchen.household import HANDS, ITEMS, Household
from tpvqa_household.kitchen.states import sample_state


@given(st.integers(0, 10_000), st.floats(0, 1))
def test_reading_a_state_and_writing_it_again_loses_nothing(seed: int, wild: float) -> None:
    state = sample_state(chance_array(seed, 0, "test"), wild=wild)
    assert Household.read(state).state() == state


@given(st.integers(0, 10_000))
def test_every_sampled_item_is_in_one_place(seed: int) -> None:
    household = Household.read(sample_state(chance_array(seed, 0, "test")))
    for item in ITEMS:
        assert (item in household.where) != (item in household.hand_of)
        assert item not in household.upon(item)
    assert set(household.held) <= set(HANDS)


def test_sampled_states_cover_every_thing_and_every_flag() -> None:
    found = [Household.read(sample_state(chance_array(k, 0, "test"))) for k in range(400)]
    assert len({h.near for h in found}) == 10
    assert {len(h.held) for h in found} == {0, 1, 2}
    assert {place for h in found for place in h.where.values()} >= {
        "table",
        "counter",
        "floor",
        "sink",
        "fridge",
        "plate",
    }
    for flag in ("opened", "turned_on", "clean", "halved"):
        assert {getattr(h, flag) for h in found} == {True, False}


HOME = "near(tv); on(plate,table); on(bread,plate); on(apple,fridge); on(knife,counter)"


def _state(text: str) -> frozenset[Atom]:
    return frozenset(Atom.parse(part) for part in text.split(";"))


def test_what_lies_on_what_is_found_through_other_items() -> None:
    household = Household.read(_state(HOME))
    assert household.support("bread") == "table"
    assert household.upon("table") == ("plate", "bread")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("near(tv)", "free(left)"), "near 0 things"),
        (("near(tv)", "near(tv); near(sink)"), "near 2 things"),
        (("on(knife,counter)", "free(left)"), "knife: each must be"),
        (("on(knife,counter)", "on(knife,counter); in_hand(knife,left)"), "knife: each must be"),
        (("on(knife,counter)", "on(knife,moon)"), "cannot show"),
        (("on(bread,plate)", "in_hand(bread,left); in_hand(plate,left)"), "left holds both"),
    ],
)
def test_a_state_that_contradicts_itself_is_refused(change: tuple[str, str], message: str) -> None:
    with pytest.raises(WorldError, match=message):
        Household.read(_state(HOME.replace(*change)))
