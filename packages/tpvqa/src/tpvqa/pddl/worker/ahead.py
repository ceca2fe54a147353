"""A SAS+ task that a search reads before its initial state is known.

Reading is most of a replan of a large task. So the next search is given the task as soon as the
last one has ended, with one more variable that says whether it has begun. Its last operator begins
it: it sets every variable to the state at hand, and is all that is left to be read then.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

AHEAD = 200_000
"""Bytes of a task from which on this is done."""

BEGIN = "@begin"
"""The name of the operator that begins; it stands first in every plan."""

_OPERATOR = re.compile(rb"begin_operator\n(.*)\n(\d+)\n")
_GOAL = re.compile(rb"begin_goal\n(\d+)\n")


@dataclass(frozen=True, eq=False)
class Ahead:
    """A task in two parts.

    Attributes:
        first: What can be read at any time.
        last: What is read after the operator that begins: the axioms.
        derived: Variables that no operator may set.
    """

    first: bytes
    last: bytes
    derived: frozenset[int]

    def rest(self, values: Sequence[int]) -> bytes:
        """What is left to be read once the value of each variable is known."""
        own = len(values)
        effects = [f"0 {n} -1 {value}" for n, value in enumerate(values) if n not in self.derived]
        effects.append(f"0 {own} 0 1")
        lines = ["begin_operator", BEGIN, "0", str(len(effects)), *effects, "0", "end_operator", ""]
        return "\n".join(lines).encode() + self.last


def ahead_of(before: bytes, after: bytes, defaults: Sequence[int]) -> Ahead:
    """The parts of a task.

    Args:
        before: Its text up to the values of the initial state.
        after: Its text after them.
        defaults: A value for each variable.
    """
    own = len(defaults)
    layers = [int(each) for each in re.findall(rb"begin_variable\n.*\n(-?\d+)\n", before)]
    end = before.rindex(b"end_variable\n") + len(b"end_variable\n")
    head = before[:end].replace(
        f"\n{own}\nbegin_variable".encode(), f"\n{own + 1}\nbegin_variable".encode(), 1
    )
    variable = f"begin_variable\nvar{own}\n-1\n2\nAtom not-begun()\nAtom begun()\nend_variable\n"
    state = "\n".join(map(str, [*defaults, 0])) + "\n"
    cut = after.rindex(b"end_operator\n") + len(b"end_operator\n")
    operators, axioms = after[:cut], after[cut:]
    begun = f"{own} 1\n".encode()
    operators = _GOAL.sub(
        lambda found: b"begin_goal\n%d\n" % (int(found[1]) + 1) + begun, operators, count=1
    )
    goal, _, actions = operators.partition(b"end_goal\n")
    count, _, actions = actions.partition(b"\n")
    actions = _OPERATOR.sub(
        lambda found: b"begin_operator\n%b\n%d\n%b" % (found[1], int(found[2]) + 1, begun), actions
    )
    first = head + variable.encode() + before[end:] + state.encode() + goal
    first += b"end_goal\n%d\n" % (int(count) + 1) + actions
    derived = frozenset(number for number, layer in enumerate(layers) if layer >= 0)
    return Ahead(first, axioms, derived)
