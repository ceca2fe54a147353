"""States that no plan leads on from: found where they show, and no disturbance leads there."""

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.listing import every_state
from tests.pddl.conditional_domains import tasks
from tpvqa.belief.states.dead_ends import DeadEnds
from tpvqa.belief.states.undoing import BackToBefore
from tpvqa.pddl import Atom, Task, task_from_text


def airport() -> Task:
    """A tug with a cart behind it goes where the cart goes, and nowhere without it."""
    return task_from_text(
        """(define (domain airport) (:types tug cart place - object)
        (:predicates (tug-at ?t - tug ?p - place) (cart-at ?c - cart ?p - place)
          (hitched ?c - cart ?t - tug) (unhitched ?c - cart) (no-cart ?t - tug))
        (:action drive :parameters (?t - tug ?from ?to - place)
          :precondition (and (tug-at ?t ?from) (no-cart ?t))
          :effect (and (not (tug-at ?t ?from)) (tug-at ?t ?to)))
        (:action tow :parameters (?t - tug ?c - cart ?from ?to - place)
          :precondition (and (tug-at ?t ?from) (cart-at ?c ?from) (hitched ?c ?t))
          :effect (and (not (tug-at ?t ?from)) (tug-at ?t ?to)
                       (not (cart-at ?c ?from)) (cart-at ?c ?to)))
        (:action hitch :parameters (?c - cart ?t - tug ?p - place)
          :precondition (and (tug-at ?t ?p) (cart-at ?c ?p) (unhitched ?c) (no-cart ?t))
          :effect (and (hitched ?c ?t) (not (unhitched ?c)) (not (no-cart ?t))))
        (:action unhitch :parameters (?c - cart ?t - tug ?p - place)
          :precondition (and (tug-at ?t ?p) (cart-at ?c ?p) (hitched ?c ?t))
          :effect (and (unhitched ?c) (no-cart ?t) (not (hitched ?c ?t)))))""",
        """(define (problem p) (:domain airport)
        (:objects t - tug c - cart apron hall gate - place)
        (:init (tug-at t apron) (cart-at c hall) (unhitched c) (no-cart t))
        (:goal (and (cart-at c gate) (unhitched c))))""",
    )


def facts(words: str) -> frozenset[Atom]:
    return frozenset(Atom.parse(f"({each})") for each in words.split(", "))


def depot() -> Task:
    """A robot that holds a cable drives nowhere; what is wanted follows from what it does."""
    return task_from_text(
        """(define (domain depot) (:types bay cable - object)
        (:predicates (at ?b - bay) (of ?k - cable ?b - bay) (held ?k - cable) (hung ?k - cable)
          (free) (plugged ?k - cable) (on ?b - bay) (charging ?b - bay))
        (:derived (charging ?b - bay)
          (exists (?k - cable) (and (of ?k ?b) (plugged ?k) (on ?b))))
        (:action drive :parameters (?from ?to - bay)
          :precondition (and (at ?from) (forall (?k - cable) (not (held ?k))))
          :effect (and (at ?to) (not (at ?from))))
        (:action unhook :parameters (?k - cable ?b - bay)
          :precondition (and (at ?b) (of ?k ?b) (hung ?k) (free))
          :effect (and (held ?k) (not (hung ?k)) (not (free))))
        (:action plug :parameters (?k - cable ?b - bay)
          :precondition (and (at ?b) (of ?k ?b) (held ?k))
          :effect (and (plugged ?k) (free) (not (held ?k))))
        (:action switch :parameters (?b - bay) :precondition (and (at ?b) (free))
          :effect (on ?b)))""",
        """(define (problem p) (:domain depot) (:objects one two - bay red blue - cable)
        (:init (at one) (of red one) (of blue two) (hung red) (hung blue) (free))
        (:goal (and (charging one) (charging two))))""",
    )


HITCHED = facts("tug-at t hall, cart-at c hall, hitched c t")


def test_a_tug_is_not_torn_from_its_cart() -> None:
    """It would stand where it came from, hitched to what is elsewhere, and could not move."""
    task = airport()
    history = [Atom.parse("(tug-at t apron)")]
    back = BackToBefore(task)
    assert back.results(Atom.parse("(tug-at t hall)"), HITCHED, history, task) == []
    loose = facts("tug-at t hall, cart-at c hall, unhitched c, no-cart t")
    [(_, after)] = back.results(Atom.parse("(tug-at t hall)"), loose, history, task)
    assert after == task.init
    assert DeadEnds(task).holds(facts("tug-at t apron, cart-at c hall, hitched c t"))
    assert not DeadEnds(task).holds(HITCHED)


def test_a_cable_is_not_back_where_the_robot_would_be_stuck_with_it() -> None:
    """The goal follows from other facts: it is reached where what it follows from is."""
    task, red = depot(), Atom.parse("(plugged red)")
    history = [*facts("hung red"), *facts("held red")]
    for bay, results in (("one", 1), ("two", 0)):
        state = (task.init - facts("at one, hung red")) | facts(f"at {bay}, on one") | {red}
        assert len(BackToBefore(task).results(red, state, history, task)) == results


