"""What a domain asks for that Fast Downward does not know: said where it stands, with who could."""

from tpvqa.errors import shown, suggestion
from tpvqa.pddl.outside.engines import where_known
from tpvqa.pddl.worker.blocks import blocks
from tpvqa.pddl.worker.lisp import Block, line_of

_KNOWN = frozenset(
    {":strips", ":adl", ":typing", ":negation", ":equality", ":negative-preconditions"}
    | {":disjunctive-preconditions", ":existential-preconditions", ":universal-preconditions"}
    | {":quantified-preconditions", ":conditional-effects", ":derived-predicates", ":action-costs"}
)

_FEATURES = {
    **dict.fromkeys((":durative-actions", ":duration-inequalities"), "time"),
    **dict.fromkeys((":continuous-effects", ":timed-initial-literals"), "time"),
    **dict.fromkeys((":time", ":processes", ":events"), "processes"),
    ":object-fluents": "objects",
    **dict.fromkeys((":preferences", ":constraints"), "preferences"),
    **dict.fromkeys((":probabilistic-effects", ":rewards", ":mdp"), "chance"),
    **dict.fromkeys((":multi-agent", ":unfactored-privacy", ":factored-privacy"), "agents"),
    **dict.fromkeys((":hierarchy", ":method-preconditions"), "hierarchy"),
}
_MEANS = {
    "time": "actions that last",
    "processes": "processes and events",
    "objects": "functions whose values are objects",
    "preferences": "preferences and constraints on the way to the goal",
    "chance": "effects by chance",
    "agents": "several agents",
    "hierarchy": "hierarchies of tasks",
}
_HEADS = {
    **dict.fromkeys((":durative-action",), "time"),
    **dict.fromkeys((":process", ":event"), "processes"),
    **dict.fromkeys(("preference", ":constraints"), "preferences"),
    **dict.fromkeys(("probabilistic",), "chance"),
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


def _about(requirement: str) -> str:
    feature = _FEATURES.get(requirement)
    if feature is None:
        near = suggestion(requirement, (*_KNOWN, *_FEATURES))
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
