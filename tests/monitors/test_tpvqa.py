"""The paper's monitor at its seam: requests out, answers in, verdict out."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.doubles import knowing, perform, replies, worded
from tests.monitors.conftest import agree
from tpvqa.errors import PluginError
from tpvqa.monitors import Decision, Step
from tpvqa.monitors.majority import Majority
from tpvqa.monitors.memory import FactMemory
from tpvqa.monitors.tpvqa import TPVQA
from tpvqa.pddl import Atom, Literal, State, Task, load_task
from tpvqa.planning import Plan, Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering
from tpvqa.questions import QuestionBook
from tpvqa.tasks import find_task
from tpvqa.vlm import Answer, Reply

IN_HAND = "Is the plate in a robot's hand?"
SINK = "Is there a sink in the image?"
CLEAN = "Is the plate clean?"


def test_all_preconditions_are_asked_and_a_yes_to_each_goes_on(at: Callable[..., Step]) -> None:
    verdict, looks, asked = perform(TPVQA().before(at(3)), agree)
    assert asked == [IN_HAND, SINK]
    assert (verdict.decision, looks) == (Decision.GO_ON, 1)


def test_the_papers_example_one_of_two_denied_replans_with_the_plate_on_the_table(
    at: Callable[..., Step],
) -> None:
    monitor = TPVQA()
    step = at(3, monitor)
    verdict, _, _ = perform(monitor.before(step), replies({SINK: Reply.YES}, Reply.NO))
    assert verdict.decision is Decision.REPLAN
    assert verdict.state is not None
    assert step.state - verdict.state == {Atom("in_hand", ("plate", "left"))}
    assert verdict.state - step.state == {
        Atom("on", ("plate", "table")),
        Atom("free", ("left",)),
    }


def test_a_strict_majority_goes_on_at_a_tie(at: Callable[..., Step]) -> None:
    monitor = TPVQA(majority="strict")
    verdict, _, _ = perform(monitor.before(at(3, monitor)), replies({SINK: Reply.YES}, Reply.NO))
    assert verdict.decision is Decision.GO_ON


@pytest.fixture(scope="module")
def yard() -> Task:
    """A crane can lift a crate, which takes a while."""
    folder = Path(__file__).parents[2] / "examples/timed/yard"
    return load_task(folder / "domain.pddl", folder / "problem.pddl")


def cancelling(yard: Task, *, reported: bool = False) -> Step:
    """Cancelling what carries a crate, after it began."""
    state = yard.apply(yard.init, yard.action("start-carry", ("c1", "a", "s1", "t1")))
    cancel = yard.action("cancel-carry", ("c1", "a", "s1", "t1"))
    plan = Plan((cancel,), 1, "by hand", 0.0)
    return Step(yard, QuestionBook.load(None, yard), plan, 0, state, reported=reported)


@pytest.mark.parametrize(
    ("truth", "where"),
    [
        (["(idle c1)", "(on a t2)", "(empty t1)", "(empty s1)"], "(on a t2)"),
        (["(lifted a c1)", "(empty s1)"], "(lifted a c1)"),
    ],
    ids=["it fell elsewhere", "it still hangs there"],
)
def test_what_was_cancelled_runs_no_longer_and_is_looked_for(
    yard: Task, truth: list[str], where: str
) -> None:
    verdict, _, _ = perform(TPVQA().after(cancelling(yard)), knowing(*truth))
    assert verdict.decision is Decision.REPLAN
    assert verdict.state is not None
    assert not any(atom.predicate.startswith("running") for atom in verdict.state)
    held = {atom.pddl() for atom in verdict.state if atom.predicate in ("on", "lifted")}
    assert {fact for fact in held if " a" in fact} == {where}


def test_what_was_cancelled_as_expected_goes_on(yard: Task) -> None:
    verdict, _, _ = perform(TPVQA().after(cancelling(yard)), agree)
    assert verdict.decision is Decision.GO_ON
    assert verdict.state == yard.init


def test_what_could_not_be_stopped_is_cancelled_again(yard: Task) -> None:
    step = cancelling(yard, reported=True)
    verdict, _, _ = perform(TPVQA().after(step), replies({}, Reply.NO))
    assert verdict.decision is Decision.REPEAT


@pytest.mark.parametrize(
    ("spec", "name", "looks", "decision"),
    [
        ("", "tpvqa", 1, Decision.REPLAN),
        ("tie", "tpvqa", 1, Decision.REPLAN),
        ("strict", "tpvqa:strict", 1, Decision.GO_ON),
        ("3", "tpvqa:3", 6, Decision.REPLAN),  # where else the plate is, by vote too
        ("3:strict", "tpvqa:3:strict", 3, Decision.GO_ON),
    ],
)
def test_a_specification_says_how_many_looks_and_which_majority(
    spec: str, name: str, looks: int, decision: Decision, at: Callable[..., Step]
) -> None:
    monitor = TPVQA.from_spec(spec)
    assert monitor.name == name
    tie = replies({SINK: Reply.YES}, Reply.NO)
    verdict, looked, _ = perform(monitor.before(at(3, monitor)), tie)
    assert (verdict.decision, looked) == (decision, looks)


@pytest.mark.parametrize("spec", ["x", "3:x", "strict:3", "-1", "3.5", "9" * 5000])
def test_a_specification_that_is_not_understood(spec: str) -> None:
    with pytest.raises(PluginError, match=f"'tpvqa:{spec}' is not understood"):
        TPVQA.from_spec(spec)


def test_the_majority_of_a_specification_counts_before_the_option() -> None:
    assert TPVQA.from_spec("5", majority="strict").name == "tpvqa:5:strict"
    assert TPVQA.from_spec("5:tie", majority="strict").name == "tpvqa:5"
    assert TPVQA.from_spec("strict", no_alternatives=True).name == "tpvqa:strict:no-alternatives"


def test_where_else_a_thing_is_seen_is_believed(at: Callable[..., Step]) -> None:
    monitor = TPVQA()
    seen = knowing("(near sink)", "(on plate floor)")
    verdict, _, asked = perform(monitor.before(at(3, monitor)), seen)
    assert "Is the plate on the floor?" in asked
    assert verdict.state is not None
    assert Atom("on", ("plate", "floor")) in verdict.state


def test_two_affirmed_alternatives_decide_nothing(at: Callable[..., Step]) -> None:
    monitor = TPVQA()
    seen = knowing("(near sink)", "(on plate floor)", "(on plate counter)")
    verdict, _, _ = perform(monitor.before(at(3, monitor)), seen)
    assert verdict.state is not None
    assert Atom("on", ("plate", "table")) in verdict.state


def test_what_was_denied_is_not_fallen_back_to(at: Callable[..., Step]) -> None:
    monitor = TPVQA()
    verdict, _, _ = perform(monitor.before(at(3, monitor)), knowing("(near sink)"))
    assert verdict.state is not None
    assert Atom("on", ("plate", "table")) in verdict.state
    step = at(1)
    back = Step(step.task, step.book, step.plan, 1, verdict.state | {Atom("near", ("plate",))})
    verdict, looks, _ = perform(monitor.before(back), knowing("(near plate)"))
    assert (verdict.decision, verdict.state, looks) == (Decision.GO_ON, None, 2)


def test_an_alternative_that_was_denied_is_the_last_to_be_believed(at: Callable[..., Step]) -> None:
    task = at(0).task
    table, floor, hand = (
        Atom("on", ("plate", "table")),
        Atom("on", ("plate", "floor")),
        Atom("in_hand", ("plate", "left")),
    )
    free = Atom("free", ("left",))
    held = task.init - {table, free} | {hand}
    memory = FactMemory(task)
    memory.record(task.init, held)
    memory.record(held, task.init - {table} | {floor})
    memory.record(task.init - {table} | {floor}, held)
    denied = [Literal(hand)]
    assert floor in memory.take_out(held, denied)
    assert table in memory.take_out(held, denied, unseen=[floor])
    assert floor in memory.take_out(held, denied, unseen=[floor, table])


def test_what_was_seen_instead_has_before_it_what_it_took_the_place_of(
    at: Callable[..., Step],
) -> None:
    task = at(0).task
    table, hand = Atom("on", ("plate", "table")), Atom("in_hand", ("plate", "left"))
    memory = FactMemory(task)
    held = memory.take_out(task.init, [Literal(table)], seen=[hand])
    assert hand in held
    memory.correct(task.init, held, [Literal(table)])
    denied = memory.take_out(held, [Literal(hand)])
    assert denied == task.init


def test_a_fact_is_fallen_back_to_with_its_hand_however_often_answers_change(
    at: Callable[..., Step],
) -> None:
    task = at(0).task
    table, hand, floor = (
        Atom("on", ("plate", "table")),
        Atom("in_hand", ("plate", "left")),
        Atom("on", ("plate", "floor")),
    )
    memory = FactMemory(task)
    held = task.init - {table, Atom("free", ("left",))} | {hand}
    memory.record(task.init, held)
    on_floor = memory.take_out(held, [Literal(hand)], seen=[floor])
    memory.correct(held, on_floor, [Literal(hand)])
    back = memory.take_out(on_floor, [Literal(floor)])
    memory.correct(on_floor, back, [Literal(floor)])
    assert back == held
    assert memory.take_out(back, [Literal(hand)]) == task.init


def test_what_follows_from_a_correction_is_not_taken_for_denied(tmp_path: Path) -> None:
    (tmp_path / "domain.pddl").write_text(CARRIED)
    (tmp_path / "problem.pddl").write_text(CARRIED_PROBLEM)
    task = load_task(tmp_path / "domain.pddl", tmp_path / "problem.pddl")
    memory = FactMemory(task)
    state = task.init
    for words in (
        "take a1 crate shelf",
        "put a1 crate shelf",
        "take a1 tin shelf",
        "put a1 tin shelf",
    ):
        name, *arguments = words.split()
        after = task.apply(state, task.action(name, arguments))
        memory.record(state, after)
        state = after
    denied = [Literal(Atom.parse("(lies crate shelf)"))]
    held = memory.take_out(state, denied)
    assert Atom.parse("(holding a1 crate)") in held
    memory.correct(state, held, denied)
    back = memory.take_out(held, [Literal(Atom.parse("(holding a1 crate)"))])
    assert Atom.parse("(empty a1)") in back  # and not that it holds the tin
    assert Atom.parse("(lies tin shelf)") in back


def test_elsewhere_is_every_place_of_the_thing_and_nothing_else(at: Callable[..., Step]) -> None:
    memory = FactMemory(at(0).task)
    plate = memory.alternatives(Atom("in_hand", ("plate", "left")))
    assert {str(atom) for atom in plate} == {
        "in_hand(plate, right)",
        "on(plate, counter)",
        "on(plate, floor)",
        "on(plate, sink)",
        "on(plate, table)",
    }


CARRIED = """
(define (domain depot) (:requirements :typing)
  (:types arm item place)
  (:predicates (holding ?a - arm ?i - item) (empty ?a - arm) (lies ?i - item ?p - place)
               (robot-at ?p - place))
  (:action go :parameters (?f ?t - place) :precondition (robot-at ?f)
    :effect (and (not (robot-at ?f)) (robot-at ?t)))
  (:action take :parameters (?a - arm ?i - item ?p - place)
    :precondition (and (empty ?a) (lies ?i ?p) (robot-at ?p))
    :effect (and (holding ?a ?i) (not (empty ?a)) (not (lies ?i ?p))))
  (:action put :parameters (?a - arm ?i - item ?p - place)
    :precondition (and (holding ?a ?i) (robot-at ?p))
    :effect (and (empty ?a) (not (holding ?a ?i)) (lies ?i ?p))))
