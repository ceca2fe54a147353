"""What could be brought about if nothing were ever undone, told quickly of many states."""

from collections.abc import Iterable, Iterator

Needs = tuple[int, int]
"""What has to hold and what must not, as bits."""
Way = tuple[Needs, int, int]
"""What something needs, what it makes true and what false."""
PROOFS = 64
"""How many proofs are kept of one literal, and how many states of what cannot be reached."""
LOOKED_AT = 60
"""How many literals are looked at for proofs in one state before all is gone through."""


class Relaxation:
    """The delete relaxation, a literal and its contrary each by itself.

    To hold more of them never leads less far. So what was enough for a literal in one state is
    kept, and is mostly enough in the next one. Where it is not, a proof is looked for backwards
    from the literal; all ways are gone through only where that finds none.

    Args:
        ways: They, from the beginning.
    """

    def __init__(self, ways: Iterable[Way]):
        self._ways = list(ways)
        self._leading: dict[Needs, list[Needs]] = {}
        for needs, add, delete in self._ways:
            for literal in literals_of((add, delete)):
                self._leading.setdefault(literal, []).append(needs)
        self._last: dict[Needs, Needs] = {}
        self._enough: dict[Needs, list[Needs]] = {}
        self._reached: list[Needs] = []

    def at_once(self, true: int, literal: Needs) -> bool:
        """Whether one way makes a literal true.

        Args:
            true: What holds, as bits.
            literal: It.
        """
        need, bar = self._last.get(literal, literal)
        if not (need & ~true or bar & true):  # the one of the last time
            return True
        for needs in self._leading.get(literal, ()):
            if not (needs[0] & ~true or needs[1] & true):
                self._last[literal] = needs
                return True
        return False

    def reaches(self, true: int, goal: Needs) -> bool:
        """Whether a goal is reached.

        Args:
            true: What holds at first, as bits.
            goal: What is asked for.
        """
        if any(not (true & ~most or ~true & ~least) for most, least in self._reached):
            return False
        return self.proves(true, goal) or self._spread(true, goal)

    def proves(self, true: int, parts: Needs) -> bool:
        """Whether proofs of some literals are found; they may be reached where none is.

        Args:
            true: What holds at first, as bits.
            parts: The literals.
        """
        proof = _Proof(self._leading, true)
        return all(self._proved(true, part, proof) for part in literals_of(parts))

    def _proved(self, true: int, part: Needs, proof: "_Proof") -> bool:
        """Whether there is a proof for a literal; it is kept, those used last first."""
        known = self._enough.setdefault(part, [])
        for place, (need, bar) in enumerate(known):
            if not (need & ~true or bar & true):
                if place:
                    known.insert(0, known.pop(place))
                return True
        found = proof.of(part)
        if found is not None:
            known.insert(0, found)
            del known[PROOFS:]
        return found is not None

    def _spread(self, true: int, goal: Needs) -> bool:
        """Whether a goal is reached, by all that can be brought about."""
        waiting, false, before = self._ways, ~true, (-1, -1)
        while goal[0] & ~true or goal[1] & ~false:
            if before == (true, false):
                self._reached = [before, *self._reached[: PROOFS - 1]]
                return False
            before, left = (true, false), []
            for each in waiting:
                (need, bar), add, delete = each
                if need & ~true or bar & ~false:
                    left.append(each)
                else:
                    true, false = true | add, false | delete
            waiting = left
        return True


class _Proof:
    """How literals are reached from one state, looked for backwards."""

    def __init__(self, leading: dict[Needs, list[Needs]], true: int):
        self._leading, self._true = leading, true
        self._known: dict[Needs, Needs] = {}
        self._under_way = set[Needs]()
        self._left = LOOKED_AT

    def of(self, literal: Needs) -> Needs | None:
        """What of the state is enough for a literal; None where none was found."""
        need, bar = literal
        if not (need & ~self._true or bar & self._true):
            return literal
        if literal in self._known:
            return self._known[literal]
        self._left -= 1
        if literal in self._under_way or self._left < 0:
            return None
        self._under_way.add(literal)
        found = self._by_a_way(self._leading.get(literal, []))
        self._under_way.discard(literal)
        if found is not None:
            self._known[literal] = found
        return found

    def _by_a_way(self, ways: list[Needs]) -> Needs | None:
        """What is enough for one of some ways, those that lack little first; the one that is found
        is moved to the front, as it is likely to serve again."""
        for needs in self._nearest_first(ways):
            found = self._all(needs)
            if found is not None:
                ways.remove(needs)
                ways.insert(0, needs)
                return found
        return None

    def _nearest_first(self, ways: list[Needs]) -> Iterator[Needs]:
        far = list[Needs]()
        for needs in ways:
            need, bar = needs[0] & ~self._true, needs[1] & self._true
            if need.bit_count() + bar.bit_count() <= 1:
                yield needs
            else:
                far.append(needs)
        yield from far

    def _all(self, needs: Needs) -> Needs | None:
        need, bar = needs[0] & self._true, needs[1] & ~self._true
        for part in literals_of((needs[0] & ~self._true, needs[1] & self._true)):
            found = self.of(part)
            if found is None:
                return None
            need, bar = need | found[0], bar | found[1]
        return need, bar


def literals_of(needs: Needs) -> Iterator[Needs]:
    """What is needed, one by one."""
    for positive, bits in zip((True, False), needs, strict=True):
        while bits:
            lowest = bits & -bits
            yield (lowest, 0) if positive else (0, lowest)
            bits ^= lowest
