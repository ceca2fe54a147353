"""Durative actions (PDDL 2.1, Fox and Long 2003) taken apart into actions that take no time.

What a durative action `heat` says becomes four actions over the same parameters, and a predicate:

- `start-heat` needs the conditions at start and has the effects at start;
- `while-heat` needs the conditions over all, and changes nothing: it stands for a look at them;
- `end-heat` needs the conditions over all and at end and has the effects at end;
- `cancel-heat` stops it and takes back its effects at start, but for conditional and quantified
  ones; which of them, goes by what excludes what: see `Lasting.taken_back`;
- `(running-heat …)` holds in between.

How long it lasts is told beside them, see `taken_apart`.
"""

from collections.abc import Iterator
from typing import Any

from tpvqa.errors import suggestion_or_list
from tpvqa.pddl.arithmetic import COMPARISONS
from tpvqa.pddl.numeric import CHANGES
from tpvqa.pddl.worker.blocks import block_of, blocks, said, sections
from tpvqa.pddl.worker.durations import check_facts, duration_of, quickest
from tpvqa.pddl.worker.functions import Functions
from tpvqa.pddl.worker.lisp import Block, Word, line_of
from tpvqa.pddl.worker.reading_error import ReadingError

PREFIXES = ("start", "while", "end", "cancel")
_UNPLANNED = ("while", "cancel")
_REQUIREMENTS = (":durative-actions", ":duration-inequalities")
_TIMES = (("at", "start"), ("over", "all"), ("at", "end"))
_NUMERIC = (*CHANGES, *COMPARISONS)


def taken_apart(domain: Block, problem: Block) -> dict[str, Any] | None:
    """Put actions without duration in the place of a domain's durative ones.

    Args:
        domain: The domain; changed.
        problem: The problem; what says how long actions last is taken out of it.

    Returns:
        The durative actions by name, parameters and duration, `[lowest, highest]`, each as
        `Functions.expression` gives it; the values of the functions; whether the problem asks for
        the quickest plan. None for a domain without any.

    Raises:
        ReadingError: They cannot be read, or hold what is not known.
    """
    for section in sections(domain, ":requirements"):
        section[:] = [word for word in section if word not in _REQUIREMENTS]
    found = list(sections(domain, ":durative-action"))
    if not found:
        return None
    taken = {str(each[1]) for each in sections(domain, ":action") if len(each) > 1}
    declared = [
        str(each[0])
        for part in sections(domain, ":predicates")
        for each in part[1:]
        if isinstance(each, Block) and each
    ]
    for number, section in enumerate(found):
        if section[1:] and any(section[1] == other[1] for other in found[:number] if other[1:]):
            raise ReadingError(
                f"there are two durative actions of the name {said(section[1])}; expected one of "
                "each",
                "domain",
                section.line,
            )
    functions = Functions(domain, problem)
    actions = [_Durative(section, taken, declared, functions) for section in found]
    place = next(n for n, section in enumerate(domain) if section is found[0])
    domain[:] = [section for section in domain if all(section is not each for each in found)]
    domain[place:place] = [snap for action in actions for snap in action.snaps()]
    _declare(domain, [action.running for action in actions])
    check_facts(problem)
    return {
        "actions": [action.described() for action in actions],
        "values": functions.values(domain, problem),
        "quickest": quickest(problem),
    }


def leave_out_unplanned(task: Any) -> None:
    """Take what no plan is made of out of a translator's task: looks, and what is cancelled.

    They reach nothing that is not reached without them. But they keep mutex groups from being
    found: what is cancelled takes back facts that its precondition does not name.
    """
    if task.durative is not None:
        names = {
            f"{part}-{each['name']}" for each in task.durative["actions"] for part in _UNPLANNED
        }
        task.actions = [action for action in task.actions if action.name not in names]


Groups = list[tuple[list[tuple[str, ...]], bool]]


def without_running(task: Any, groups: Groups) -> Groups:
    """Mutex groups of what is seen alone: no fact that is denied says that an action has stopped,
    which the robot knows of itself.

    Args:
        task: The translator's task.
        groups: The atoms of each, and whether exactly one of them holds.
    """
    if task.durative is None:
        return groups
    running, found = {f"running-{each['name']}" for each in task.durative["actions"]}, []
    for atoms, exactly_one in groups:
        kept = [atom for atom in atoms if atom[0] not in running]
        if len(kept) > 1:
            found.append((kept, exactly_one and len(kept) == len(atoms)))
    return found


