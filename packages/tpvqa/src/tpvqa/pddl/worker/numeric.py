"""Numbers that actions change (PDDL 2.1, Fox and Long 2003), taken out before translating.

A comparison in a condition becomes a predicate without arguments that may hold or not whenever it
likes, so that everything it may allow is grounded; what actions do to numbers becomes an effect on
another one. What they stand for is told beside, and put back into the description.
"""

from collections.abc import Iterator, Sequence
from typing import Any

from tpvqa.pddl.arithmetic import ARITHMETIC, OPPOSITE, functions_in
from tpvqa.pddl.numeric import CHANGES
from tpvqa.pddl.worker.blocks import block_of, blocks, said, sections
from tpvqa.pddl.worker.functions import COST, Functions
from tpvqa.pddl.worker.lisp import Block, Word
from tpvqa.pddl.worker.reading_error import ReadingError

_REQUIREMENTS = (":fluents", ":numeric-fluents")
_PREFIX = "|number-"
"""No name of PDDL begins so."""


def taken_out(domain: Block, problem: Block, *, durative: bool) -> "Numbers | None":
    """Put predicates in the place of a domain's numbers.

    Args:
        domain: The domain; changed.
        problem: The problem; changed.
        durative: Whether the domain has actions that last.

    Returns:
        The numbers; None where no action changes any but the total cost.

    Raises:
        ReadingError: They cannot be read, or stand where they are not known.
    """
    for section in sections(domain, ":requirements"):
        section[:] = [word for word in section if word not in _REQUIREMENTS]
    functions = Functions(domain, problem)
    spoken = [block for block in blocks(domain) if _is_about_numbers(block, functions)]
    goals = [
        block
        for section in sections(problem, ":goal")
        for block in blocks(section)
        if _compares(block, functions)
    ]
    if not spoken and not goals:
        return None
    if durative:
        found = (spoken or goals)[0]
        part = "domain" if spoken else "problem"
        message = "is about numbers, which are not known together with actions that last"
        raise ReadingError(f"{said(found)} {message}; expected one of both", part, found.line)
    for section in sections(domain, ":derived"):
        for block in blocks(section):
            if _is_about_numbers(block, functions):
                raise ReadingError(
                    f"{said(block)} stands in (:derived …), where numbers are not known; write the "
                    "comparison into the actions that need it",
                    "domain",
                    block.line,
                )
    return Numbers(domain, problem, functions)


