"""Durative actions (PDDL 2.1, Fox and Long 2003) taken apart into actions that take no time.

What a durative action `heat` says becomes four actions over the same parameters, and a predicate:

- `start-heat` needs the conditions at start and has the effects at start;
- `while-heat` needs the conditions over all, and changes nothing: it stands for a look at them;
- `end-heat` needs the conditions over all and at end and has the effects at end;
- `cancel-heat` stops it and takes back its effects at start, but for conditional and quantified
  ones; nothing of its end comes to pass;
- `(running-heat …)` holds in between.

How long it lasts is told beside them, see `taken_apart`.
"""

from collections.abc import Iterator
from typing import Any

from tpvqa.errors import shown, suggestion_or_list
from tpvqa.pddl.worker.lisp import Block, Word, line_of

PREFIXES = ("start", "while", "end", "cancel")
_REQUIREMENTS = (":durative-actions", ":duration-inequalities")
_TIMES = (("at", "start"), ("over", "all"), ("at", "end"))
_BOUNDS = {"=": (0, 1), ">=": (0,), "<=": (1,)}
_ARITHMETIC = ("+", "-", "*", "/")
_NUMERIC = ("increase", "decrease", "assign", "scale-up", "scale-down", "<", ">", "<=", ">=", "=")


class DurativeError(Exception):
    """A durative action that cannot be read.

    Args:
        message: What is wrong and what was expected.
        part: "domain" or "problem".
        line: The line, where known.
    """

    def __init__(self, message: str, part: str, line: int | None):
        super().__init__(message)
        self.message, self.part, self.line = message, part, line


def taken_apart(domain: Block, problem: Block) -> dict[str, Any] | None:
    """Put actions without duration in the place of a domain's durative ones.

    Args:
        domain: The domain; changed.
        problem: The problem; what says how long actions last is taken out of it.

    Returns:
        The durative actions by name, parameters and duration, `[lowest, highest]`, each a number,
        `[function, argument, …]` or an operator with two of such; the values of the functions;
        whether the problem asks for the quickest plan. None for a domain without any.

    Raises:
        DurativeError: They cannot be read, or hold what is not known.
    """
    found = list(_sections(domain, ":durative-action"))
    if not found:
        return None
    for section in _sections(domain, ":requirements"):
        section[:] = [word for word in section if word not in _REQUIREMENTS]
    taken = {str(each[1]) for each in _sections(domain, ":action") if len(each) > 1}
    declared = [
        str(each[0]) for part in _sections(domain, ":predicates") for each in part[1:] if each
    ]
    actions = [_Durative(section, taken, declared) for section in found]
    place = next(n for n, section in enumerate(domain) if section is found[0])
    domain[:] = [section for section in domain if all(section is not each for each in found)]
    domain[place:place] = [snap for action in actions for snap in action.snaps()]
    _declare(domain, [action.running for action in actions])
    functions = {name for action in actions for name in action.functions}
    _check_functions(domain, problem, functions)
    return {
        "actions": [action.described() for action in actions],
        "values": _values(domain, problem, functions),
        "quickest": _quickest(problem),
    }