class _Durative:
    """One durative action as its author wrote it."""

    def __init__(
        self, section: Block, taken: set[str], predicates: list[str], functions: Functions
    ):
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
        self._atom = block_of(self.line, f"running-{name}", *variables)
        self.running = block_of(self.line, f"running-{name}", *self._parameters)
        known = {*map(str, variables), *functions.things}
        self.duration = duration_of(name, self._parts[":duration"], functions, known)
        self._conditions = [self._at(":condition", time) for time in _TIMES]
        self._effects = [self._at(":effect", time) for time in _TIMES]
        if self._effects[1]:
            raise self._wrong(
                f"the durative action {name} has an effect over all; expected (at start …) or "
                "(at end …)",
                line_of(self._effects[1]),
            )

    def _wrong(self, message: str, line: int | None = None) -> ReadingError:
        return ReadingError(message, "domain", line or self.line)

    def _read(self, section: Block) -> dict[str, Block]:
        known = (":parameters", ":duration", ":condition", ":effect")
        parts: dict[str, Block] = {}
        words = iter(section[2:])
        for key in words:
            value = next(words, None)
            if key not in known:
                written = f" (it is called {known[2]} here)" * (key == ":precondition")
                raise self._wrong(
                    f"{said(key)} stands in the durative action {self.name}{written}"
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
        runs, stopped = self._atom, block_of(self.line, "not", self._atom)
        plain = [each for each in begins if each[:1] not in (["forall"], ["when"])]
        undone = [block_of(self.line, "when", each, _opposite(each)) for each in plain]
        for prefix, needs, does in (
            ("start", [stopped, *start], [runs, *begins]),
            ("while", [runs, *during], [runs]),
            ("end", [runs, *during, *end], [stopped, *ends]),
            ("cancel", [runs], [stopped, *undone]),
        ):
            snap = block_of(self.line, ":action", Word(f"{prefix}-{self.name}", self.name.line))
            snap += [Word(":parameters", self.line), self._parameters]
            snap += [Word(":precondition", self.line), block_of(self.line, "and", *needs)]
            snap += [Word(":effect", self.line), block_of(self.line, "and", *does)]
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
            raise self._wrong(f"{said(block)} stands in {key} of {self.name}", line_of(block))
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
                yield block_of(block.line, "forall", block[1], part)
        elif head == "when" and len(block) == 3:
            yield from self._when(block, time)
        else:
            self._check_plain(block)
            raise self._wrong(
                f"{said(block)} in {key} of {self.name} has no time; expected (at start …), "
                "(over all …) or (at end …) around it",
                block.line,
            )

    def _when(self, block: Block, time: tuple[str, str]) -> Iterator[Block]:
        effects = list(self._projected(block[2], time, ":effect"))
        if not effects:
            return
        now = list(self._projected(block[1], time, "(when …)"))
        all_times = [
            part for each in _TIMES for part in self._projected(block[1], each, "(when …)")
        ]
        if len(now) != len(all_times):
            raise self._wrong(
                f"a conditional effect of {self.name} has its condition at another time than its "
                "effect, which is not known; remember the condition by a fact that an effect at "
                "start states",
                block.line,
            )
        for effect in effects:
            yield block_of(block.line, "when", block_of(block.line, "and", *now), effect)

    def _check_plain(self, block: object) -> None:
        """See that there are no numbers in it that change."""
        for part in blocks(block):
            head = part[0] if part else ""
            if "#t" in part:
                raise self._wrong(
                    f"{self.name} has an effect that goes on while it runs (#t), which is not "
                    "known; state at start or at end what comes of it",
                    line_of(part),
                )
            if head in _NUMERIC and any(isinstance(each, Block) for each in part[1:]):
                raise self._wrong(
                    f"{said(part)} in the durative action {self.name} is about numbers, which "
                    "are known in :duration alone; say by a fact what they come to",
                    line_of(part),
                )
            if head in (">", "<", "<=", ">="):
                raise self._wrong(f"{said(part)} in {self.name} is about numbers", line_of(part))


def _declare(domain: Block, running: list[Block]) -> None:
    for section in sections(domain, ":predicates"):
        section += running
        return
    place = next(
        n for n, part in enumerate(domain) if isinstance(part, Block) and part[0] == ":action"
    )
    domain.insert(place, block_of(domain.line, ":predicates", *running))


def _opposite(literal: Block) -> Any:
    if literal[:1] == ["not"] and len(literal) == 2:
        return literal[1]
    return block_of(literal.line, "not", literal)
