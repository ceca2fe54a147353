"""The functions of a domain: expressions of them, and the values that a problem gives them."""

from collections.abc import Collection, Iterator, Sequence
from typing import Any

from tpvqa.errors import suggestion_or_list
from tpvqa.pddl.arithmetic import ARITHMETIC, COMPARISONS, is_number, number
from tpvqa.pddl.worker.blocks import block_of, blocks, said, sections
from tpvqa.pddl.worker.lisp import Block, line_of
from tpvqa.pddl.worker.reading_error import ReadingError

COST = "total-cost"
"""The function that only says what plans cost."""


class Functions:
    """The functions that a domain declares.

    Args:
        domain: The domain.
        problem: The problem; its objects may be their arguments.

    Attributes:
        arguments: Variables and types of the arguments of each; `a|b` for `(either a b)`.
        things: The objects of both.

    Raises:
        ReadingError: Two have one name, or one has a name that means something else.
    """

    def __init__(self, domain: Block, problem: Block):
        declared = list(_declared(domain))
        self.arguments = dict(declared)
        odd = next((name for name in self.arguments if name in (*ARITHMETIC, *COMPARISONS)), None)
        if odd is not None:
            raise ReadingError(
                f"a function is called {odd!r}, which means something else in expressions; take "
                "another name",
                "domain",
                next(sections(domain, ":functions")).line,
            )
        for name in self.arguments:
            if sum(other == name for other, _ in declared) > 1:
                raise ReadingError(
                    f"there are two functions of the name {name!r}; expected one of each",
                    "domain",
                    next(sections(domain, ":functions")).line,
                )
        self.things = {
            name
            for definition, kind in ((domain, ":constants"), (problem, ":objects"))
            for section in sections(definition, kind)
            for name, _ in _typed(section[1:])
        }

    def is_number(self, item: object) -> bool:
        """Whether something stands for a number: a block, or a word that is one or names one."""
        if not isinstance(item, str):
            return isinstance(item, Block)
        named = item in self.arguments and item not in self.things and item != COST
        return named or is_number(item)

    def expression(self, item: object, known: Collection[str], part: str) -> Any:
        """A number as it is written, `[function, argument, …]`, or `[operator, …, …]`.

        Args:
            item: What is written.
            known: The variables and objects that it may speak of.
            part: Whether it stands in the domain or the problem.

        Raises:
            ReadingError: It is none.
        """

        def wrong(message: str, line: int | None) -> ReadingError:
            return ReadingError(message, part, line)

        if isinstance(item, str):
            if is_number(item):
                return str(item)
            item = block_of(line_of(item), item)
        head = item[0] if isinstance(item, Block) and item else None
        if not isinstance(item, Block) or not isinstance(head, str) or head[0] in "?.0123456789":
            raise wrong(
                f"{said(item)} is no number; expected one as 2, -2 or 0.5, a function, or one of "
                f"{' '.join(ARITHMETIC)} with two of such",
                line_of(item),
            )
        if head in ARITHMETIC:
            parts = [self.expression(each, known, part) for each in item[1:]]
            if head == "-" and len(parts) == 1:
                return ["-", "0", parts[0]]
            if len(parts) < 2 or (head in "-/" and len(parts) > 2):
                raise wrong(f"{said(item)} wants two numbers", item.line)
            while len(parts) > 2:
                pairs = [parts[n : n + 2] for n in range(0, len(parts), 2)]  # deep by log2 alone
                parts = [[str(head), *two] if len(two) == 2 else two[0] for two in pairs]
            return [str(head), *parts]
        if head not in self.arguments:
            raise self._undeclared(item, part)
        if head == COST:
            raise wrong(
                f"{said(item)}: total-cost is for (:metric minimize (total-cost)) alone; take a "
                "function of your own for what actions need",
                item.line,
            )
        return self._called(item, known, part)

    def _undeclared(self, item: Block, part: str) -> ReadingError:
        name = str(item[0])
        return ReadingError(
            f"{said(item)} speaks of the function {name!r}, which (:functions …) does not declare"
            + suggestion_or_list(name, self.arguments),
            part,
            line_of(item),
        )

    def _called(self, item: Block, known: Collection[str], part: str) -> list[str]:
        """A function with its arguments, which have to be there."""
        name, *arguments = item
        wanted = len(self.arguments[str(name)])
        if len(arguments) != wanted or not all(isinstance(each, str) for each in arguments):
            raise ReadingError(
                f"{said(item)}: {name} takes {wanted} arguments, got {len(arguments)}",
                part,
                item.line,
            )
        for word in map(str, arguments):
            if word not in known:
                what = "variable" if word.startswith("?") else "object"
                raise ReadingError(
                    f"{said(item)}: there is no {what} {word!r}" + suggestion_or_list(word, known),
                    part,
                    item.line,
                )
        return [str(name), *arguments]  # type: ignore[list-item]  # each knows its line

    def values(self, domain: Block, problem: Block) -> list[list[Any]]:
        """What all functions are at first, but for the total cost: `[[name, …], number]` each.

        Those that no cost speaks of are taken out of the problem.

        Raises:
            ReadingError: One has no value that is a number, or two.
        """
        costs = _costs(domain)
        found: dict[tuple[str, ...], list[Any]] = {}
        for section in sections(problem, ":init"):
            for fact in list(section[1:]):
                if not isinstance(fact, Block) or fact[:1] != ["="] or len(fact) != 3:
                    continue
                called, value = fact[1:]
                words = called if isinstance(called, Block) else block_of(fact.line, called)
                if not words or words[0] == COST or not isinstance(words[0], str):
                    continue
                if words[0] not in self.arguments:
                    raise self._undeclared(words, "problem")
                if not isinstance(value, str) or not is_number(value):
                    raise ReadingError(
                        f"{said(fact)} gives no number; expected one as 2, -2 or 0.5",
                        "problem",
                        fact.line,
                    )
                given = self._called(words, self.things, "problem")
                known = found.setdefault(tuple(given), [given, str(value)])
                if number(known[1]) != number(value):
                    raise ReadingError(
                        f"{said(fact)}: it has the value {known[1]} already; expected one value "
                        "of each number",
                        "problem",
                        fact.line,
                    )
                if words[0] not in costs:
                    section[:] = [each for each in section if each is not fact]
        return list(found.values())


def _declared(domain: Block) -> Iterator[tuple[str, list[list[str]]]]:
    """The functions with the variables and types of their arguments."""
    for section in sections(domain, ":functions"):
        for each in section[1:]:
            if not isinstance(each, Block) or not each:
                continue
            yield str(each[0]), [[name, kind] for name, kind in _typed(each[1:])]


def _typed(words: Sequence[object]) -> Iterator[tuple[str, str]]:
    """The names of a typed list with their types."""
    waiting: list[str] = []
    left = iter(words)
    for word in left:
        if word == "-":
            kind = next(left, "object")
            kinds = kind[1:] if isinstance(kind, Block) else [kind]
            yield from ((name, "|".join(map(str, kinds))) for name in waiting)
            waiting = []
        else:
            waiting.append(str(word))
    yield from ((name, "object") for name in waiting)


def _costs(domain: Block) -> set[str]:
    """The functions that what is left of the actions speaks of: what they cost."""
    return {
        str(word)
        for section in sections(domain, ":action")
        for block in blocks(section)
        if block[:1] == ["increase"]
        for inner in blocks(block)
        for word in inner[:1]
        if isinstance(word, str)
    }