class _Durative:
    """One durative action as its author wrote it."""

    def __init__(self, section: Block, taken: set[str], predicates: list[str]):
        self.line = section.line
        name = section[1] if len(section) > 1 else None
        if not isinstance(name, Word):
            raise self._wrong("a durative action has no name; expected (:durative-action NAME …)")
        self.name = name
        self._parts = self._read(section)
        for prefix in PREFIXES:
            if f"{prefix}-{name}" in taken:
                raise self._wrong(
                    f"the action {prefix}-{name} has the name that a part of the durative action "
                    f"{name} is given; rename one of them"
                )
        if f"running-{name}" in predicates:
            raise self._wrong(
                f"the predicate running-{name} has the name that says that the durative action "
                f"{name} is running; rename one of them"
            )
        self._parameters = self._parts.get(":parameters", Block(self.line))
        variables = [word for word in self._parameters if str(word).startswith("?")]
        self._atom = _block(self.line, f"running-{name}", *variables)
        self.running = _block(self.line, f"running-{name}", *self._parameters)
        self.functions: set[str] = set()
        self.duration = self._bounds()
        self._conditions = [self._at(":condition", time) for time in _TIMES]
        self._effects = [self._at(":effect", time) for time in _TIMES]
        if self._effects[1]:
            raise self._wrong(
                f"the durative action {name} has an effect over all; expected (at start …) or "
                "(at end …)",
                line_of(self._effects[1]),
            )

    def _wrong(self, message: str, line: int | None = None) -> DurativeError:
        return DurativeError(message, "domain", line or self.line)

    def _read(self, section: Block) -> dict[str, Block]:
        known = (":parameters", ":duration", ":condition", ":effect")
        parts: dict[str, Block] = {}
        words = iter(section[2:])
        for key in words:
            value = next(words, None)
            if key not in known:
                written = f" (it is called {known[2]} here)" * (key == ":precondition")
                raise self._wrong(
                    f"{_said(key)} stands in the durative action {self.name}{written}"
                    + suggestion_or_list(str(key), known),
                    line_of(key),
                )
            if not isinstance(value, Block):
                raise self._wrong(f"{key} of {self.name} needs a block after it", line_of(key))
            parts[str(key)] = value
        if ":duration" not in parts:
            raise self._wrong(
                f"the durative action {self.name} does not say how long it lasts; expected "
                ":duration (= ?duration …)"
            )
        return parts

    def snaps(self) -> Iterator[Block]:
        """The four actions that it becomes."""
        start, during, end = self._conditions
        begins, _, ends = self._effects
        runs, stopped = self._atom, _block(self.line, "not", self._atom)
        undone = [_opposite(each) for each in begins if each[:1] not in (["forall"], ["when"])]
        for prefix, needs, does in (
            ("start", [stopped, *start], [runs, *begins]),
            ("while", [runs, *during], [runs]),
            ("end", [runs, *during, *end], [stopped, *ends]),
            ("cancel", [runs], [stopped, *undone]),
        ):
            snap = _block(self.line, ":action", Word(f"{prefix}-{self.name}", self.name.line))
            snap += [Word(":parameters", self.line), self._parameters]
            snap += [Word(":precondition", self.line), _block(self.line, "and", *needs)]
            snap += [Word(":effect", self.line), _block(self.line, "and", *does)]
            yield snap

    def described(self) -> dict[str, Any]:
        """What its parts do not say."""
        variables = [str(word) for word in self._atom[1:]]
        return {"name": str(self.name), "variables": variables, "duration": self.duration}

    def _at(self, key: str, time: tuple[str, str]) -> list[Block]:
        """The conditions or effects of a time, as parts of a conjunction."""
        written = self._parts.get(key)
        return [] if not written else [*self._projected(written, time, key)]

    def _projected(self, block: object, time: tuple[str, str], key: str) -> Iterator[Block]:
        head = block[0] if isinstance(block, Block) and block else None
        if not isinstance(block, Block) or head is None:
            raise self._wrong(f"{_said(block)} stands in {key} of {self.name}", line_of(block))
        if head == "and":
            for part in block[1:]:
                yield from self._projected(part, time, key)
        elif tuple(block[:2]) in _TIMES and len(block) == 3:
            if tuple(block[:2]) == time:
                self._check_plain(block[2])
                assert isinstance(block[2], Block)
                yield block[2]
        elif head == "forall" and len(block) == 3:
            for part in self._projected(block[2], time, key):
                yield _block(block.line, "forall", block[1], part)
        elif head == "when" and len(block) == 3:
            yield from self._when(block, time)
        else:
            self._check_plain(block)
            raise self._wrong(
                f"{_said(block)} in {key} of {self.name} has no time; expected (at start …), "
                "(over all …) or (at end …) around it",
                block.line,
            )

    def _when(self, block: Block, time: tuple[str, str]) -> Iterator[Block]:
        effects = list(self._projected(block[2], time, ":effect"))
        if not effects:
            return
        now = list(self._projected(block[1], time, "(when …)"))
        all_times = [part for each in _TIMES for part in self._projected(block[1], each, "(when …)")]
        if len(now) != len(all_times):
            raise self._wrong(
                f"a conditional effect of {self.name} has its condition at another time than its "
                "effect, which is not known; remember the condition by a fact that an effect at "
                "start states",
                block.line,
            )
        for effect in effects:
            yield _block(block.line, "when", _block(block.line, "and", *now), effect)

    def _check_plain(self, block: object) -> None:
        """See that there are no numbers in it that change."""
        for part in _blocks(block):
            head = part[0] if part else ""
            if "#t" in part:
                raise self._wrong(
                    f"{self.name} has an effect that goes on while it runs (#t), which is not "
                    "known; state at start or at end what comes of it",
                    line_of(part),
                )
            if head in _NUMERIC and any(isinstance(each, Block) for each in part[1:]):
                raise self._wrong(
                    f"{_said(part)} in the durative action {self.name} is about numbers, which "
                    "are known in :duration alone; say by a fact what they come to",
                    line_of(part),
                )
            if head in (">", "<", "<=", ">="):
                raise self._wrong(f"{_said(part)} in {self.name} is about numbers", line_of(part))

    def _bounds(self) -> list[Any]:
        """The least and the greatest duration."""
        bounds: list[Any] = [None, None]
        block = self._parts[":duration"]
        for part in block[1:] if block[:1] == ["and"] else [block]:
            if isinstance(part, Block) and part[:2] == ["at", "start"] and len(part) == 3:
                part = part[2]
            said = isinstance(part, Block) and len(part) == 3 and part[1] == "?duration"
            if not said or str(part[0]) not in _BOUNDS:  # type: ignore[index]
                raise self._wrong(
                    f"{_said(part)} does not say how long {self.name} lasts; expected "
                    "(= ?duration …), (>= ?duration …) or (<= ?duration …)",
                    line_of(part),
                )
            for which in _BOUNDS[str(part[0])]:  # type: ignore[index]
                bounds[which] = self._number(part[2])  # type: ignore[index]
        if None in bounds:
            side = "least" if bounds[0] is None else "most"
            raise self._wrong(
                f"{self.name} says not how long it lasts at {side}; expected (= ?duration …), or "
                "both (>= ?duration …) and (<= ?duration …)",
                block.line,
            )
        return bounds

    def _number(self, said: object) -> Any:
        if isinstance(said, str) and is_number(said):
            return float(said)
        if isinstance(said, Block) and len(said) == 3 and said[0] in _ARITHMETIC:
            return [str(said[0]), self._number(said[1]), self._number(said[2])]
        words = said if isinstance(said, Block) else [said]
        if not words or not all(isinstance(word, str) for word in words) or "?duration" in words:
            raise self._wrong(
                f"{_said(said)} is no duration; expected a number, a function or one of "
                f"{' '.join(_ARITHMETIC)} with two of such",
                line_of(said),
            )
        self.functions.add(str(words[0]))
        return [*map(str, words)]


