"""The file of priors: read, and told where it is wrong."""

from pathlib import Path

import pytest

from tests.ward import ward
from tpvqa.belief.filtering.priors import Priors, load_priors
from tpvqa.belief.filtering.remarks_on_priors import remarks
from tpvqa.errors import PriorsError
from tpvqa.pddl import Atom, Task
from tpvqa.pddl.loading import task_from_text

NIGHT = ward()


def test_what_a_file_says(tmp_path: Path) -> None:
    path = tmp_path / "priors.yaml"
    path.write_text("elsewhere: 0.02\nnothing_known: false\n(in ?t - tool hall): 0.1\n")
    priors = load_priors(NIGHT, path)
    assert (priors.elsewhere, priors.nothing_known, priors.opens) == (0.02, False, True)
    hall = Atom.parse("(in lamp hall)")
    assert priors.stated({hall, Atom.parse("(in lamp store)")}, NIGHT) == {hall: 0.1}


def test_without_a_file_the_problem_is_believed() -> None:
    assert load_priors(NIGHT, None) == Priors()
    assert not Priors().opens
    assert load_priors(NIGHT, None, "unknown") == Priors(nothing_known=True)


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("elsewhere: 1", 1, "expected less than 1"),
        ("elsewhere: often", 1, "expected a number from 0 to 1, found 'often'"),
        ("\n(in ?t hall): 1.5", 2, "expected a number from 0 to 1, found '1.5'"),
        ("(in ?t hall): nan", 1, "expected a number from 0 to 1"),
        ("(in ?t hal): 0.5", 1, "this problem has no object 'hal'. Did you mean 'hall'?"),
        ("(lies anna hall): 0.5", 1, "no action changes 'lies'"),
        ("in: 0.5", 1, "'in' is not known here. Known: elsewhere, nothing_known, and facts"),
        (
            "elsewere: 0.1",
            1,
            "'elsewere' is not known here. Did you mean 'elsewhere'? Known: elsewh",
        ),
        ("nothing_known: maybe", 1, "expected true or false"),
        ("- 3", 1, "expected 'name: value' entries"),
        ("(in lamp hall): .2\n(in  lamp hall): .2", 2, "(in lamp hall) is given twice"),
        ("(in ?a hall): .2\n\n(in ?b hall): .2", 3, "(in ?b hall) is given twice"),
        (
            "(in lamp store): 0.6\n(in ?t hall): 0.6",
            2,
            "at most one of (in lamp store) 0.6, (in lamp hall) 0.6 holds, and together that is "
            "1.2; make them add up to 1 at most",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_line(
    tmp_path: Path, text: str, line: int, says: str
) -> None:
    path = tmp_path / "priors.yaml"
    path.write_text(text)
    with pytest.raises(PriorsError) as caught:
        load_priors(NIGHT, path)
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert says in str(caught.value)


CERTAIN = ward("(in lamp hall) (in pump store) (needs anna lamp)")


@pytest.mark.parametrize(
    ("task", "text", "line", "says"),
    [
        (CERTAIN, "(in lamp hall): 1", 1, "the problem says so for certain"),
        (CERTAIN, "(in lamp store): 0", 1, "the problem says so for certain"),
        (CERTAIN, "(in lamp hall): 0.4", 1, "it holds for certain"),
        (CERTAIN, "\n(held ?t): 0.1", 2, "it does not hold for certain"),
        (NIGHT, "(at hall): 0.2", 1, "it holds for certain"),
        (NIGHT, "(in ?t hall): .3\n(in pump hall): .5\n(in lamp hall): .5", 1, "what follows"),
        (NIGHT, "(in pump ?r): 0.5", 1, "what else is said of them that makes 1.5"),
        (NIGHT, "(in pump ?r): 0.2\n(in pump hall): 0.8", 1, "that makes 1.2"),
        (NIGHT, "", None, "the file says nothing"),
        (NIGHT, "# nothing yet", None, "the file says nothing"),
    ],
)
def test_what_has_not_the_effect_that_it_says_is_found(
    tmp_path: Path, task: Task, text: str, line: int | None, says: str
) -> None:
    path = tmp_path / "priors.yaml"
    path.write_text(text)
    (found,) = remarks(task, load_priors(task, path))
    assert found.line == line
    assert says in found.says


@pytest.mark.parametrize(
    ("task", "text"),
    [
        (CERTAIN, "(in lamp store): 0.3"),
        (CERTAIN, "(in lamp hall): .5\n(in lamp store): .4\n(in lamp theatre): 0"),
        (NIGHT, "(in lamp hall): 0.4"),
        (NIGHT, "(in lamp hall): 1"),
        (NIGHT, "(in lamp store): 0"),
        (NIGHT, "(in pump ?r): 0.2\n(in pump hall): 0.6"),
        (NIGHT, "(treated anna): 0.3"),
        (NIGHT, "elsewhere: 0.1"),
        (NIGHT, "nothing_known: true\n(in lamp hall): 1"),
    ],
)
def test_what_has_its_effect_is_not(tmp_path: Path, task: Task, text: str) -> None:
    path = tmp_path / "priors.yaml"
    path.write_text(text)
    assert list(remarks(task, load_priors(task, path))) == []


LENS = """(define (domain lens) (:requirements :typing) (:types camera)
  (:predicates (capped ?c - camera) (used ?c - camera))
  (:action uncap :parameters (?c - camera) :precondition (capped ?c) :effect (not (capped ?c)))
  (:action use :parameters (?c - camera) :effect (used ?c)))"""


@pytest.mark.parametrize(
    ("text", "open_too", "says"),
    [
        ("(capped left): 0.6", "", "(capped left): 0.6 has no effect: the problem does not say"),
        ("(capped ?c): 0.3", "", "has no effect on (capped left): the problem does not say so"),
        ("(capped left): 0.6", "(unknown (capped left))", None),
        ("(capped ?c): 0.3", "(unknown (capped left))", None),
        ("(used ?c): 0.3", "", None),
    ],
)
def test_what_only_the_problem_can_say_is_to_be_left_open_in_it(
    tmp_path: Path, text: str, open_too: str, says: str | None
) -> None:
    """As no action brings it about: what it says nothing of does not hold."""
    task = task_from_text(
        LENS,
        "(define (problem p) (:domain lens) (:objects left right - camera)"
        f"(:init (capped right) {open_too}) (:goal (used left)))",
    )
    path = tmp_path / "priors.yaml"
    path.write_text(text)
    found = list(remarks(task, load_priors(task, path)))
    if says is None:
        assert found == []
        return
    (remark,) = found
    assert says in remark.says
    assert "(unknown (capped left))" in remark.remedy
