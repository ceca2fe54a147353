"""What is in a place or a hand that its predicate names: on-table(x), in-hand(x)."""

from collections.abc import Iterator

from tpvqa.drafting import lexicon
from tpvqa.drafting.clauses import ROBOT, Clause, Noun
from tpvqa.drafting.facts_tables import SAME


def there(words: list[str], first: Noun) -> Iterator[Clause]:
    """Clauses of what is in a place that the name says: on-table(x), in-lift(trolley).

    Args:
        words: A preposition and the place.
        first: What is there.
    """
    preposition, *named = words
    named = named[1:] if named[0] in ("a", "an", "the") and named[1:] else named  # in_the_air
    what = " ".join(named)
    if named[-1] in lexicon.HANDS:
        yield from in_hand(first, what, ROBOT)
    elif what in lexicon.BARE:
        yield Clause("is", first, f"{preposition} {what}")
    else:
        yield Clause("is", first, f"{preposition} the {what}")
        if preposition in SAME and named[-1] not in lexicon.ADJECTIVES:
            yield Clause("is", first, f"{SAME[preposition]} the {what}")


def in_hand(first: Noun, hand: str, holder: Noun) -> Iterator[Clause]:
    """Clauses of what is in a hand: in-hand(x), in-left-hand(x, robot)."""
    yield Clause("is", first, f"in {holder.said}'s {hand}")
    yield Clause("is", holder, f"holding {first.said}")
