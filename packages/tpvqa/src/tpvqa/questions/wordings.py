"""The questions file: reading it, and seeing that it fits the domain."""

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, TypeAlias, TypeVar

from tpvqa.errors import PDDLError, QuestionsError, suggestion
from tpvqa.pddl import Task
from tpvqa.questions.lasting import parts_of
from tpvqa.questions.never import NeverAsked
from tpvqa.questions.numbers import COMPARISON, NUMBER, lacking, parameters_of_functions
from tpvqa.questions.question import ActionWay, Way
from tpvqa.questions.template import Template
from tpvqa.yaml_places import Place, read_yaml

WAYS: Mapping[ActionWay, str] = {
    Way.POSSIBLE: "Is it possible to {action} here?",
    Way.SUCCESSFUL: "Was {action} successful?",
    Way.DID: "Did the robot successfully {action}?",
}
"""How a whole action is asked about, in the words of the paper and of the works it cites."""

Wording: TypeAlias = Literal["usual", "paper"]
"""How an action is said in questions about it as a whole: "wash the plate", or without articles as
in the paper, "wash plate"."""

T = TypeVar("T")
_OWN_ATTRIBUTES = ("name", "article")  # that every object has


@dataclass(frozen=True, slots=True)
class Wordings:
    """What a questions file says; whatever it does not say is missing here.

    Attributes:
        predicates: The question about each predicate, in the first of its wordings.
        others: Its other wordings, where there are any.
        say: How each action is said, as a command.
        done: How each action is said once it is done.
        attributes: The default of each attribute of objects.
        of_types: Attributes by type.
        of_objects: Attributes by object.
        never_asked: What no camera shows.
        in_doubt: What is asked although no action changes it.
        still_shown: What a picture may show though it does not hold any more.
        ways: How a whole action is asked about.
        notices: What the reader of the file should know.
        numbers: The question about each number, see `tpvqa.questions.numbers`.
    """

    predicates: Mapping[str, Template] = field(default_factory=dict)
    others: Mapping[str, Sequence[Template]] = field(default_factory=dict)
    say: Mapping[str, Template] = field(default_factory=dict)
    done: Mapping[str, Template] = field(default_factory=dict)
    attributes: Mapping[str, Template] = field(default_factory=dict)
    of_types: Mapping[str, Mapping[str, Template]] = field(default_factory=dict)
    of_objects: Mapping[str, Mapping[str, Template]] = field(default_factory=dict)
    never_asked: Sequence[NeverAsked] = ()
    in_doubt: Sequence[NeverAsked] = ()
    still_shown: Sequence[NeverAsked] = ()
    ways: Mapping[ActionWay, Template] = field(
        default_factory=lambda: {way: Template.parse(text) for way, text in WAYS.items()}
    )
    notices: Sequence[str] = ()
    numbers: Mapping[str, Template] = field(default_factory=dict)


def parameters_of(task: Task) -> tuple[Mapping[str, list[str]], Mapping[str, list[str]]]:
    """The parameters of each predicate and of each action, without their question marks."""
    predicates = {
        name: [variable.lstrip("?") for variable in variables]
        for name, variables in task.predicate_variables.items()
    }
    actions = {
        schema.name: [parameter.name.lstrip("?") for parameter in schema.parameters]
        for schema in task.schemas
    }
    if task.lasting is not None:
        for name, variables in task.lasting.variables.items():
            actions[name] = [variable.lstrip("?") for variable in variables]
    return predicates, actions