def lamps(door: str) -> Task:
    """Light the lamps and go through a door that may have to be unlocked."""
    return task_from_text(
        """(define (domain hall) (:types lamp door)
        (:predicates (lit ?l - lamp) (locked ?d - door) (unlocked ?d - door) (through ?d - door))
        (:action light :parameters (?l - lamp) :precondition () :effect (lit ?l))
        (:action unlock :parameters (?d - door) :precondition (locked ?d)
          :effect (and (unlocked ?d) (not (locked ?d))))
        (:action enter :parameters (?d - door) :precondition (unlocked ?d)
          :effect (through ?d)))""",
        f"""(define (problem p) (:domain hall) (:objects a b - lamp d - door)
        (:init ({door} d)) (:goal (and (lit a) (lit b) (through d))))""",
    )


def test_where_what_nothing_brings_about_holds_nothing_is_said() -> None:
    """The door is locked, against the problem: to unlock it is no ground action there."""
    task, locked = lamps("unlocked"), facts("lit a, locked d")
    assert not DeadEnds(task).holds(locked)
    [(_, after)] = BackToBefore(task).results(Atom.parse("(lit a)"), locked, [], task)
    assert after == facts("locked d")


def test_where_what_nothing_ends_does_not_hold_nothing_is_said() -> None:
    """The door is stuck for ever, so that no ground action goes through it."""
    task = task_from_text(
        """(define (domain hall) (:predicates (stuck) (lit) (through))
        (:action light :parameters () :precondition (and) :effect (lit))
        (:action enter :parameters () :precondition (and (lit) (not (stuck)))
          :effect (through)))""",
        "(define (problem p) (:domain hall) (:init (stuck)) (:goal (through)))",
    )
    assert DeadEnds(task).holds(task.init)
    assert not DeadEnds(task).holds(frozenset())


def test_what_is_said_of_a_state_does_not_depend_on_who_asked_before() -> None:
    """Without a key a door that closes is closed for good; where it stood open that is no worse, as
    it may be said to have come from there."""
    task = task_from_text(
        """(define (domain vault) (:predicates (open) (key) (rich))
        (:action lock :parameters () :precondition (open) :effect (not (open)))
        (:action drop :parameters () :precondition (key) :effect (not (key)))
        (:action unlock :parameters () :precondition (key) :effect (open))
        (:action take :parameters () :precondition (and (open) (key)) :effect (rich))
        (:action pull :parameters () :precondition (not (open)) :effect (open)))""",
        "(define (problem p) (:domain vault) (:init (open) (key)) (:goal (rich)))",
    )
    shut, before = frozenset[Atom](), facts("open")
    fresh = {given: DeadEnds(task).holds(shut, given) for given in (frozenset[Atom](), before)}
    assert len({*fresh.values()}) == 2
    for order in (tuple(fresh), tuple(reversed(fresh))):
        asked = DeadEnds(task)
        assert {given: asked.holds(shut, given) for given in order} == fresh


def test_a_task_that_was_opened_is_another() -> None:
    closed = lamps("unlocked")
    opened = closed.opened_to([Atom.parse("(locked d)")])
    state = facts("lit a, locked d")
    for task in (closed, opened):
        assert BackToBefore(task).results(Atom.parse("(lit a)"), state, [], task)


@settings(max_examples=200, deadline=None)
@given(
    st.data(),
    tasks()
    | tasks(derived=True)
    | tasks(derived=True, goal="(seen)")
    | tasks(derived=True, goal="(and (here a) (or (full) (seen) (not (locked))))"),
)
def test_no_plan_leads_on_from_a_dead_end(data: st.DataObject, task: Task) -> None:
    possible = sorted(each for each in task.reachable_atoms if each.predicate in task.fluents)
    state = frozenset(data.draw(st.sets(st.sampled_from(possible)))) if possible else task.init
    before = data.draw(st.sampled_from(sorted(every_state(task), key=sorted)))
    dead = DeadEnds(task).holds(state)
    assert DeadEnds(task).holds(before) or DeadEnds(task).holds(state, before) == dead
    if dead:
        assert not any(task.goal_holds(each) for each in every_state(task, state))


def test_a_state_that_is_none_makes_it_quicker_and_says_nothing_else() -> None:
    """Of all pairs of states of the airport."""
    states = [
        facts(f"tug-at t {tug}, cart-at c {cart}, {rest}")
        for tug in ("apron", "hall", "gate")
        for cart in ("apron", "hall", "gate")
        for rest in ("hitched c t", "unhitched c, no-cart t", "hitched c t, no-cart t")
    ]
    plain = {state: DeadEnds(airport()).holds(state) for state in states}
    assert {*plain.values()} == {True, False}
    for alive in (state for state in states if not plain[state]):
        ends = DeadEnds(airport())
        assert {state: ends.holds(state, alive=alive) for state in states} == plain


def test_most_dead_ends_of_small_tasks_are_found() -> None:
    """Of all states of the airport, with the cart hitched or not, wherever it is."""
    task, known = airport(), DeadEnds(airport())
    for tug in ("apron", "hall", "gate"):
        for cart in ("apron", "hall", "gate"):
            for rest in ("hitched c t", "unhitched c, no-cart t"):
                state = facts(f"tug-at t {tug}, cart-at c {cart}, {rest}")
                leads = any(task.goal_holds(each) for each in every_state(task, state))
                assert known.holds(state) != leads
