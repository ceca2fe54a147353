"""What a domain asks for that Fast Downward does not know: said where it stands, with who could."""

from itertools import pairwise

from tpvqa.errors import shown, suggestion
from tpvqa.pddl.outside.engines import where_known
from tpvqa.pddl.worker.blocks import blocks, said, sections
from tpvqa.pddl.worker.lisp import Block, line_of

_KNOWN = frozenset(
    {":strips", ":adl", ":typing", ":negation", ":equality", ":negative-preconditions"}
    | {":disjunctive-preconditions", ":existential-preconditions", ":universal-preconditions"}
    | {":quantified-preconditions", ":conditional-effects", ":derived-predicates", ":action-costs"}
    | {":fluents", ":numeric-fluents", ":durative-actions", ":duration-inequalities"}
)

_FEATURES = {
    **dict.fromkeys((":continuous-effects", ":timed-initial-literals"), "time"),
    **dict.fromkeys((":time", ":processes", ":events"), "processes"),
    ":object-fluents": "objects",
    **dict.fromkeys((":preferences", ":constraints"), "preferences"),
    **dict.fromkeys((":probabilistic-effects", ":non-deterministic"), "chance"),
    **dict.fromkeys((":rewards", ":mdp"), "chance"),
    **dict.fromkeys((":multi-agent", ":unfactored-privacy", ":factored-privacy"), "agents"),
    **dict.fromkeys((":hierarchy", ":method-preconditions"), "hierarchy"),
}
_MEANS = {
    "time": "facts that change by the clock, or numbers that do while an action lasts",
    "processes": "processes and events",
    "objects": "functions whose values are objects",
    "preferences": "preferences and constraints on the way to the goal",
    "chance": "effects by chance",
    "agents": "several agents",
    "hierarchy": "hierarchies of tasks",
}
_HEADS = {
    **dict.fromkeys((":process", ":event"), "processes"),
    **dict.fromkeys(("preference", ":constraints"), "preferences"),
    **dict.fromkeys(("probabilistic", "oneof"), "chance"),
    **dict.fromkeys((":task", ":method", ":htn"), "hierarchy"),
}
"""What begins a block that only such a domain has, unless it is the name of a predicate."""


def beyond(domain: Block) -> tuple[str, int | None] | None:
    """The first thing that Fast Downward does not know, in words, and its line; None for nothing.

    Args:
        domain: The domain.
    """
    declared: tuple[str, int | None] | None = None
    for section in domain:
        if isinstance(section, Block) and section[:1] == [":requirements"]:
            for word in section[1:]:
                if isinstance(word, str) and word.startswith(":") and word not in _KNOWN:
                    declared = declared or (_about(str(word)), line_of(word))
    if declared is not None:
        return declared
    names = _predicates(domain)
    for block in blocks(domain):
        head = block[0] if block else None
        if isinstance(head, str) and head in _HEADS and str(head) not in names:
            feature = _HEADS[str(head)]
            return f"({head} …) is about {_MEANS[feature]}, {_who(feature)}", line_of(head)
    return None


def undeclared(domain: Block, problem: Block) -> tuple[str, str, int | None] | None:
    """What needs a requirement that is not known here, whether it is declared or not.

    Args:
        domain: The domain.
        problem: The problem.

    Returns:
        What is wrong, in which part and line; None for nothing.
    """
    for section in sections(domain, ":functions"):
        for before, kind in pairwise(section):
            if before == "-" and kind != "number":
                return _needs(
                    f"a function of the type {said(kind)} instead of '- number'",
                    ":object-fluents",
                    "domain",
                    kind,
                )
    for part in problem:
        if not isinstance(part, Block) or not part:
            continue
        if part[0] == ":constraints":
            return _needs("(:constraints …)", ":constraints", "problem", part[0])
        if part[0] == ":htn":
            return _needs("(:htn …)", ":hierarchy", "problem", part[0])
        if part[0] in (":goal", ":metric"):
            for block in blocks(part):
                if block[:1] in (["preference"], ["is-violated"]) and str(
                    block[0]
                ) not in _predicates(domain):
                    return _needs(f"({block[0]} …)", ":preferences", "problem", block[0])
        if part[0] == ":init":
            for fact in part[1:]:
                if isinstance(fact, Block) and _is_timed(fact):
                    what = f"{said(fact)}, a timed initial literal,"
                    return _needs(what, ":timed-initial-literals", "problem", fact[0])
    return None


def _is_timed(fact: Block) -> bool:
    """Whether it is a fact that comes true later: `(at 5 (lit))`."""
    if len(fact) != 3 or fact[0] != "at":
        return False
    return isinstance(fact[1], str) and isinstance(fact[2], Block) and fact[1][:1].isdigit()


def _needs(what: str, requirement: str, part: str, word: object) -> tuple[str, str, int | None]:
    feature = _FEATURES[requirement]
    message = f"{what} needs the requirement {requirement}, {_MEANS[feature]}, {_who(feature)}"
    return message, part, line_of(word)


def _about(requirement: str) -> str:
    feature = _FEATURES.get(requirement)
    if feature is None:
        near = suggestion(requirement, (*_KNOWN, *_FEATURES), near_by=0.8)
        known = ", ".join(sorted(_KNOWN))
        return f"the requirement {shown(requirement)} is not known{near} Known: {known}"
    return f"the requirement {requirement} is about {_MEANS[feature]}, {_who(feature)}"


def _who(feature: str) -> str:
    return f"which Fast Downward does not know. {where_known(feature)}"


def _predicates(domain: Block) -> set[str]:
    return {
        str(each[0])
        for section in domain
        if isinstance(section, Block) and section[:1] == [":predicates"]
        for each in section
        if isinstance(each, Block) and each
    }