class Numbers:
    """The numbers of a task, while the translator reads the rest of it."""

    def __init__(self, domain: Block, problem: Block, functions: Functions):
        self._functions = functions
        self._conditions: dict[str, tuple[str, Any, Any]] = {}
        self._effects: dict[str, tuple[str, list[str], Any]] = {}
        self._part = "domain"
        place = next(
            (n for n, part in enumerate(domain) if isinstance(part, Block) and _is_action(part)),
            len(domain),
        )
        for section in sections(domain, ":action"):
            parts = dict(zip(map(str, section[2::2]), section[3::2], strict=False))
            known = functions.things | _variables(parts.get(":parameters"))
            for key in (":precondition", ":effect"):
                value = parts.get(key)
                if isinstance(value, Block):
                    self._rewrite(value, known)
        self._part = "problem"
        for section in sections(problem, ":goal"):
            self._rewrite(section, functions.things)
        self.values = functions.values(domain, problem)
        self._make_room(domain, place)

    def _wrong(self, message: str, line: int | None) -> ReadingError:
        return ReadingError(message, self._part, line)

    def _expression(self, item: object, known: set[str]) -> Any:
        return self._functions.expression(item, known, self._part)

    def _rewrite(self, block: Block, known: set[str]) -> None:
        """Replace what is about numbers within a block, itself included."""
        if _compares(block, self._functions):
            self._put(block, self._condition(str(block[0]), block, known))
            return
        if block and block[0] in CHANGES and _is_about_numbers(block, self._functions):
            self._put(block, self._effect(block, known))
            return
        if block[:1] in (["forall"], ["exists"]) and len(block) > 1:
            known = known | _variables(block[1])
        for part in block:
            if isinstance(part, Block):
                self._rewrite(part, known)

    def _put(self, block: Block, name: str) -> None:
        block[:] = [Word(name, block.line)]

    def _condition(self, operator: str, block: Block, known: set[str]) -> str:
        if len(block) != 3:
            raise self._wrong(f"{said(block)} compares no two numbers", block.line)
        name = f"{_PREFIX}{len(self._conditions)}"
        left, right = (self._expression(part, known) for part in block[1:])
        self._conditions[name] = operator, left, right
        return name

    def _effect(self, block: Block, known: set[str]) -> str:
        if len(block) != 3:
            raise self._wrong(
                f"{said(block)} is no change of a number; expected ({block[0]} (FUNCTION …) …)",
                block.line,
            )
        target = self._expression(block[1], known)
        if not isinstance(target, list) or target[0] in ARITHMETIC:
            raise self._wrong(
                f"{said(block[1])} is no function whose value could change", block.line
            )
        name = f"{_PREFIX}effect-{len(self._effects)}"
        self._effects[name] = str(block[0]), target, self._expression(block[2], known)
        return name

    def _make_room(self, domain: Block, place: int) -> None:
        """Declare what stands for numbers, with actions that bring about and end every condition.

        Without them the translator would take a condition for one that never changes.
        """
        line = domain.line
        names = [*self._conditions, *self._effects]
        declared = [block_of(line, name) for name in names]
        for section in sections(domain, ":predicates"):
            section += declared
            break
        else:
            domain.insert(place, block_of(line, ":predicates", *declared))
        for name in self._conditions:
            for on, effect in (
                ("on", block_of(line, name)),
                ("off", block_of(line, "not", block_of(line, name))),
            ):
                domain.append(
                    block_of(
                        line,
                        *(":action", f"{name}-{on}", ":parameters", block_of(line)),
                        *(":precondition", block_of(line, "and"), ":effect", effect),
                    )
                )

    def spoken_of(self, name: str) -> Iterator[Sequence[str]]:
        """The functions with their arguments that a predicate stands for which is made up."""
        _, *sides = self._conditions.get(name) or self._effects.get(name) or ("",)
        for side in sides:
            yield from functions_in(side)

    def is_made_up(self, name: str) -> bool:
        """Whether a predicate or an action only stands for numbers."""
        name = name.removesuffix("-on").removesuffix("-off")
        return name in self._conditions or name in self._effects

    def restored(self, description: dict[str, Any]) -> dict[str, Any]:
        """A task's description with its numbers in their places.

        Comparisons are `["compare", operator, left, right]`, and every action has "changes":
        `[[parameters, condition, kind, [function, argument, …], expression], …]`.
        """

        def condition(written: list[Any]) -> list[Any]:
            tag, *rest = written
            if tag == "literal":
                found = self._conditions.get(rest[1])
                return written if found is None else _compared(*found, holds=rest[0])
            if tag in ("and", "or"):
                return [tag, *map(condition, rest)]
            return [tag, rest[0], condition(rest[1])]

        actions = []
        for action in description["actions"]:
            if self.is_made_up(action["name"]):
                continue
            plain, changes = [], []
            for parameters, needs, literal in action["effects"]:
                change = self._effects.get(literal[2])
                if change is None:
                    plain.append([parameters, condition(needs), literal])
                else:
                    changes.append([parameters, condition(needs), *change])
            precondition = condition(action["precondition"])
            actions.append(
                {**action, "precondition": precondition, "effects": plain, "changes": changes}
            )
        made_up = self.is_made_up
        return {
            **description,
            "predicates": [each for each in description["predicates"] if not made_up(each[0])],
            "predicate_variables": {
                name: variables
                for name, variables in description["predicate_variables"].items()
                if not made_up(name)
            },
            "fluents": [name for name in description["fluents"] if not made_up(name)],
            "goal": condition(description["goal"]),
            "actions": actions,
            "numeric": {
                "functions": [
                    [name, args] for name, args in sorted(self._functions.arguments.items())
                ],
                "changed": sorted({words[0] for _, words, _ in self._effects.values()}),
                "values": self.values,
            },
        }


def _compared(operator: str, left: Any, right: Any, *, holds: bool) -> list[Any]:
    """A comparison, or its opposite."""
    if holds:
        return ["compare", operator, left, right]
    if operator == "=":
        return ["or", ["compare", "<", left, right], ["compare", ">", left, right]]
    return ["compare", OPPOSITE[operator], left, right]


def _is_about_numbers(block: Block, functions: Functions) -> bool:
    head = block[0] if block else None
    if head in CHANGES and len(block) > 1:
        return functions.is_number(block[1]) and block[1] != [COST]
    return _compares(block, functions)


def _compares(block: Block, functions: Functions) -> bool:
    """Whether it compares numbers; `=` is equality of objects, too, and gives values at first."""
    head = block[0] if block else None
    if head in OPPOSITE:
        return len(block) > 1 and any(map(functions.is_number, block[1:]))
    return head == "=" and len(block) == 3 and any(map(functions.is_number, block[1:]))


def _variables(parameters: object) -> set[str]:
    """The variables that a list of parameters declares."""
    words = parameters if isinstance(parameters, Block) else ()
    return {str(word) for word in words if isinstance(word, str) and word.startswith("?")}


def _is_action(part: Block) -> bool:
    return part[:1] == [":action"]