def read_wordings(path: Path, task: Task, *, wrong: list[QuestionsError] | None = None) -> Wordings:
    """Read a questions file.

    Args:
        path: The file.
        task: The task that it is about.
        wrong: Where given, what is wrong with single entries is put into it, and the entries are
            left out: for who wants to know all that is wrong.

    Raises:
        QuestionsError: It cannot be read, or does not fit the domain; with file and line.
    """
    root = read_yaml(path, QuestionsError)
    if root is None:
        return Wordings()
    sections = root.sections(
        "predicates",
        "actions",
        "attributes",
        "types",
        "objects",
        "never_asked",
        "in_doubt",
        "still_shown",
        "ways",
        "numbers",
    )
    predicates, actions = parameters_of(task)
    functions = parameters_of_functions(task)
    attributes = _attributes(sections.get("attributes"), [], of_objects=True)
    known = [*_OWN_ATTRIBUTES, *attributes]
    kept = _Kept(wrong)

    def named(
        section: str, names: Collection[str], kind: str, read: Callable[[str, Place], T]
    ) -> dict[str, T]:
        """The entries of a section whose keys are names of the domain."""
        found: dict[str, T] = {}
        for name, key, value in _entries(sections.get(section)):
            with kept:
                _check_name(name, key, names, kind)
                found[name] = read(name, value)
        return found

    def patterns(section: str, read: Callable[[Place, Task], T]) -> list[T]:
        found: list[T] = []
        for item in _items(sections.get(section)):
            with kept:
                found.append(read(item, task))
        return found

    said = named("actions", actions, "action", lambda name, it: _said(it, actions[name], known))
    asked = named(
        "predicates",
        predicates,
        "predicate",
        lambda name, it: _in_turn(it, predicates[name], known),
    )
    of_objects, notices = {}, []
    for name, place, value in _entries(sections.get("objects")):
        if name in task.objects:
            with kept:
                of_objects[name] = _own(value, known)
        else:
            near = suggestion(name, task.objects)
            notices.append(f"{place.file}:{place.line}: this problem has no object {name!r}{near}")
    return Wordings(
        predicates={name: each[0] for name, each in asked.items()},
        others={name: each[1:] for name, each in asked.items() if len(each) > 1},
        say={name: parts["say"] for name, parts in said.items() if "say" in parts},
        done={name: parts["done"] for name, parts in said.items() if "done" in parts},
        attributes=attributes,
        of_types=named("types", task.types, "type", lambda _, it: _own(it, known)),
        of_objects=of_objects,
        never_asked=patterns("never_asked", _never_asked),
        in_doubt=patterns("in_doubt", _pattern),
        still_shown=patterns("still_shown", _still_shown),
        ways=_ways(sections.get("ways")),
        notices=notices,
        numbers=named(
            "numbers", functions, "number", lambda name, it: _of_number(it, functions[name], known)
        ),
    )


class _Kept(AbstractContextManager[None]):
    """Keeps what is wrong with an entry, or lets it be raised where nobody collects it."""

    def __init__(self, wrong: list[QuestionsError] | None):
        self._wrong = wrong

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> bool:
        if self._wrong is None or not isinstance(error, QuestionsError):
            return False
        self._wrong.append(error)
        return True


def _said(place: Place, parameters: Sequence[str], known: Sequence[str]) -> dict[str, Template]:
    parts = place.sections("say", "done")
    return {key: _template(part, parameters, known) for key, part in parts.items()}


def _entries(place: Place | None) -> list[tuple[str, Place, Place]]:
    return [] if place is None else place.entries()


def _items(place: Place | None) -> list[Place]:
    return [] if place is None else list(place.items())


def _check_name(name: str, key: Place, known: Collection[str], kind: str) -> None:
    if name not in known:
        raise key.wrong(f"the domain has no {kind} {name!r}{suggestion(name, known)}")


def _in_turn(place: Place, parameters: Sequence[str], known: Sequence[str]) -> list[Template]:
    """The wordings of a question: a text, or a list of them, the first one first."""
    found: dict[str, Template] = {}
    for item in place.items() if place.is_list() else [place]:
        template = _template(item, parameters, known)
        first = next(iter(found.values()), template)
        if str(template) in found:
            raise item.wrong("this wording is given twice; leave it out once")
        said, names = ({each.parameter for each in t.placeholders()} for t in (template, first))
        if said != names:
            which = ", ".join(f"{{{name}}}" for name in sorted(said ^ names))
            raise item.wrong(
                f"every wording of a question names the same things, and only one of this and "
                f"the first names {which}"
            )
        found[str(template)] = template
    if not found:
        raise place.wrong("expected a question, or a list of its wordings, found an empty list")
    return list(found.values())


