"""Two PDDL texts → the translator's task, and errors that say where and what was expected."""

from collections.abc import Iterable
from types import TracebackType
from typing import Any

from fast_downward.translate import pddl
from fast_downward.translate.pddl_parser import parsing_functions
from fast_downward.translate.pddl_parser.parse_error import ParseError

from tpvqa.errors import suggestion_or_list
from tpvqa.pddl.worker.lisp import Block, LispError, line_of, read_block


class ReadingError(Exception):
    """PDDL that cannot be read.

    Args:
        message: What is wrong and what was expected.
        part: "domain" or "problem".
        line: The line, where known.
    """

    def __init__(self, message: str, part: str, line: int | None):
        super().__init__(message)
        self.message, self.part, self.line = message, part, line


class _LocatedError(ParseError):  # type: ignore[misc]
    def __init__(self, message: str, layers: list[str], item: object, syntax: str | None):
        super().__init__(message)
        self.message, self.layers, self.item, self.syntax = message, layers, item, syntax


class _Context(parsing_functions.Context):  # type: ignore[misc]
    """The translator's parsing context, which also remembers the object that is wrong."""

    def error(self, message: str, item: object = None, syntax: str | None = None) -> None:
        raise _LocatedError(message, list(self._traceback), item, syntax)


parsing_functions.Context = _Context


def read(domain_text: str, problem_text: str) -> Any:
    """Parse a domain and a problem.

    Returns:
        The translator's task, not normalised: conditions and effects as the author wrote them.

    Raises:
        ReadingError: Something in them is wrong.
    """
    blocks = {}
    for part, text in (("domain", domain_text), ("problem", problem_text)):
        try:
            blocks[part] = read_block(text)
        except LispError as error:
            raise ReadingError(error.message, part, error.line) from None
    try:
        task = parsing_functions.parse_task(blocks["domain"], blocks["problem"])
    except _LocatedError as error:
        raise _explained(error, blocks) from None
    except (ParseError, ValueError) as error:
        raise ReadingError(str(error), "domain", None) from None
    except RecursionError:
        raise ReadingError("the parentheses are nested too deeply", "domain", None) from None
    except (AssertionError, AttributeError, IndexError, KeyError, TypeError) as error:
        part, line = _innermost(error.__traceback__)
        raise ReadingError(
            f"the translator cannot make sense of this definition ({type(error).__name__} {error})",
            part,
            line,
        ) from None
    _check_types(task, blocks)
    _check_derived(task)
    _check_names(task)
    _check_costs(task)
    return task


def _explained(error: _LocatedError, blocks: dict[str, Block]) -> ReadingError:
    if "duplicate object" in error.message:
        name = error.message.split(":")[1].split(",")[0].strip()
        part, line = _place_of(name, dict(reversed(blocks.items())))
        message = f"the object {name!r} is declared twice; expected it once"
        return ReadingError(message, part, line)
    layers = " / ".join(layer.removeprefix("Parsing ") for layer in error.layers[1:4])
    message = " ".join(error.message.replace("Reason: ", "").split()).rstrip(".")
    if error.item is not None and not isinstance(error.item, ParseError):
        message += f": got {_shown(error.item)}"
    if error.syntax:
        message += f"; expected {error.syntax}"
    if layers:
        message += f" [in {layers}]"
    message += _names_that_exist(error)
    part, line = _innermost(error.__traceback__)
    if "does not match the name specified" in error.message:
        part, line = _place_of(":domain", blocks)
    elif error.layers:
        part = "problem" if error.layers[0] == "Parsing problem" else "domain"
    elif "problem" in error.message:
        part = "problem"
    return ReadingError(message, part, line_of(error.item) or line)


def _shown(item: object) -> str:
    text = parsing_functions.lispify(item) if isinstance(item, list | str) else str(item)
    return repr(text if len(text) <= 80 else text[:77] + "…")


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
    names = sorted(str(name) for name in known)
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
                    line_of(name) or line,
                )


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


def _check_names(task: Any) -> None:
    """Two actions of one name would make a plan ambiguous."""
    seen: set[str] = set()
    for action in task.actions:
        if action.name in seen:
            raise ReadingError(
                f"there are two actions of the name {str(action.name)!r}; expected one of each",
                "domain",
                line_of(action.name),
            )
        seen.add(action.name)


def _check_costs(task: Any) -> None:
    """The translator does not compare how functions are used with how they are given values."""
    things = {thing.name for thing in task.objects}
    for action in task.actions:
        called = action.cost.expression if action.cost else None
        if not isinstance(called, pddl.PrimitiveNumericExpression):
            continue
        known = things | {parameter.name for parameter in action.parameters}
        for word in called.args:
            if word not in known:
                raise ReadingError(
                    f"the cost of the action {str(action.name)!r} speaks of {str(word)!r}; "
                    "expected one of its parameters or an object",
                    "domain",
                    line_of(word),
                )
        for fact in task.init:
            if not isinstance(fact, pddl.Assign) or fact.fluent.symbol != called.symbol:
                continue
            if len(fact.fluent.args) != len(called.args):
                raise ReadingError(
                    f"the function {str(called.symbol)!r} has {len(fact.fluent.args)} arguments "
                    f"here, but {len(called.args)} in the cost of the action {str(action.name)!r}",
                    "problem",
                    line_of(fact.fluent.symbol),
                )


def _place_of(word: str, blocks: dict[str, Block]) -> tuple[str, int | None]:
    """The part and the line in which a word first stands."""

    def search(item: object) -> int | None:
        if isinstance(item, list):
            return next((line for line in map(search, item) if line is not None), None)
        return line_of(item) if item == word else None

    for part, block in blocks.items():
        line = search(block)
        if line is not None:
            return part, line
    return "domain", None
