from hypothesis import given
from hypothesis import strategies as st

from tpvqa.pddl import Atom, State
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.visible import describe, mirrored, visible_state


def state(*facts: str) -> State:
    return frozenset(map(Atom.parse, facts))


HOME = ("on plate table", "on bread counter", "on apple fridge", "on knife counter")


def test_a_picture_does_not_name_the_hand() -> None:
    rest = ("near sink", "on bread counter", "on apple fridge", "on knife counter")
    left = visible_state(state("in_hand plate left", "free right", *rest))
    right = visible_state(state("in_hand plate right", "free left", *rest))
    assert left == right
    assert describe(left) == "in_hand(plate), near(sink)"


def test_a_closed_door_hides_what_lies_behind_it() -> None:
    shut = visible_state(state("near fridge", "free left", "free right", *HOME))
    opened = visible_state(state("near fridge", "opened fridge", *HOME))
    assert describe(shut) == "near(fridge)"
    assert describe(opened) == "near(fridge), opened(fridge)", "it has not looked for it yet"
    found = visible_state(state("near apple", "opened fridge", *HOME))
    assert describe(found) == "near(apple), on(apple, fridge), opened(fridge)"


def test_whether_a_hidden_apple_is_cut_does_not_show() -> None:
    whole = state("near apple", *HOME)
    assert visible_state(whole) == visible_state(whole | state("halved apple"))
    seen = whole | state("opened fridge")
    assert visible_state(seen) != visible_state(seen | state("halved apple"))


def test_what_lies_on_the_thing_looked_at_is_in_view_but_not_what_lies_beside_it() -> None:
    served = state(
        "near plate", "on plate table", "on bread plate", "on apple table", "on knife counter"
    )
    assert describe(visible_state(served)) == "near(plate), on(bread, plate), on(plate, table)"


def test_the_plate_under_the_bread_is_in_view_with_its_dirt() -> None:
    served = state("near bread", "on plate table", "on bread plate", "on apple fridge")
    served |= state("on knife counter", "clean plate")
    assert Atom.parse("clean plate") in visible_state(served)


@given(data=st.data())
def test_states_that_differ_only_in_the_hand_look_alike(
    shipped_reachable: list[Reachable], data: st.DataObject
) -> None:
    states = sorted(
        (state for task in shipped_reachable for state in task.states), key=lambda s: sorted(s)
    )
    drawn = data.draw(st.sampled_from(states))
    assert visible_state(drawn) == visible_state(frozenset(map(mirrored, drawn)))