"""
CARRIED_PROBLEM = """
(define (problem p) (:domain depot)
  (:objects a1 a2 - arm crate tin jar - item shelf dock - place)
  (:init (empty a1) (empty a2) (lies crate shelf) (lies tin shelf) (lies jar dock) (robot-at dock))
  (:goal (lies crate dock)))
"""


def test_elsewhere_follows_what_is_carried_not_what_carries_it(tmp_path: Path) -> None:
    (tmp_path / "domain.pddl").write_text(CARRIED)
    (tmp_path / "problem.pddl").write_text(CARRIED_PROBLEM)
    memory = FactMemory(load_task(tmp_path / "domain.pddl", tmp_path / "problem.pddl"))

    def elsewhere(text: str) -> set[str]:
        return {atom.pddl() for atom in memory.alternatives(Atom.parse(text))}

    assert elsewhere("(holding a1 crate)") == {
        "(holding a2 crate)",
        "(lies crate dock)",
        "(lies crate shelf)",
    }
    assert elsewhere("(robot-at dock)") == {"(robot-at shelf)"}


def test_nothing_lies_on_itself() -> None:
    task = load_task("build_tower")
    memory = FactMemory(task)
    green = next(name for name in task.objects)
    ends = [a for a in task.atoms() if a.predicate == "on" and a.arguments[0] == green]
    for atom in ends:
        assert all(len(set(a.arguments)) == len(a.arguments) for a in memory.alternatives(atom))


def test_where_a_seen_block_has_left_its_place_nothing_is_on_it() -> None:
    task = load_task("build_tower")
    clear, seen = Atom("clear", ("yellow",)), Atom("on", ("blue", "yellow"))
    found = FactMemory(task).take_out(task.init, [Literal(clear)], seen=[seen])
    left = {clear, Atom("on", ("blue", "c2"))}
    assert found == task.init - left | {seen, Atom("clear", ("c2",))}


def test_without_alternatives_nothing_is_asked_but_the_preconditions(
    at: Callable[..., Step],
) -> None:
    monitor = TPVQA.from_spec("no-alternatives")
    verdict, _, asked = perform(monitor.before(at(3, monitor)), knowing("(near sink)"))
    assert (verdict.decision, asked) == (Decision.REPLAN, [IN_HAND, SINK])


def test_a_second_look_that_nobody_answers_stops_safely(at: Callable[..., Step]) -> None:
    monitor = TPVQA(looks=2)
    step = at(1, monitor)
    first = knowing("(near plate)")
    silent = replies({}, Reply.UNKNOWN)
    verdict, looks, _ = perform(monitor.before(step), first, silent)
    assert (verdict.decision, looks) == (Decision.GIVE_UP, 4)


def test_an_initial_fact_is_looked_at_once_more_and_then_the_robot_acts(
    at: Callable[..., Step],
) -> None:
    monitor = TPVQA()
    step = at(1, monitor)
    verdict, looks, asked = perform(monitor.before(step), knowing("(near plate)"))
    assert asked.count("Is the plate on the table?") == 2
    assert (verdict.decision, looks) == (Decision.GO_ON, 2)
    assert verdict.state is None


def test_all_effects_are_asked_negative_ones_too_and_denied_ones_repeat(
    at: Callable[..., Step],
) -> None:
    verdict, _, asked = perform(TPVQA().after(at(1)), knowing("(on plate table)"))
    assert asked == [IN_HAND, "Is the plate on the table?"]
    assert verdict.decision is Decision.REPEAT
    verdict, _, _ = perform(TPVQA().after(at(1)), knowing("(in_hand plate left)"))
    assert verdict.decision is Decision.GO_ON


@pytest.mark.parametrize("reply", [Reply.UNKNOWN, Reply.CANNOT_SEE])
def test_where_all_abstain_it_looks_again_and_then_stops_safely(
    at: Callable[..., Step], reply: Reply
) -> None:
    for check in (TPVQA(looks=2).before(at(3)), TPVQA(looks=2).after(at(3))):
        verdict, looks, _ = perform(check, replies({}, reply))
        assert (verdict.decision, looks) == (Decision.GIVE_UP, 3)


def test_an_answer_after_looking_again_counts(at: Callable[..., Step]) -> None:
    verdict, looks, _ = perform(TPVQA().after(at(3)), replies({}, Reply.UNKNOWN), agree)
    assert (verdict.decision, looks) == (Decision.GO_ON, 2)


def test_abstentions_do_not_count_as_votes(at: Callable[..., Step]) -> None:
    verdict, _, _ = perform(
        TPVQA().before(at(3)), replies({SINK: Reply.CANNOT_SEE, IN_HAND: Reply.YES})
    )
    assert verdict.decision is Decision.GO_ON


@given(st.lists(st.sampled_from(list(Reply)), max_size=9))
def test_the_majority_rule(given_replies: list[Reply]) -> None:
    question = worded("Is it so?")
    answers = [Answer(question, reply) for reply in given_replies]
    no, yes = given_replies.count(Reply.NO), given_replies.count(Reply.YES)
    if no + yes == 0:
        assert Majority.TIE_DENIES.denies(answers) is None
        assert Majority.STRICT.denies(answers) is None
        assert Majority.ANY.denies(answers) is None
    else:
        assert Majority.TIE_DENIES.denies(answers) is (no >= yes)
        assert Majority.STRICT.denies(answers) is (no > yes)
        assert Majority.ANY.denies(answers) is (no > 0)


@pytest.fixture(scope="module")
def apple() -> Iterator[tuple[Task, QuestionBook, Planner]]:
    task = load_task("eat_apple")
    planner = Remembering(FastDownward())
    yield task, QuestionBook.load(find_task("eat_apple").questions, task), planner
    planner.close()


@settings(deadline=None)
@given(data=st.data())
def test_no_object_is_ever_nowhere(
    apple: tuple[Task, QuestionBook, Planner], data: st.DataObject
) -> None:
    """Whatever is answered, each exactly-one group keeps exactly one true member."""
    task, book, planner = apple
    monitor, state = TPVQA(), task.init
    actions = [
        task.action("find", ("fridge", "tv")),
        task.action("open", ("fridge",)),
        task.action("find", ("apple", "fridge")),
        task.action("pick_up", ("apple", "fridge", "left")),
        task.action("find", ("knife", "apple")),
        task.action("pick_up", ("knife", "counter", "right")),
        task.action("cut_in_half", ("apple", "knife", "left", "right")),
    ]
    plan = Plan(tuple(actions), 7, "by hand", 0.0)
    draw = st.sampled_from([Reply.YES, Reply.NO, Reply.UNKNOWN])
    index = 0
    for _ in range(15):
        if index >= len(plan.actions):
            return
        step = Step(task, book, plan, index, state)
        verdict, _, _ = perform(monitor.before(step), lambda question: data.draw(draw))
        if verdict.decision is Decision.GO_ON:
            verdict, _, _ = perform(monitor.after(step), lambda question: data.draw(draw))
            index += verdict.decision is Decision.GO_ON
        state = _one_each(task, state if verdict.state is None else verdict.state)
        if verdict.decision is Decision.GIVE_UP:
            return
        if verdict.decision is Decision.REPLAN:
            replanned = planner.plan(task, state)
            if not isinstance(replanned, Plan):
                return
            plan, index = replanned, 0


def _one_each(task: Task, state: State) -> State:
    for group in task.mutex_groups:
        held = len(state & group.atoms)
        assert held == 1 if group.exactly_one else held <= 1
    return state