def _template(place: Place, parameters: Sequence[str], attributes: Sequence[str]) -> Template:
    try:
        template = Template.parse(place.text())
    except ValueError as error:
        raise place.wrong(str(error)) from None
    for placeholder in template.placeholders():
        if placeholder.parameter not in parameters:
            known = ", ".join(f"{{{name}}}" for name in parameters) or "none"
            raise place.wrong(
                f"{placeholder} stands for none of the parameters{_hint(placeholder, parameters)} "
                f"The placeholders here: {known}."
            )
        if placeholder.attribute not in attributes:
            raise place.wrong(
                f"{placeholder}: objects have no attribute {placeholder.attribute!r}"
                f"{suggestion(placeholder.attribute, attributes)} Give its default "
                f"under 'attributes'. Known: {', '.join(attributes)}."
            )
    return template


def _of_number(place: Place, parameters: Sequence[str], attributes: Sequence[str]) -> Template:
    template = _template(place, parameters, attributes)
    for word in lacking(template):
        raise place.wrong(
            f"a question about a number has to speak of {{{COMPARISON}}} and {{{NUMBER}}}; "
            f"{{{word}}} is missing"
        )
    return template


def _hint(placeholder: object, parameters: Sequence[str]) -> str:
    return suggestion(str(placeholder), [f"{{{name}}}" for name in parameters])


def _attributes(
    place: Place | None, known: Sequence[str], *, of_objects: bool = False
) -> dict[str, Template]:
    found: dict[str, Template] = {}
    for name, key, value in _entries(place):
        if of_objects and name == "name":
            raise key.wrong(
                "'name' is each object's own: its PDDL name in words, unless 'objects' or 'types' "
                "gives another"
            )
        if not of_objects and name not in known:
            raise key.wrong(
                f"objects have no attribute {name!r}{suggestion(name, known)} Give its "
                f"default under 'attributes'. Known: {', '.join(known)}."
            )
        found[name] = _template(value, [] if name == "name" else ["name"], ["name"])
    return found


def _own(place: Place, known: Sequence[str]) -> dict[str, Template]:
    """The attributes of an object or type; a text alone is its name."""
    if place.is_text():
        return {"name": _template(place, [], [])}
    return _attributes(place, known)


def _ways(place: Place | None) -> dict[ActionWay, Template]:
    ways = {way: Template.parse(text) for way, text in WAYS.items()}
    if place is None:
        return ways
    by_name = {way.value: way for way in WAYS}
    for name, value in place.sections(*by_name).items():
        ways[by_name[name]] = _template(value, ["action"], ["name"])
    return ways


def _pattern(place: Place, task: Task) -> NeverAsked:
    try:
        return NeverAsked.parse(place.text(), task)
    except PDDLError as error:
        raise place.wrong(error.message) from None


def _still_shown(place: Place, task: Task) -> NeverAsked:
    pattern = _pattern(place, task)
    if pattern.positive is False:
        raise place.wrong(
            f"name the fact itself that is still shown, without 'not': {pattern.fact}"
        )
    return pattern


def _never_asked(place: Place, task: Task) -> NeverAsked:
    parts = place.sections("fact", "in", "because")
    if "fact" not in parts:
        raise place.wrong("an entry needs 'fact', e.g. fact: \"(free ?h)\"")
    pattern = _pattern(parts["fact"], task)
    names = [*parameters_of(task)[1]]
    actions: list[str] = []
    for item in parts["in"].texts() if "in" in parts else []:
        name = item.text().lower()
        if name not in names:
            raise item.wrong(f"the domain has no action {name!r}{suggestion(name, names)}")
        actions += parts_of(task, name)
    because = parts["because"].text() if "because" in parts else ""
    return replace(pattern, actions=frozenset(actions), because=because)
