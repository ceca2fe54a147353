"""How long actions last: the durations of a domain, and what its problem says of them."""

import re
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from tpvqa.errors import shown, suggestion_or_list
from tpvqa.pddl.worker.lisp import Block, line_of
from tpvqa.pddl.worker.reading_error import ReadingError

_BOUNDS = {"=": (0, 1), ">=": (0,), "<=": (1,)}
_ARITHMETIC = ("+", "-", "*", "/")
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]{1,2})?")


class Duration:
    """How long a durative action lasts.

    Args:
        name: The action.
        written: What stands after `:duration`.

    Attributes:
        bounds: The least and the greatest duration, each a number, `[function, argument, …]` or an
            operator with two of such.
        functions: The functions that it speaks of, and where.

    Raises:
        ReadingError: It says something else.
    """

    def __init__(self, name: str, written: Block):
        self._name = name
        self.functions: dict[str, int | None] = {}
        self.bounds = self._read(written)

    def _wrong(self, message: str, line: int | None) -> ReadingError:
        return ReadingError(message, "domain", line)

    def _read(self, block: Block) -> list[Any]:
        bounds: list[Any] = [None, None]
        for part in block[1:] if block[:1] == ["and"] else [block]:
            if isinstance(part, Block) and part[:2] == ["at", "start"] and len(part) == 3:
                part = part[2]
            given = part if isinstance(part, Block) and len(part) == 3 else Block(block.line)
            if given[1:2] != ["?duration"] or str(given[0]) not in _BOUNDS:
                raise self._wrong(
                    f"{said(part)} does not say how long {self._name} lasts; expected "
                    "(= ?duration …), (>= ?duration …) or (<= ?duration …)",
                    line_of(part),
                )
            for which in _BOUNDS[str(given[0])]:
                bounds[which] = self._number(given[2])
        if None in bounds:
            side = "least" if bounds[0] is None else "most"
            raise self._wrong(
                f"{self._name} says not how long it lasts at {side}; expected (= ?duration …), or "
                "both (>= ?duration …) and (<= ?duration …)",
                block.line,
            )
        return bounds

    def _number(self, item: object) -> Any:
        if isinstance(item, str) and is_number(item):
            return float(item)
        if isinstance(item, Block) and len(item) == 3 and item[0] in _ARITHMETIC:
            return [str(item[0]), self._number(item[1]), self._number(item[2])]
        words = item if isinstance(item, Block) else [item]
        if not words or not all(isinstance(word, str) for word in words) or "?duration" in words:
            raise self._wrong(
                f"{said(item)} is no duration; expected a number, a function or one of "
                f"{' '.join(_ARITHMETIC)} with two of such",
                line_of(item),
            )
        self.functions[str(words[0])] = line_of(words)
        return [*map(str, words)]


def check_functions(domain: Block, problem: Block, functions: Mapping[str, int | None]) -> None:
    """See that durations speak of what is declared, and that nothing else is about time.

    Raises:
        ReadingError: They do not.
    """
    declared = {
        str(each[0])
        for section in sections(domain, ":functions")
        for each in section
        if isinstance(each, Block) and each
    }
    for section in sections(domain, ":action"):
        for block in blocks(section):
            if block[:1] and block[0] in functions and block[0] in declared:
                raise ReadingError(
                    f"{said(block)} says how long an action lasts, and is spoken of in another "
                    "action too; take a function of its own for one of them",
                    "domain",
                    block.line,
                )
    for name in sorted(functions.keys() - declared):
        raise ReadingError(
            f"a duration speaks of {shown(name)}, which (:functions …) does not declare"
            + suggestion_or_list(name, declared),
            "domain",
            functions[name],
        )
    for section in sections(problem, ":init"):
        for fact in section[1:]:
            if isinstance(fact, Block) and _is_timed(fact):
                raise ReadingError(
                    f"{said(fact)} is a timed initial literal, which is not known; bring it about "
                    "by a durative action of that duration",
                    "problem",
                    fact.line,
                )


def _is_timed(fact: Block) -> bool:
    """Whether it is `(at NUMBER LITERAL)`."""
    if len(fact) != 3 or fact[0] != "at" or not isinstance(fact[2], Block):
        return False
    return isinstance(fact[1], str) and is_number(fact[1])


def values_of(domain: Block, problem: Block, functions: Collection[str]) -> list[list[Any]]:
    """The values of functions; what declares and states them is taken out."""
    for section in sections(domain, ":functions"):
        kept: list[object] = []
        dropped = False
        for word in section:
            if isinstance(word, Block):
                dropped = bool(word) and word[0] in functions
                if not dropped:
                    kept.append(word)
            elif not dropped or word not in ("-", "number"):
                kept.append(word)
        section[:] = kept
    domain[:] = [part for part in domain if part != [":functions"]]
    values: list[list[Any]] = []
    for section in sections(problem, ":init"):
        for fact in list(section[1:]):
            if not isinstance(fact, Block) or fact[:1] != ["="] or len(fact) != 3:
                continue
            called = fact[1] if isinstance(fact[1], Block) else [fact[1]]
            if not called or called[0] not in functions:
                continue
            if not isinstance(fact[2], str) or not is_number(fact[2]):
                raise ReadingError(
                    f"{said(fact)} gives no number; expected one as 2, -2, 0.5 or 5e-1",
                    "problem",
                    fact.line,
                )
            words, value = [*map(str, called)], float(fact[2])
            if any(before == words and other != value for before, other in values):
                raise ReadingError(
                    f"{said(fact)} gives another value to what has one already; take one of "
                    "them out",
                    "problem",
                    fact.line,
                )
            values.append([words, value])
            section[:] = [each for each in section if each is not fact]
    return values


def quickest(problem: Block) -> bool:
    """Whether the quickest plan is asked for; that is taken out."""
    for section in sections(problem, ":metric"):
        if section[1:] in (["minimize", ["total-time"]], ["minimize", "total-time"]):
            problem[:] = [part for part in problem if part is not section]
            return True
    return False


def is_number(word: str) -> bool:
    """Whether a word is a number as PDDL writes them."""
    return _NUMBER.fullmatch(word) is not None


def sections(definition: Block, name: str) -> Iterator[Block]:
    for part in list(definition):
        if isinstance(part, Block) and part[:1] == [name]:
            yield part


def blocks(item: object) -> Iterator[Block]:
    if isinstance(item, Block):
        yield item
        for part in item:
            yield from blocks(part)


def said(item: object) -> str:
    def text(part: object) -> str:
        return f"({' '.join(map(text, part))})" if isinstance(part, list) else str(part)

    return shown(text(item))
