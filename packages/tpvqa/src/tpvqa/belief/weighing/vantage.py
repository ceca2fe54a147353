"""From where facts are shown: what can be asked here, and what *cannot see* tells of the place."""

from collections.abc import Mapping, Sequence
from math import prod

from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import Showing
from tpvqa.belief.filtering.first import Prior
from tpvqa.pddl import Atom
from tpvqa.vlm import Reply

OUT_OF_SIGHT = 0.1
"""A fact that is shown here with less, of where the robot most probably is, is not asked about."""
SHOWN, ELSEWHERE = (9.0, 1.0), (3.0, 7.0)
"""As how many questions with and without an answer it is known, before the first, how often one
finds an answer where its fact is shown, and elsewhere."""


class Vantage:
    """Knows from where facts are shown, as a world file says.

    A question finds an answer more often where its fact is shown than elsewhere. How often is
    learned of every question that was answered with a word, or with *cannot see*.

    Args:
        belief: What is believed.
        rules: What is shown only from where; everything else is shown everywhere.
    """

    def __init__(self, belief: Belief, rules: Sequence[Showing]):
        self._belief, self._rules = belief, tuple(rules)
        self._needs: dict[Atom, tuple[int, frozenset[Atom]]] = {}
        self._places: dict[int, set[frozenset[Atom]]] = {}
        self._heard: set[tuple[frozenset[Atom], bool]] = set()
        self._shown, self._elsewhere = SHOWN, ELSEWHERE
        self._of: Mapping[int, float] | None = None  # the weights of what was found
        self._found: dict[frozenset[Atom], float] = {}

    @property
    def limited(self) -> bool:
        """Whether anything is shown only from somewhere."""
        return bool(self._rules)

    def needed(self, atom: Atom) -> frozenset[Atom]:
        """What has to hold so that a fact is shown."""
        return self._rule_of(atom)[1]

    def _rule_of(self, atom: Atom) -> tuple[int, frozenset[Atom]]:
        """The number of the rule that says from where a fact is shown, and that."""
        known = self._needs.get(atom)
        if known is None:
            task = self._belief.model.task
            told = ((number, rule.needed(atom, task)) for number, rule in enumerate(self._rules))
            found = ((number, each) for number, each in told if each is not None)
            known = self._needs[atom] = next(found, (len(self._rules), frozenset()))
        return known

    def shows(self, atoms: Sequence[Atom], prior: Prior | None = None) -> bool:
        """Whether any of some facts may be shown here, by what is believed of where the robot is:
        with less than a tenth of where it most probably is they are not.

        Args:
            atoms: The facts.
            prior: What is believed; by default the belief.
        """
        return not self._rules or any(self._may_show(atom, prior) for atom in atoms)

    def _may_show(self, atom: Atom, prior: Prior | None) -> bool:
        rule, needed = self._rule_of(atom)
        derived = self._belief.model.task.derived
        if not needed or (prior is not None and any(each.predicate in derived for each in needed)):
            return True  # of what follows from others initial states say nothing

        def likely(place: frozenset[Atom]) -> float:
            return self._probability(place) if prior is None else _in_prior(place, prior)

        here = likely(needed)
        most = max(map(likely, self._places_of(rule)), default=here)
        return here >= OUT_OF_SIGHT * most

    def _places_of(self, rule: int) -> set[frozenset[Atom]]:
        """The places from which a rule shows what the task is about."""
        if not self._places:
            self._places = {number: set() for number in range(len(self._rules) + 1)}
            for atom in self._belief.model.task.atoms():
                number, needed = self._rule_of(atom)
                self._places[number].add(needed)
        return self._places[rule]

    def _holds(self, needed: frozenset[Atom], number: int) -> bool:
        return all(self._belief.model.truth((atom,))[number] for atom in needed)

    def _probability(self, needed: frozenset[Atom]) -> float:
        weights = self._belief.weights
        if weights is not self._of:
            self._of = weights
            self._found.clear()
        if needed not in self._found:
            held = (weight for each, weight in weights.items() if self._holds(needed, each))
            self._found[needed] = sum(held)
        return self._found[needed]

    def moved(self) -> None:
        """Note that an action was executed: what is seen may be something else."""
        self._heard.clear()

    def take(self, atoms: Sequence[Atom], reply: Reply) -> None:
        """Weigh the belief by whether a question found an answer that is about a fact, or several
        alike that are shown from the same place.

        Once between two actions of each place and each kind: what a VLM does not see it does not
        see at the next look. A reply that is missing, late or malformed says nothing.
        """
        needed, told = self.needed(atoms[0]), reply is not Reply.CANNOT_SEE
        if any(self.needed(atom) != needed for atom in atoms[1:]):
            return
        if not needed or reply is Reply.UNKNOWN or (needed, told) in self._heard:
            return
        self._heard.add((needed, told))
        here, there = (_rate(each, told=told) for each in (self._shown, self._elsewhere))
        self._belief.weigh(lambda number: here if self._holds(needed, number) else there)
        likely = self._probability(needed)
        self._shown = _counted(self._shown, likely, told=told)
        self._elsewhere = _counted(self._elsewhere, 1 - likely, told=told)


def _in_prior(needed: frozenset[Atom], prior: Prior) -> float:
    return prod(prior.probability(atom) for atom in needed)


def _rate(counts: tuple[float, float], *, told: bool) -> float:
    return counts[0 if told else 1] / sum(counts)


def _counted(counts: tuple[float, float], more: float, *, told: bool) -> tuple[float, float]:
    answered, silent = counts
    return (answered + more, silent) if told else (answered, silent + more)
