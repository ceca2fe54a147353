"""Between which values numbers can lie."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.pddl.test_numbers import EXPRESSIONS, VALUES
from tpvqa.pddl import Atom, Conjunction
from tpvqa.pddl.arithmetic import COMPARISONS, Expression, compared, evaluated
from tpvqa.pddl.ground import Change
from tpvqa.planning.ranges import Ranges

HUGE = "1" + "0" * 400
"""Greater than a float can be."""


@given(st.sampled_from(sorted(COMPARISONS)), EXPRESSIONS, EXPRESSIONS, VALUES)
def test_what_holds_is_allowed_and_of_settled_numbers_nothing_else(
    comparison: str,
    left: Expression,
    right: Expression,
    values: dict[tuple[str, ...], Fraction],
) -> None:
    sides = evaluated(left, values), evaluated(right, values)
    if None in sides:  # divided by nothing
        return
    found = compared(comparison, left, right)
    if not isinstance(found, bool):
        holds = COMPARISONS[comparison](*sides)  # type: ignore[arg-type]
        assert Ranges(values).allows(Atom(*found)) == holds


@pytest.mark.parametrize("operator", ["+", "-", "*", "/"])
def test_a_number_without_bound_goes_with_one_too_great_for_a_float(operator: str) -> None:
    ranges = Ranges({("load",): Fraction(1)})
    ranges.widen([Change(Conjunction(), "increase", ("load",), "1")])
    assert ranges.allows(Atom(">=", (f"({operator} (load) {HUGE})", "(- 0 2)")))
    assert ranges.allows(Atom("<=", (f"({operator} {HUGE} (load))", HUGE))) == (operator != "+")
