"""The file of priors: read, and told where it is wrong."""

from pathlib import Path

import pytest

from tests.ward import ward
from tpvqa.belief.priors import Priors, load_priors
from tpvqa.errors import PriorsError
from tpvqa.pddl import Atom

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
        ("nothing_known: maybe", 1, "expected true or false"),
        ("- 3", 1, "expected 'name: value' entries"),
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
