"""Two PDDL texts → the translator's task, and errors that say where and what was expected."""

from collections.abc import Iterable, Mapping
from types import TracebackType
from typing import Any

from fast_downward.translate import pddl
from fast_downward.translate.pddl_parser import parsing_functions
from fast_downward.translate.pddl_parser.parse_error import ParseError

from tpvqa.errors import shown, suggestion_or_list
from tpvqa.pddl.worker.blocks import sections
from tpvqa.pddl.worker.costs import check_costs
from tpvqa.pddl.worker.durative import taken_apart
from tpvqa.pddl.worker.effects import check_equality, misplaced_forall
from tpvqa.pddl.worker.keywords import mistyped
from tpvqa.pddl.worker.lisp import Block, LispError, line_of, read_block
from tpvqa.pddl.worker.metric import passed_over
from tpvqa.pddl.worker.numeric import taken_out as numbers_taken_out
from tpvqa.pddl.worker.reading_error import ReadingError
from tpvqa.pddl.worker.requirements import beyond, undeclared
from tpvqa.pddl.worker.typing_check import ill_typed
from tpvqa.pddl.worker.unsure import Unsure, UnsureError, taken_out


class _LocatedError(ParseError):  # type: ignore[misc]
    def __init__(self, message: str, layers: list[str], item: object, syntax: str | None):
        super().__init__(message)
        self.message, self.layers, self.item, self.syntax = message, layers, item, syntax


class _Context(parsing_functions.Context):  # type: ignore[misc]
    """The translator's parsing context, which also remembers the object that is wrong."""

    def error(self, message: str, item: object = None, syntax: str | None = None) -> None:
        raise _LocatedError(message, list(self._traceback), item, syntax)


parsing_functions.Context = _Context


def read(domain_text: str, problem_text: str) -> tuple[Any, Unsure]:
    """Parse a domain and a problem.

    Returns:
        The translator's task, not normalised: conditions and effects as the author wrote them; and
        what the problem leaves open of the initial state, of which the task states nothing.

    Raises:
        ReadingError: Something in them is wrong.
    """
    blocks = {}
    for part, text in (("domain", domain_text), ("problem", problem_text)):
        try:
            blocks[part] = read_block(text)
        except LispError as error:
            raise ReadingError(error.message, part, error.line) from None
        _check_kind(part, blocks[part])
    needs = undeclared(blocks["domain"], blocks["problem"])
    if needs is not None:
        raise ReadingError(*needs)
    durative = taken_apart(blocks["domain"], blocks["problem"])
    metric = passed_over(blocks["problem"], _function_names(blocks["domain"]))
    numeric = numbers_taken_out(blocks["domain"], blocks["problem"], durative=durative is not None)
    found = beyond(blocks["domain"])
    if found is not None:
        raise ReadingError(found[0], "domain", found[1])
    _check_things(blocks)
    # Of two the parser takes the last, and blames whoever uses the other.
    _check_unique("predicates", _declared(blocks["domain"], ":predicates"))
    try:
        unsure = taken_out(blocks["problem"])
    except UnsureError as error:
        raise ReadingError(error.message, "problem", error.line) from None
    try:
        task = parsing_functions.parse_task(blocks["domain"], blocks["problem"])
        task.durative, task.numeric, task.metric = durative, numeric, metric
        _check_types(task, blocks)
        check_equality(task)
        _check_derived(task)
        _check_names(task, blocks["domain"])
        check_costs(task, _function_names(blocks["domain"]))
    except _LocatedError as error:
        raise _explained(error, blocks) from None
    except (MemoryError, ReadingError):
        raise
    except Exception as error:  # noqa: BLE001  the parser trips over what it does not expect
        raise _not_understood(error) from None
    for wrong in ill_typed(task):
        raise ReadingError(*wrong)
    left_open = unsure.atoms
    if left_open:
        task.init = [fact for fact in task.init if not _is_one_of(fact, left_open)]
    return task, unsure


def _is_one_of(fact: Any, keys: frozenset[tuple[str, ...]]) -> bool:
    return isinstance(fact, pddl.Atom) and (fact.predicate, *fact.args) in keys


def _check_kind(part: str, block: Block) -> None:
    """A problem where the domain is expected, and the other way round, is told as that."""
    begins = block[1] if len(block) > 1 else None
    found = str(begins[0]) if isinstance(begins, Block) and begins else ""
    other = "problem" if part == "domain" else "domain"
    if found == other:
        raise ReadingError(
            f"this file is a {other}, where the {part} is expected; name the domain first, then "
            "the problem",
            part,
            block.line,
        )
    if part == "problem" and found == "problem":
        kinds = [each[0] for each in block[2:] if isinstance(each, Block) and each]
        for wanted in (":domain", ":init", ":goal"):
            if wanted not in kinds:
                raise ReadingError(f"the problem has no ({wanted} …)", part, block.line)
        if kinds.index(":init") > kinds.index(":goal"):
            raise ReadingError(
                "(:goal …) stands before (:init …); put it after, as Fast Downward wants it",
                part,
                line_of(kinds[kinds.index(":goal")]),
            )


