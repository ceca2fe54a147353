"""Which question to label next, and when there are labels enough."""

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import blake2b

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.counts import PSEUDO
from tpvqa.labelling.labels import Said
from tpvqa.labelling.recorded import Asking
from tpvqa.questions import Way
from tpvqa.vlm import Reply

ENOUGH = 0.07
"""Standard error of how often answers are right, in the mean over what is asked, from which on
more labels are not needed. 60 labels of a household's episodes reach it, and with them a belief
completes as many trials as with the truth (docs/calibration.md)."""
AHEAD = 10
"""Labels over which it is told what more of them would do …"""
FLAT = 0.02
"""… and the share of the standard error that they would have to take away to be worth giving."""
NEAR = (0.25, 0.75)
"""P(yes) near where yes becomes no."""
FURTHEST = 3.0
"""How many answers a labelled one stands for at most, in the mean of its group."""

Group = tuple[Way, str]
Stratum = tuple[str, bool]
"""What the VLM said first, and whether its P(yes) was near the boundary."""
Known = Callable[[Asking], Said | None]


@dataclass(slots=True)
class _Cases:
    """Labelled answers of one group, by what was right."""

    of: dict[bool, float] = field(default_factory=lambda: {True: 0.0, False: 0.0})

    @property
    def total(self) -> float:
        return self.of[True] + self.of[False]


@dataclass(frozen=True, slots=True)
class Standing:
    """How far the labels go.

    Attributes:
        error: Standard error of how often an answer is right, in the mean over what is asked.
        after: The same as it is expected to be after `AHEAD` more.
        left: Questions without a label.
    """

    error: float
    after: float
    left: int

    @property
    def enough(self) -> bool:
        """Whether more labels are not needed, or would not help."""
        return self.error <= ENOUGH or self.left == 0 or self.error - self.after < FLAT * self.error