def _declare(domain: Block, running: list[Block]) -> None:
    for section in _sections(domain, ":predicates"):
        section += running
        return
    place = next(n for n, part in enumerate(domain) if isinstance(part, Block) and part[0] == ":action")
    domain.insert(place, _block(domain.line, ":predicates", *running))


def _check_functions(domain: Block, problem: Block, functions: set[str]) -> None:
    declared = {
        str(each[0])
        for section in _sections(domain, ":functions")
        for each in section
        if isinstance(each, Block) and each
    }
    for section in _sections(domain, ":action"):
        for block in _blocks(section):
            if block[:1] and block[0] in functions and block[0] in declared:
                raise DurativeError(
                    f"{_said(block)} says how long an action lasts, and is spoken of in another "
                    "action too; take a function of its own for one of them",
                    "domain",
                    block.line,
                )
    for name in sorted(functions - declared):
        raise DurativeError(
            f"a duration speaks of {shown(name)}, which (:functions …) does not declare"
            + suggestion_or_list(name, declared),
            "domain",
            domain.line,
        )
    for section in _sections(problem, ":init"):
        for fact in section[1:]:
            if isinstance(fact, Block) and fact[:1] == ["at"] and len(fact) == 3:
                if isinstance(fact[1], str) and is_number(fact[1]) and isinstance(fact[2], Block):
                    raise DurativeError(
                        f"{_said(fact)} is a timed initial literal, which is not known; bring it "
                        "about by a durative action of that duration",
                        "problem",
                        fact.line,
                    )


def _values(domain: Block, problem: Block, functions: set[str]) -> list[list[Any]]:
    """The values of functions; what declares and states them is taken out."""
    for section in _sections(domain, ":functions"):
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
    for section in _sections(problem, ":init"):
        for fact in list(section[1:]):
            if not isinstance(fact, Block) or fact[:1] != ["="] or len(fact) != 3:
                continue
            called = fact[1] if isinstance(fact[1], Block) else [fact[1]]
            if not called or called[0] not in functions:
                continue
            if not isinstance(fact[2], str) or not is_number(fact[2]):
                raise DurativeError(f"{_said(fact)} gives no number", "problem", fact.line)
            values.append([[*map(str, called)], float(fact[2])])
            section[:] = [each for each in section if each is not fact]
    return values


def _quickest(problem: Block) -> bool:
    """Whether the quickest plan is asked for; that is taken out."""
    for section in _sections(problem, ":metric"):
        if any(word == "total-time" for block in _blocks(section) for word in block):
            if section[1:] not in (["minimize", ["total-time"]], ["minimize", "total-time"]):
                raise DurativeError(
                    "(:metric …) speaks of total-time and of more, which is not known; expected "
                    "(:metric minimize (total-time))",
                    "problem",
                    section.line,
                )
            problem[:] = [part for part in problem if part is not section]
            return True
    return False


def is_number(word: str) -> bool:
    """Whether a word is a number as PDDL writes them."""
    return word.replace(".", "", 1).isdigit() and word.isascii()


def _sections(definition: Block, name: str) -> Iterator[Block]:
    for part in list(definition):
        if isinstance(part, Block) and part[:1] == [name]:
            yield part


def _blocks(item: object) -> Iterator[Block]:
    if isinstance(item, Block):
        yield item
        for part in item:
            yield from _blocks(part)


def _block(line: int, *parts: object) -> Block:
    block = Block(line)
    block += [Word(part, line) if type(part) is str else part for part in parts]
    return block


def _opposite(literal: Block) -> Any:
    if literal[:1] == ["not"] and len(literal) == 2:
        return literal[1]
    return _block(literal.line, "not", literal)


def _said(item: object) -> str:
    def text(part: object) -> str:
        return f"({' '.join(map(text, part))})" if isinstance(part, list) else str(part)

    return shown(text(item))