def _check_things(blocks: Mapping[str, Block]) -> None:
    """No object is called as variables are: it would be one wherever it stands in a condition."""
    for part, kind in (("domain", ":constants"), ("problem", ":objects")):
        for section in sections(blocks[part], kind):
            for word in section[1:]:
                if isinstance(word, str) and word.startswith("?"):
                    raise ReadingError(
                        f"an object is called {shown(word)}, as only variables are; take a name "
                        "without '?'",
                        part,
                        line_of(word),
                    )


def _function_names(domain: Block) -> set[str]:
    return set(map(str, _declared(domain, ":functions")))


def _declared(domain: Block, kind: str) -> list[Any]:
    """The names, with their lines, that blocks of a section of a domain begin with."""
    return [
        each[0]
        for section in sections(domain, kind)
        for each in section
        if isinstance(each, Block) and each and isinstance(each[0], str)
    ]


def _not_understood(error: Exception) -> ReadingError:
    """What the parser broke at, where it has no words for it."""
    part, line = _innermost(error.__traceback__)
    layers: list[str] = []
    item: object = None
    trace = error.__traceback__
    while trace is not None:
        names = trace.tb_frame.f_locals
        context = names.get("context")
        if isinstance(context, _Context):
            layers = list(context._traceback)
        for name in ("entry", "alist", "fact", "exp", "item"):
            item = names[name] if line_of(names.get(name)) is not None else item
        trace = trace.tb_next
    forall = misplaced_forall(item) if isinstance(error, AssertionError) else None
    if forall is not None:
        return ReadingError(f"{forall[0]}{_in(layers)}", part, forall[1] or line)
    if isinstance(error, RecursionError):
        message = "this is nested too deeply"
    else:
        message = "this cannot be read"
    message += f": {_shown(item)}" if item is not None else ""
    message += _in(layers) + "; a word stands where a block is expected, or the other way round"
    return ReadingError(message, part, line_of(item) or line)


def _in(layers: list[str]) -> str:
    told = " / ".join(layer.removeprefix("Parsing ") for layer in layers[1:4])
    return f" [in {told}]" if told else ""


def _explained(error: _LocatedError, blocks: dict[str, Block]) -> ReadingError:
    if "duplicate object" in error.message:
        name = error.message.split(":")[1].split(",")[0].strip()
        part, line = _place_of(name, dict(reversed(blocks.items())))
        message = f"the object {shown(name)} is declared twice; expected it once"
        return ReadingError(message, part, line)
    message = " ".join(error.message.replace("Reason: ", "").split()).rstrip(".")
    remedy = ""
    if message.startswith("Type value") and isinstance(error.item, list):
        remedy = (
            "; declare a type above these in (:types …), such as 'truck van - vehicle', and name it"
        )
    if typed := mistyped(message, error.item):
        message = typed
    elif error.item is not None and not isinstance(error.item, ParseError):
        message += f": got {_shown(error.item)}"
    if error.syntax and not typed:
        message += f"; expected {error.syntax}"
    message += remedy + _in(error.layers) + _names_that_exist(error)
    part, line = _innermost(error.__traceback__)
    if "does not match the name specified" in error.message:
        part, line = _place_of(":domain", blocks)
    elif error.layers:
        part = "problem" if error.layers[0] == "Parsing problem" else "domain"
    elif "problem" in error.message:
        part = "problem"
    return ReadingError(message, part, line_of(error.item) or line)


def _shown(item: object) -> str:
    return shown(parsing_functions.lispify(item) if isinstance(item, list | str) else str(item))


def _names_that_exist(error: _LocatedError) -> str:
    """What may have been meant by an unknown name."""
    if not isinstance(error.item, str):
        return ""
    known: set[str] = set()
    trace = error.__traceback__
    while trace is not None:
        names = trace.tb_frame.f_locals
        if "Undefined predicate" in error.message:
            known = set(names.get("valid_predicate_names", known))
        elif "Undefined" in error.message:
            known = set(names.get("valid_term_names", known))
        elif "predicate name" in error.message:
            known = set(names.get("predicate_dict", known))
        trace = trace.tb_next
    names = sorted(str(name) for name in known if not str(name).startswith("|"))
    return suggestion_or_list(error.item, names) if names else ""


def _innermost(trace: TracebackType | None) -> tuple[str, int | None]:
    """The part and the line that the parser was reading when it gave up."""
    line, part = None, "domain"
    while trace is not None:
        frame = trace.tb_frame
        if frame.f_code.co_name == "parse_problem_pddl":
            part = "problem"
        for name in ("domain_pddl", "problem_pddl", "entry", "opt", "alist", "fact", "exp"):
            value = frame.f_locals.get(name)
            if isinstance(value, list) and frame.f_code.co_name != "parse_task":
                line = line_of(value) or line
        trace = trace.tb_next
    return part, line


