"""Numbers that actions change (PDDL 2.1, Fox and Long 2003), taken out before translating.

A comparison in a condition becomes a predicate without arguments that may hold or not whenever it
likes, so that everything it may allow is grounded; what actions do to numbers becomes an effect on
another one. What they stand for is told beside, and put back into the description.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from tpvqa.errors import suggestion_or_list
from tpvqa.pddl.worker.durations import blocks, said, sections
from tpvqa.pddl.worker.lisp import Block, Word, line_of
from tpvqa.pddl.worker.reading_error import ReadingError

COMPARISONS: Mapping[str, str] = {">": "<=", "<": ">=", ">=": "<", "<=": ">"}
"""Comparisons with their opposites."""
CHANGES = ("increase", "decrease", "assign", "scale-up", "scale-down")
_ARITHMETIC = ("+", "-", "*", "/")
_REQUIREMENTS = (":fluents", ":numeric-fluents")
_PREFIX = "|number-"
"""No name of PDDL begins so."""
_COST = "total-cost"


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
    functions = dict(_declared(domain))
    spoken = [block for block in blocks(domain) if _is_about_numbers(block)]
    goals = [
        block
        for section in sections(problem, ":goal")
        for block in blocks(section)
        if _compares(block)
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
            if _is_about_numbers(block):
                raise ReadingError(
                    f"{said(block)} stands in (:derived …), where numbers are not known; write the "
                    "comparison into the actions that need it",
                    "domain",
                    block.line,
                )
    return Numbers(domain, problem, functions)


class Numbers:
    """The numbers of a task, while the translator reads the rest of it."""

    def __init__(self, domain: Block, problem: Block, functions: Mapping[str, list[list[str]]]):
        self._functions = functions
        odd = next((name for name in functions if name in (*_ARITHMETIC, *COMPARISONS)), None)
        if odd is not None:
            raise ReadingError(
                f"a function is called {odd!r}, which means something else in expressions; take "
                "another name",
                "domain",
                next(sections(domain, ":functions")).line,
            )
        self._conditions: dict[str, tuple[str, Any, Any]] = {}
        self._effects: dict[str, tuple[str, list[str], Any]] = {}
        self._part = "domain"
        place = next(
            (n for n, part in enumerate(domain) if isinstance(part, Block) and _is_action(part)),
            len(domain),
        )
        self._things = {
            str(word)
            for definition, name in ((domain, ":constants"), (problem, ":objects"))
            for section in sections(definition, name)
            for word in section[1:]
            if isinstance(word, str)
        }
        for section in sections(domain, ":action"):
            parts = dict(zip(map(str, section[2::2]), section[3::2], strict=False))
            known = self._things | _variables(parts.get(":parameters"))
            for key in (":precondition", ":effect"):
                value = parts.get(key)
                if isinstance(value, Block):
                    self._rewrite(value, known)
        self._part = "problem"
        for section in sections(problem, ":goal"):
            self._rewrite(section, self._things)
        changed = {words[0] for _, words, _ in self._effects.values()}
        self._values = self._valued(domain, problem)
        self._changed = sorted(changed)
        self._make_room(domain, place)

    def _wrong(self, message: str, line: int | None) -> ReadingError:
        return ReadingError(message, self._part, line)

    def _rewrite(self, block: Block, known: set[str]) -> None:
        """Replace what is about numbers within a block, itself included."""
        if _compares(block):
            self._put(block, self._condition(str(block[0]), block, known))
            return
        if block and block[0] in CHANGES and _is_about_numbers(block):
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
        if not isinstance(target, list) or target[0] in _ARITHMETIC:
            raise self._wrong(
                f"{said(block[1])} is no function whose value could change", block.line
            )
        name = f"{_PREFIX}effect-{len(self._effects)}"
        self._effects[name] = str(block[0]), target, self._expression(block[2], known)
        return name

    def _expression(self, item: object, known: set[str]) -> Any:
        """A number as it is written, `[function, argument, …]`, or `[operator, …, …]`."""
        if isinstance(item, str):
            if _is_number(item):
                return str(item)
            item = _block(line_of(item), item)
        head = item[0] if isinstance(item, Block) and item else None
        if not isinstance(item, Block) or not isinstance(head, str):
            raise self._wrong(f"{said(item)} is no number", line_of(item))
        if head in _ARITHMETIC:
            parts = [self._expression(part, known) for part in item[1:]]
            if head == "-" and len(parts) == 1:
                return ["-", "0", parts[0]]
            if len(parts) < 2 or (head in "-/" and len(parts) > 2):
                raise self._wrong(f"{said(item)} wants two numbers", item.line)
            while len(parts) > 2:
                pairs = [parts[n : n + 2] for n in range(0, len(parts), 2)]  # deep by log2 alone
                parts = [[str(head), *two] if len(two) == 2 else two[0] for two in pairs]
            return [str(head), *parts]
        wanted = self._functions.get(str(head))
        if wanted is None:
            raise self._wrong(
                f"{said(item)} speaks of the function {str(head)!r}, which (:functions …) does not "
                "declare" + suggestion_or_list(str(head), self._functions),
                line_of(head),
            )
        if str(head) == _COST:
            raise self._wrong(
                f"{said(item)}: total-cost is for (:metric minimize (total-cost)) alone; take a "
                "function of your own for what actions need",
                item.line,
            )
        arguments = item[1:]
        if len(arguments) != len(wanted) or not all(isinstance(each, str) for each in arguments):
            raise self._wrong(
                f"{said(item)}: {head} takes {len(wanted)} arguments, got {len(arguments)}",
                item.line,
            )
        return self._words(item, known)

    def _words(self, item: Block, known: set[str]) -> list[str]:
        """A function with its arguments, which have to be there."""
        words = [str(word) for word in item]
        for word in words[1:]:
            if word not in known:
                what = "variable" if word.startswith("?") else "object"
                raise self._wrong(
                    f"{said(item)}: there is no {what} {word!r}" + suggestion_or_list(word, known),
                    item.line,
                )
        return words

    def _valued(self, domain: Block, problem: Block) -> list[list[Any]]:
        """The values of all functions at first. Those that only numbers speak of are taken out."""
        costs = {
            str(word)
            for section in sections(domain, ":action")
            for block in blocks(section)
            if block[:1] == ["increase"]
            for inner in blocks(block)
            for word in inner[:1]
            if isinstance(word, str)
        }
        found: list[list[Any]] = []
        given: dict[tuple[str, ...], str] = {}
        for section in sections(problem, ":init"):
            for fact in list(section[1:]):
                if not isinstance(fact, Block) or fact[:1] != ["="] or len(fact) != 3:
                    continue
                words = fact[1] if isinstance(fact[1], Block) else [fact[1]]
                name = str(words[0]) if words else ""
                if name not in self._functions or name == _COST:
                    continue
                if not isinstance(fact[2], str) or not _is_number(fact[2]):
                    raise self._wrong(f"{said(fact)} gives no number", fact.line)
                if len(words) - 1 != len(self._functions[name]):
                    wanted = len(self._functions[name])
                    raise self._wrong(
                        f"{said(fact)}: {name} takes {wanted} arguments, got {len(words) - 1}",
                        fact.line,
                    )
                words = words if isinstance(words, Block) else _block(fact.line, *words)
                written = self._words(words, self._things)
                if given.setdefault(tuple(written), str(fact[2])) != fact[2]:
                    raise self._wrong(
                        f"{said(fact)}: it has the value {given[tuple(written)]} already; expected "
                        "one value of each number",
                        fact.line,
                    )
                found.append([written, str(fact[2])])
                if name not in costs:
                    section[:] = [each for each in section if each is not fact]
        return found

    def _make_room(self, domain: Block, place: int) -> None:
        """Declare what stands for numbers, with actions that bring about and end every condition.

        Without them the translator would take a condition for one that never changes.
        """
        line = domain.line
        names = [*self._conditions, *self._effects]
        declared = [_block(line, name) for name in names]
        for section in sections(domain, ":predicates"):
            section += declared
            break
        else:
            domain.insert(place, _block(line, ":predicates", *declared))
        for name in self._conditions:
            for on, effect in (
                ("on", _block(line, name)),
                ("off", _block(line, "not", _block(line, name))),
            ):
                domain.append(
                    _block(
                        line,
                        *(":action", f"{name}-{on}", ":parameters", _block(line)),
                        *(":precondition", _block(line, "and"), ":effect", effect),
                    )
                )

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
                "functions": [[name, args] for name, args in sorted(self._functions.items())],
                "changed": self._changed,
                "values": self._values,
            },
        }


def _compared(operator: str, left: Any, right: Any, *, holds: bool) -> list[Any]:
    """A comparison, or its opposite."""
    if holds:
        return ["compare", operator, left, right]
    if operator == "=":
        return ["or", ["compare", "<", left, right], ["compare", ">", left, right]]
    return ["compare", COMPARISONS[operator], left, right]


def _declared(domain: Block) -> Iterator[tuple[str, list[list[str]]]]:
    """The functions with the variables and types of their arguments."""
    for section in sections(domain, ":functions"):
        for each in section[1:]:
            if not isinstance(each, Block) or not each:
                continue
            arguments: list[list[str]] = []
            words = iter(each[1:])
            waiting: list[str] = []
            for word in words:
                if word == "-":
                    kind = next(words, "object")
                    kinds = kind[1:] if isinstance(kind, Block) else [kind]
                    arguments += [[name, "|".join(map(str, kinds))] for name in waiting]
                    waiting = []
                else:
                    waiting.append(str(word))
            yield str(each[0]), [*arguments, *([name, "object"] for name in waiting)]


def _is_about_numbers(block: Block) -> bool:
    head = block[0] if block else None
    if head in CHANGES and len(block) > 1:
        return _is_numeric(block[1]) and block[1] != [_COST]
    return _compares(block)


def _compares(block: Block) -> bool:
    """Whether it compares numbers; `=` is equality of objects, too, and gives values at first."""
    head = block[0] if block else None
    if head in COMPARISONS:
        return len(block) > 1 and any(map(_is_numeric, block[1:]))
    return head == "=" and len(block) == 3 and any(map(_is_numeric, block[1:]))


def _variables(parameters: object) -> set[str]:
    """The variables that a list of parameters declares."""
    words = parameters if isinstance(parameters, Block) else ()
    return {str(word) for word in words if isinstance(word, str) and word.startswith("?")}


def _is_numeric(item: object) -> bool:
    return isinstance(item, Block) or (isinstance(item, str) and _is_number(item))


def _is_number(word: str) -> bool:
    digits = word.removeprefix("-").replace(".", "", 1)
    return digits.isdigit() and word.isascii()


def _is_action(part: Block) -> bool:
    return part[:1] == [":action"]


def _block(line: int | None, *parts: object) -> Block:
    block = Block(line or 1)
    block += [Word(part, line or 1) if type(part) is str else part for part in parts]
    return block