class Order:
    """The most informative question first.

    Questions of one way of asking and one predicate are a group, as for `calibrate`. The next label
    goes to the group where it lowers the standard error most: to those that are asked often and of
    which little is known. Within a group labels go round among what the VLM said (yes, no, nothing;
    sure, or near the boundary, those first), the rarer ones more often than they come; `weights`
    puts that right afterwards. Among those it is chance, but a fact's first stretch in an episode
    goes before its later ones, of which less can be learnt.

    Args:
        askings: Of all episodes.
    """

    def __init__(self, askings: Sequence[Asking]):
        self.askings = tuple(askings)
        ranks: defaultdict[tuple[str, str], int] = defaultdict(int)
        placed: defaultdict[Group, defaultdict[Stratum, list[tuple[int, bytes, Asking]]]]
        placed = defaultdict(lambda: defaultdict(list))
        asked: defaultdict[Group, int] = defaultdict(int)
        for asking in self.askings:
            same = str(asking.episode), asking.text
            chance = asking.episode.name, asking.text, asking.stretch
            key = blake2b(repr(chance).encode(), digest_size=8).digest()
            placed[asking.group][_stratum(asking)].append((ranks[same], key, asking))
            ranks[same] += 1
            for answer in asking.of_vlm:
                asked[answer.way, asking.subject] += 1
        self._placed: dict[Group, dict[Stratum, list[Asking]]] = {
            group: {
                stratum: [each for _, _, each in sorted(found, key=lambda entry: entry[:2])]
                for stratum, found in strata.items()
            }
            for group, strata in placed.items()
        }
        total = sum(asked[group] for group in placed)
        self._share = {group: asked[group] / total for group in placed}

    def next(self, known: Known, passed: Iterable[Asking] = ()) -> Asking | None:
        """The question to label next; None where there is none left.

        Args:
            known: The label of a question, if there is one.
            passed: What is not to be asked now.
        """
        left = _identities(passed)

        def open_in(found: Sequence[Asking]) -> list[Asking]:
            return [each for each in found if known(each) is None and id(each) not in left]

        best: tuple[float, list[tuple[Stratum, list[Asking], list[Asking]]]] | None = None
        counts = self._counts(known)
        for group, strata in self._placed.items():
            remaining = [
                (stratum, found, rest)
                for stratum, found in strata.items()
                if (rest := open_in(found))
            ]
            if not remaining:
                continue
            gain = self._gain(counts, group)
            if best is None or gain > best[0]:
                best = gain, remaining
        if best is None:
            return None

        def due(entry: tuple[Stratum, list[Asking], list[Asking]]) -> tuple[float, bool]:
            (_, near), found, rest = entry
            return math.sqrt(len(found)) / (len(found) - len(rest) + 1), near

        return max(best[1], key=due)[2][0]

    def standing(self, known: Known) -> Standing:
        """How far the labels go."""
        counts = self._counts(known)
        error = after = self._error(counts)
        left = {
            group: sum(known(each) is None for found in strata.values() for each in found)
            for group, strata in self._placed.items()
        }
        total = sum(left.values())
        for _ in range(min(AHEAD, total)):
            group = max((each for each in left if left[each]), key=lambda g: self._gain(counts, g))
            left[group] -= 1
            for truth, share in self._shares(counts[group]):
                counts[group].of[truth] += share
            after = self._error(counts)
        return Standing(error, after, total)

    def _counts(self, known: Known) -> dict[Group, _Cases]:
        counts = {group: _Cases() for group in self._placed}
        for asking in self.askings:
            said = known(asking)
            if said in ("yes", "no"):
                counts[asking.group].of[said == "yes"] += 1
        return counts

    @staticmethod
    def _shares(cases: _Cases) -> list[tuple[bool, float]]:
        """How often the next label of a group is expected to be yes and no."""
        yes = (cases.of[True] + 1) / (cases.total + 2)
        return [(True, yes), (False, 1 - yes)]

    def _gain(self, counts: Mapping[Group, _Cases], group: Group) -> float:
        """By how much one more label of a group is expected to lower the standard error."""
        now, gain, own = self._error(counts), 0.0, counts[group].of
        for truth, share in self._shares(counts[group]):
            own[truth] += 1
            gain += share * (now - self._error(counts))
            own[truth] -= 1
        return gain

    def _error(self, counts: Mapping[Group, _Cases]) -> float:
        """The mean over groups, by how often they are asked.

        As many cases are behind a group's rates as `calibrate` puts behind them: its own, and at
        most `PSEUDO` of its way's, behind which are at most as many of all and of the default.
        """
        all_of: defaultdict[bool, float] = defaultdict(float)
        of_way: defaultdict[tuple[Way, bool], float] = defaultdict(float)
        for (way, _), cases in counts.items():
            for truth, number in cases.of.items():
                all_of[truth] += number
                of_way[way, truth] += number
        error = 0.0
        for (way, subject), share in self._share.items():
            variance = 0.0
            for truth in (True, False):
                own = counts[way, subject].of[truth]
                behind = PSEUDO + all_of[truth] - of_way[way, truth]
                behind = of_way[way, truth] - own + _at_most(behind)
                variance += _VARIANCE / (own + _at_most(behind))
            error += share * math.sqrt(variance) / 2
        return error

    def weights(self, known: Known) -> dict[int, float]:
        """How many answers each labelled question stands for, by its `id`.

        Within a group as many as were answered like it and have no label: what was chosen more
        often than it comes counts less. Their mean in a group is 1.
        """
        found: dict[int, float] = {}
        for strata in self._placed.values():
            told = {
                stratum: [each for each in every if known(each) in ("yes", "no")]
                for stratum, every in strata.items()
            }
            labelled = [(len(strata[each]), some) for each, some in told.items() if some]
            number = sum(len(some) for _, some in labelled)
            every = sum(count for count, _ in labelled)
            raw = {
                id(each): min(max(count / len(some) * number / every, 1 / FURTHEST), FURTHEST)
                for count, some in labelled
                for each in some
            }
            mean = sum(raw.values()) / number if number else 1.0
            found |= {key: weight / mean for key, weight in raw.items()}
        return found


_RATES = Calibration.default().whole.rates
_VARIANCE = _RATES.yes_if_true * (1 - _RATES.yes_if_true)
"""Of one answer's being right, where nothing is known of it."""


def _at_most(cases: float) -> float:
    """What the cases of a wider group are worth in a narrower one."""
    return 1 / (1 / PSEUDO + 1 / cases)


def _stratum(asking: Asking) -> Stratum:
    first = asking.of_vlm[0]
    said = first.reply.value if first.reply in (Reply.YES, Reply.NO) else ""
    return said, first.p_yes is not None and NEAR[0] < first.p_yes < NEAR[1]


def _identities(askings: Iterable[Asking]) -> frozenset[int]:
    return frozenset(map(id, askings))