def _quantified(condition: Any) -> Iterable[Any]:
    yield from getattr(condition, "parameters", ())
    for part in condition.parts:
        yield from _quantified(part)


def _check_types(task: Any, blocks: dict[str, Block]) -> None:
    """The translator fails late, or silently, where a type was never declared."""
    known = {kind.name for kind in task.types}
    known |= {kind.basetype_name for kind in task.types if kind.basetype_name}
    # A parent that is only ever named as a parent is a type too.
    declared = {kind.name for kind in task.types}
    _check_order({kind.name: kind.basetype_name for kind in task.types}, blocks)
    for name in sorted(known - declared):
        task.types.append(pddl.Type(name))
        task.types[-1].supertype_names = []
    typed: list[Any] = [*task.objects]
    for predicate in task.predicates:
        typed += predicate.arguments
    for action in task.actions:
        typed += [*action.parameters, *_quantified(action.precondition)]
        for effect in action.effects:
            typed += [*effect.parameters, *_quantified(effect.condition)]
    for function in task.functions:
        typed += function.arguments
    for axiom in task.axioms:
        typed += [*axiom.parameters, *_quantified(axiom.condition)]
    typed += _quantified(task.goal)
    for entry in typed:
        names = entry.type_name[1:] if isinstance(entry.type_name, list) else [entry.type_name]
        for name in names:
            if name not in known:
                part, line = _place_of(name, blocks)
                raise ReadingError(
                    f"the type {str(name)!r} of {str(entry.name)!r} is not declared"
                    + suggestion_or_list(name, known),
                    part,
                    line,
                )


def _check_order(parents: Mapping[str, str | None], blocks: dict[str, Block]) -> None:
    """No type is its own parent, nor its parents' parent: of such the translator makes anything."""
    for name in parents:
        way = [name]
        while (above := parents.get(way[-1])) is not None and above not in way:
            way.append(above)
        if above == name != "object":
            told = ", which is a ".join(repr(str(each)) for each in [*way[1:], name])
            part, line = _place_of(name, blocks)
            message = (
                f"the type {str(name)!r} is a kind of itself: it is a {told}; expected parents "
                "that lead to 'object'"
            )
            raise ReadingError(message, part, line)


def _check_derived(task: Any) -> None:
    """Derived facts follow from axioms; nothing else may make them true."""
    derived = {axiom.name for axiom in task.axioms}
    predicates = {predicate.name: predicate for predicate in task.predicates}
    for axiom in task.axioms:
        declared = predicates.get(axiom.name)
        if declared is None or len(declared.arguments) != len(axiom.parameters):
            raise ReadingError(
                f"the derived predicate {str(axiom.name)!r} is not declared with "
                f"{len(axiom.parameters)} arguments; expected it in (:predicates …)",
                "domain",
                line_of(axiom.name),
            )
        if any(isinstance(parameter.type_name, list) for parameter in axiom.parameters):
            raise ReadingError(
                f"the derived predicate {str(axiom.name)!r} has an argument of type 'either …'; "
                "expected a single type in (:derived …)",
                "domain",
                line_of(axiom.name),
            )
    for action in task.actions:
        for effect in action.effects:
            if effect.literal.predicate in derived:
                raise ReadingError(
                    f"the action {str(action.name)!r} changes the derived predicate "
                    f"{str(effect.literal.predicate)!r}; expected that only (:derived …) does",
                    "domain",
                    line_of(effect.literal.predicate) or line_of(action.name),
                )
    for fact in task.init:
        if isinstance(fact, pddl.Atom) and fact.predicate in derived:
            raise ReadingError(
                f"the initial state states the derived fact {str(fact.predicate)!r}; expected "
                "that it follows from (:derived …)",
                "problem",
                line_of(fact.predicate),
            )


def _check_names(task: Any, domain: Block) -> None:
    """Two actions or parameters of one name would be ambiguous.

    Actions are those of the text, as the translator drops the ones without an effect.
    """
    kinds = (":action", ":durative-action")
    written = (action[1] for kind in kinds for action in sections(domain, kind))
    _check_unique("actions", (name for name in written if isinstance(name, str)))
    for action in task.actions:
        _check_unique(
            f"parameters of the action {shown(action.name)}",
            (parameter.name for parameter in action.parameters),
        )


def _check_unique(what: str, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise ReadingError(
                f"there are two {what} of the name {shown(name)}; expected one of each",
                "domain",
                line_of(name),
            )
        seen.add(name)


def _place_of(word: str, blocks: dict[str, Block]) -> tuple[str, int | None]:
    """The part and the line in which a word stands: itself, where it was read, else the first one
    that is spelt so."""

    def search(item: object, *, itself: bool) -> int | None:
        if isinstance(item, list):
            lines = (search(each, itself=itself) for each in item)
            return next((line for line in lines if line is not None), None)
        return line_of(item) if (item is word if itself else item == word) else None

    for itself in (True, False):
        for part, block in blocks.items():
            line = search(block, itself=itself)
            if line is not None:
                return part, line
    return "domain", None
