"""A questions file to edit, with what to look at in it."""

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from tpvqa.drafting.actions import Actions
from tpvqa.drafting.clauses import Phrases
from tpvqa.drafting.facts import Facts, Said
from tpvqa.drafting.lexicon import HANDS
from tpvqa.drafting.numbers import numbers_section
from tpvqa.drafting.things import Label, Things
from tpvqa.pddl import Task
from tpvqa.pddl.whole import seen_predicates, whole_actions
from tpvqa.questions import fallback
from tpvqa.questions.template import Template

_FELT = ("free", "empty", "full", "busy", "clean", "available", "handempty", "handsfree")
LOOK = "LOOK"
"""What a person has to read and say better is marked by."""
LOOK_AT_ACTION = f"   # {LOOK}: the names tell little; say it in your own words"
_AGREEING = {"Is": "Are", "Does": "Do", "Has": "Have"}
_HEAD = """\
# Questions for the domain {domain}, drafted from its names. Read every line before a VLM does:
# - Is each question answered yes exactly if its fact is true, by who sees nothing but a picture?
# - Where there is a list, its first question is asked, and the others where the errors of the first
#   last: each is to ask the very same. `tpvqa vlm compare` tells which your VLM reads best.
# - What no picture can show belongs under never_asked, too; reasons keep the words of its question.
# `tpvqa questions` prints what comes of this file, `tpvqa check` what does not fit.
"""


@dataclass(frozen=True, slots=True)
class Words:
    """Words for single lines of a questions file.

    Attributes:
        questions: A question about each predicate that changes.
        actions: Each action as a command, and once it is done.
        unsure: The predicates and actions whose names tell too little, with what to mark them by.
    """

    questions: Mapping[str, str]
    actions: Mapping[str, tuple[str, str]]
    unsure: Mapping[str, str] = field(default_factory=dict)


def words(task: Task) -> Words:
    """Words that rely on no attribute of objects: to be put into a file that is there."""
    phrases = Phrases(Things(task), plain=True)
    facts, actions = Facts(phrases), Actions(phrases)
    said = {name: facts.said(name) for name in seen_predicates(task)}
    spoken = {schema.name: actions.said(schema) for schema in whole_actions(task)}
    marked = {name: _look(each) for name, each in said.items()}
    marked |= {name: LOOK_AT_ACTION for name, each in spoken.items() if each.unsure}
    return Words(
        {name: each.wordings[0] for name, each in said.items()},
        {name: (each.say, each.done) for name, each in spoken.items()},
        {name: look for name, look in marked.items() if look},
    )


def draft(task: Task) -> str:
    """A questions file for a task, in YAML with comments: to be read and edited by a person.

    Args:
        task: The task; its objects are named, too.
    """
    things = Things(task)
    phrases = Phrases(things)
    facts, actions = Facts(phrases), Actions(phrases)
    asked = seen_predicates(task)
    said = {name: facts.said(name) for name in asked}
    spoken = {schema.name: actions.said(schema) for schema in whole_actions(task)}
    name = task.domain_name
    domain = name if name.isprintable() else repr(name)  # YAML would not read it again
    lines = [_HEAD.format(domain=domain).rstrip(), "", "predicates:"]
    for name in asked:
        lines += _predicate(name, said[name])
    lines += [*numbers_section(task), "", "actions:"]
    for name, words in spoken.items():
        unsure = LOOK_AT_ACTION if words.unsure else ""
        done = words.done
        lines.append(f"  {_key(name)}: {{say: {_text(words.say)}, done: {_text(done)}}}{unsure}")
    lines += [*_words_of_things(things, phrases), *_never_asked(task, things, said)]
    return "\n".join(lines) + "\n"


def _key(name: str) -> str:
    """A name as a key of YAML; words that YAML takes for truth are quoted."""
    plain = name.replace("_", "").replace("-", "").isalnum() and not name[0].isdigit()
    special = name in ("on", "off", "yes", "no", "y", "n", "true", "false", "null", "~")
    return name if plain and not special and not name.startswith("-") else _text(name)


def _text(words: str) -> str:
    return json.dumps(words, ensure_ascii=False)


def _predicate(name: str, said: Said) -> Iterator[str]:
    first, *others = said.wordings
    look = _look(said)
    alike = [each for each in others if _names(each) == _names(first)]
    if said.unsure or not alike:
        yield f"  {_key(name)}: {_text(first)}{look}"
        return
    yield f"  {_key(name)}:{look}"
    for each in (first, *alike):
        yield f"    - {_text(each)}"


