"""What a disturbance leads to where no world file says it."""

from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa.belief.states.mutexes import h2_mutexes
from tpvqa.belief.states.undoing import BackToBefore
from tpvqa.pddl import Atom, State, Task, load_task

EXAMPLES = Path(__file__).parents[2] / "examples"


@cache
def example(name: str) -> Task:
    return load_task(EXAMPLES / name / "domain.pddl", EXAMPLES / name / "problem.pddl")


def set_in(task: Task, mounted: str) -> State:
    """A screw sits in the lid; another tool is mounted, or the gripper still is."""
    gone = {"(lies screw_one parts_tray)", "(flange_free)", f"(racked {mounted})"}
    come = {"(set_in screw_one lid)", f"(mounted {mounted})"}
    return task.init - set(map(Atom.parse, gone)) | set(map(Atom.parse, come))


@pytest.mark.parametrize(("mounted", "loose"), [("gripper", True), ("screwdriver", False)])
def test_what_works_loose_is_where_it_can_be(mounted: str, loose: bool) -> None:
    """Where the gripper is put away, a screw in its jaws would keep every tool where it is."""
    workshop = example("workshop")
    history = [Atom.parse("(lies screw_one parts_tray)"), Atom.parse("(held screw_one)")]
    state, screw = set_in(workshop, mounted), Atom.parse("(set_in screw_one lid)")
    after = [after for _, after in BackToBefore(workshop).results(screw, state, history, workshop)]
    held, free = Atom.parse("(held screw_one)"), Atom.parse("(jaws_free)")
    assert after == ([state - {screw, free} | {held}] if loose else [])


@pytest.mark.parametrize("name", ["workshop", "hospital", "store"])
@given(data=st.data())
@settings(max_examples=30, deadline=None)
def test_nothing_leads_to_what_no_action_leads_to(name: str, data: st.DataObject) -> None:
    """Actions and disturbances in turn: no two facts ever hold that h² keeps apart."""
    task = example(name)
    back, apart = BackToBefore(task), h2_mutexes(task).pairs
    state, history = task.init, list[Atom]()
    for _ in range(12):
        able = sorted((a for a in task.ground_actions() if task.applicable(state, a)), key=str)
        after = task.apply(state, data.draw(st.sampled_from(able))) if able else state
        history += sorted(state - after)
        state = after
        fluents = sorted(atom for atom in state if atom.predicate in task.fluents)
        for _, after in back.results(data.draw(st.sampled_from(fluents)), state, history, task):
            history += sorted(state - after)
            state = after
        assert not any(pair <= state for pair in apart)
