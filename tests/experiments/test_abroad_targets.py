"""Whether what must be reached abroad is, concluded from made-up episodes."""

from collections.abc import Callable

import pytest

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa_experiments.abroad import Part
from tpvqa_experiments.abroad.parts import REPEATING, SEEING
from tpvqa_experiments.abroad.targets import targets

Made = Callable[[int], dict[str, object]]


def cell(task: str, monitor: str = "belief", condition: str = "limits=none") -> Cell:
    return Cell(task, monitor, "oracle:0.8", "symbolic", condition)


def rows(of: Cell, count: int, made: Made) -> list[EpisodeRow]:
    fields = {"task": of.task, "monitor": of.monitor, "vlm": of.vlm, "world": of.world}
    return [
        EpisodeRow.model_validate(
            {**fields, "condition": of.condition, "seed": 0, "episode": n, "because": "", **made(n)}
        )
        for n in range(count)
    ]


def reached(part: Part, made: dict[Cell, list[EpisodeRow]]) -> dict[str, bool | None]:
    return {check.what: check.reached for check in targets({part: made})}


@pytest.mark.parametrize(("done", "asked", "told"), [(97, 8, True), (90, 9, False)])
def test_others_domains_count_together_and_questions_by_domain(
    done: int, asked: int, told: bool
) -> None:
    made = {
        cell(task): rows(
            cell(task),
            100,
            lambda n: {"completed": n < done, "actions": 10, "questions": 10 * asked},
        )
        for task in ("one", "two", "three")
    }
    found = reached(Part.OTHERS, made)
    assert found["completion"] is told
    assert found["questions an action, median of the domains"] is told
    assert found["questions an action, worst domain"] is True


@pytest.mark.parametrize(("actions", "told"), [(18, True), (19, False)])
def test_actions_are_compared_with_who_sees_all_where_both_completed(
    actions: int, told: bool
) -> None:
    own, limit = cell("ward"), cell("ward", SEEING)
    made = {
        # What only one of them completed is left out, however long it took.
        own: rows(own, 50, lambda n: {"completed": n > 0, "actions": actions if n else 900}),
        limit: rows(limit, 50, lambda n: {"completed": True, "actions": 10}),
    }
    assert reached(Part.OWN, made)["actions over those of who sees all"] is told
    assert reached(Part.OWN, {own: made[own]})["actions over those of who sees all"] is None


def test_the_least_by_repetition_is_the_fewest_that_complete_often_enough() -> None:
    own, limit = cell("ward"), cell("ward", SEEING)
    made = {own: 25, limit: 10, cell("ward", REPEATING[0]): 11, cell("ward", REPEATING[1]): 14}
    found = {
        of: rows(
            of,
            50,
            lambda n, of=of, actions=actions: {  # type: ignore[misc]
                "completed": n % 2 == 0 or of.monitor != REPEATING[0],
                "actions": actions,
            },
        )
        for of, actions in made.items()
    }
    (told,) = (check for check in targets({Part.OWN: found}) if "repetition" in check.what)
    assert told.measured is not None
    assert told.measured.value == pytest.approx(1.4)
    assert told.reached is None
    assert told.note.endswith("ward 2")


def test_a_dead_skill_counts_where_it_was_tried() -> None:
    of = cell("eat_apple", condition="limits=none,dead=open")
    soon = rows(of, 80, lambda n: {"dead": 9, "named": 8} if n < 40 else {"dead": 0})
    late = rows(of, 80, lambda n: {"dead": 20, "named": 9, "misnamed": int(n < 10)})
    assert set(reached(Part.DEAD, {of: soon}).values()) == {True}
    assert set(reached(Part.DEAD, {of: late}).values()) == {False}


def test_questions_are_compared_with_the_lead_that_completes_most() -> None:
    own, two, four = (cell("eat_apple", name) for name in ("belief", "lead:2", "lead:4"))
    made = {
        own: rows(own, 100, lambda n: {"completed": True, "questions": 50 + n % 2}),
        two: rows(two, 100, lambda n: {"completed": n < 80, "questions": 60}),
        four: rows(four, 100, lambda n: {"completed": n < 99, "questions": 110}),
    }
    found = reached(Part.SHIPPED, made)
    assert found["questions over lead:4's, eat_apple"] is True
    assert found["completion less lead:4's, eat_apple"] is True
    assert not any("lead:2" in what for what in found)