def _look(said: Said) -> str:
    if said.unsure:
        return f"   # {LOOK}: the name tells little; ask it in your own words"
    if said.unseen:
        return f"   # {LOOK}: does a picture show it? If not, it belongs under never_asked"
    return ""


def _names(wording: str) -> frozenset[str]:
    """The parameters that a wording names."""
    return frozenset(each.parameter for each in Template.parse(wording).placeholders())


# What things are called


def _words_of_things(things: Things, phrases: Phrases) -> list[str]:
    task, wanted = things.task, phrases.wanted
    defaults = {}
    if "the" in wanted:
        defaults["the"] = "the {name}"
    if "place" in wanted:
        defaults["place"] = f"{things.commonest_place()} the {{name}}"
    defaults |= {word: word for word in _AGREEING if word in wanted}
    own = {obj: _own(things, obj, defaults, phrases.places) for obj in task.objects}
    kinds: dict[str, dict[str, str]] = {}
    for kind in dict.fromkeys(task.objects.values()):
        members = [obj for obj, its in task.objects.items() if its == kind]
        shared = _shared([own[obj] for obj in members]) if kind != "object" else {}
        if shared:
            kinds[kind] = shared
            for obj in members:
                own[obj] = {key: said for key, said in own[obj].items() if key not in shared}
    lines: list[str] = []
    if defaults:
        lines += ["", "attributes:"]
        lines += [f"  {key}: {_text(said)}" for key, said in defaults.items()]
    if kinds:
        lines += ["", "types:"]
        lines += [f"  {_key(kind)}: {_attributes(said)}" for kind, said in kinds.items()]
    named = {obj: said for obj, said in own.items() if said}
    if named:
        lines += ["", "objects:   # what a VLM is to call them: what it would say of the picture"]
        lines += [f"  {_key(obj)}: {_attributes(said)}" for obj, said in named.items()]
    return lines


def _own(things: Things, obj: str, defaults: dict[str, str], places: set[str]) -> dict[str, str]:
    """What an object's attributes are where they differ from the defaults."""
    label = things.label(obj)
    found: dict[str, str] = {}
    if label.name != fallback.words_of(obj):
        found["name"] = label.name
    given = {"the": _the(label), "place": f"{things.place_of(obj)} {_the(label)}"}
    for key in ("the", "place"):
        spoken = key == "the" or obj in places
        if key in defaults and given[key] != defaults[key] and spoken:
            found[key] = given[key]
    if label.plural:
        found |= {word: _AGREEING[word] for word in _AGREEING if word in defaults}
    return found


def _the(label: Label) -> str:
    return "the {name}" if label.article else "{name}"


def _shared(own: list[dict[str, str]]) -> dict[str, str]:
    """What all objects of a type have, but for their names."""
    keys = [key for key in own[0] if key != "name"]
    return {key: own[0][key] for key in keys if all(each.get(key) == own[0][key] for each in own)}


def _attributes(said: dict[str, str]) -> str:
    if set(said) == {"name"}:
        return _text(said["name"])
    return "{" + ", ".join(f"{key}: {_text(words)}" for key, words in said.items()) + "}"


# What is never asked


def _never_asked(task: Task, things: Things, said: dict[str, Said]) -> Iterator[str]:
    patterns = list(_entries(task, things, said))
    static = [n for n in task.predicates if n not in task.fluents | task.derived]
    patterns += [(_form(task, n), "no action changes it") for n in static]
    if patterns:
        yield ""
        yield "never_asked:   # what no camera shows; add what yours does not"
    for fact, because in patterns:
        yield f"  - fact: {_text(fact)}"
        yield f"    because: {because}"
    if static:
        yield "# Where a fact that no action changes is in doubt, take it out above and name it:"
        yield f"# in_doubt: [{', '.join(_text(_form(task, name)) for name in static[:2])}]"


def _entries(task: Task, things: Things, said: dict[str, Said]) -> Iterable[tuple[str, str]]:
    for name, each in said.items():
        words = things.words(name)
        if each.opposite in said:
            yield _form(task, name), f"it is asked as {each.opposite}, which is its opposite"
        elif words[-1] in _FELT and words[0] in HANDS and _follows(task, name):
            yield _form(task, name), "what is held is asked about the things; a gripper may feel it"


def _follows(task: Task, predicate: str) -> bool:
    """Whether its facts follow from others: of a group with them exactly one holds."""
    return any(
        group.exactly_one and {predicate} < {atom.predicate for atom in group.atoms}
        for group in task.mutex_groups
    )


def _form(task: Task, predicate: str) -> str:
    """A predicate with its variables, as patterns are written."""
    return f"({' '.join((predicate, *task.predicate_variables[predicate]))})"
