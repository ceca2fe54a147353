"""Random domains with conditional effects and a derived predicate, without parameters."""

from hypothesis import strategies as st

from tpvqa.pddl import Task, task_from_text

_FACTS = ("(here a)", "(here b)", "(here c)", "(full)", "(locked)")
_FACT = st.sampled_from(_FACTS)


def _literal(facts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.builds(lambda fact, holds: fact if holds else f"(not {fact})", facts, st.booleans())


_LITERAL = _literal(_FACT)


def _all(parts: list[str]) -> str:
    return f"(and {' '.join(parts)})"


_CONDITION = st.lists(_LITERAL, max_size=2).map(_all)
_DERIVED = st.lists(_literal(st.sampled_from((*_FACTS, "(seen)"))), max_size=2).map(_all)
_RULE = st.lists(_LITERAL, min_size=1, max_size=2).map(_all)
_EFFECT = st.one_of(
    _LITERAL,
    st.builds("(when {} {})".format, _CONDITION, _LITERAL),
    st.builds("(when {0} (and {0} (not {0}) {1}))".format, _FACT, _LITERAL),
    # One goes, another comes: so that there is a group to find more often than by chance.
    st.builds("(when {0} (and (not {0}) {1}))".format, _FACT, _FACT),
)


def _action(needed: st.SearchStrategy[str]) -> st.SearchStrategy[tuple[str, str]]:
    return st.tuples(needed, st.lists(_EFFECT, min_size=1, max_size=4).map(_all))


@st.composite
def tasks(draw: st.DrawFn, *, derived: bool = False, goal: str = "(full)") -> Task:
    """Tasks with a few actions over five facts, and where wished one that follows from others."""
    actions = draw(st.lists(_action(_DERIVED if derived else _CONDITION), min_size=1, max_size=4))
    rule = f"(:derived (seen) {draw(_RULE)})" if derived else ""
    init = draw(st.sets(_FACT, max_size=3))
    written = "".join(
        f"(:action a{number} :parameters () :precondition {needed} :effect {effect})"
        for number, (needed, effect) in enumerate(actions)
    )
    return task_from_text(
        f"""(define (domain d) (:types place) (:constants a b c - place)
        (:predicates (here ?p - place) (full) (locked) (seen))
        {rule} {written})""",
        f"(define (problem p) (:domain d) (:init {' '.join(sorted(init))}) (:goal {goal}))",
    )
