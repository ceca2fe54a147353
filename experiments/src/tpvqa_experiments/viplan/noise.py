"""A noise model that answers as a real VLM did about a scene like it. It knows the truth."""

from collections.abc import Iterator, Sequence
from random import Random

from tpvqa.chance import chance
from tpvqa.errors import PluginError
from tpvqa.observation import Observation
from tpvqa.pddl import Atom, Task
from tpvqa.plugins import PlainArguments
from tpvqa.questions import FactQuestion, Question
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.capabilities import FactsOnly, NoiseModel
from tpvqa.vlm.protocol import TruthSource
from tpvqa_experiments.viplan.scenes import (
    Arrangement,
    Fact,
    Scene,
    facts_of,
    models,
    scenes,
    true_facts,
)

ENOUGH = 5
"""Scenes among which one is drawn; where so many are alike, none less alike is drawn."""
LASTING = 0.25
"""Share of the facts about which errors outlast a change of the scene: in 577 pairs of recorded
looks `experiments/tools/viplan_lasting.py` finds .25 (95% interval .22 to .29), and as much where
one action lies between them (.25) as where there are two (.27) or more (.20)."""
PREDICATES = {"on": 2, "clear": 1, "incolumn": 2}
"""What ViPlan's blocksworld says of blocks and columns, with the number of arguments."""


class RecordedScenes(NoiseModel, FactsOnly, PlainArguments):
    """Answers every question about a state as one recorded scene of the same shape was answered.

    A noise model, not a VLM, for ViPlan's blocksworld. For every state of a trial a scene that the
    model was asked about is drawn, with as many blocks and columns, and as high columns where there
    are five such; blocks and columns are renamed to fit. All questions about the state are answered
    as they were there: so errors of one picture go together, and whoever asks again in the same
    state hears the same. For a share `LASTING` of the facts, drawn for the trial, the answer does
    not change as long as the fact does not: it is that of the first state, or where the fact
    changed since then, one drawn for it. Scenes of the problem itself are never drawn.

    What is assumed: that errors depend neither on the colours nor, but for that share, on other
    pictures of the same trial; and that a state that comes back looks as it did.

    Args:
        truth: What is true in the world.
        task: Its blocks and columns.
        told: The scenes.
        spec: What it was made from.
        seed: The user's seed.
        episode: Number of the episode under this seed.

    Raises:
        PluginError: The task is not of ViPlan's blocksworld, or there are no scenes of its size.
    """

    def __init__(
        self,
        truth: TruthSource,
        task: Task,
        told: Sequence[Scene],
        *,
        spec: str,
        seed: int = 0,
        episode: int = 0,
    ):
        self._truth, self._spec, self._seed, self._episode = truth, spec, seed, episode
        self._blocks = sorted(task.objects_by_type.get("block", ()))
        self._columns = sorted(task.objects_by_type.get("column", ()))
        sizes = len(self._blocks), len(self._columns)
        self._scenes = [
            scene
            for scene in told
            if (sum(scene.heights), len(scene.heights)) == sizes and scene.problem != task.name
        ]
        arities = {name: len(task.predicates.get(name, ())) for name in PREDICATES}
        if arities != PREDICATES or not self._scenes:
            raise PluginError(
                f"{spec!r} answers about ViPlan's blocksworld: of 3 blocks on 4 columns, 5 on 5 or "
                f"6 on 4. The task {task.name!r} is another. Use recorded:MODEL."
            )
        self._seen: dict[Arrangement, dict[Fact, bool]] = {}
        self._first = self._arrangement()

    @classmethod
    def from_spec(
        cls, arguments: str, *, truth: TruthSource, task: Task, seed: int = 0, episode: int = 0
    ) -> "RecordedScenes":
        """Make it from `recorded-scenes:MODEL`.

        Raises:
            UnknownNameError: No scenes of such a model were recorded.
            PluginError: No model is named, or the task is not of ViPlan's blocksworld.
        """
        if not arguments:
            raise PluginError(f"Write recorded-scenes:MODEL, with a model of {', '.join(models())}")
        spec = f"recorded-scenes:{arguments}"
        return cls(truth, task, scenes(arguments), spec=spec, seed=seed, episode=episode)

    @property
    def name(self) -> str:
        """The specification it can be made from again."""
        return self._spec

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order; only the true state matters."""
        columns = self._arrangement()
        if columns not in self._seen:
            self._seen[columns] = self._lasting(columns, self._drawn(columns))
        return [self._answer(self._seen[columns], each) for each in questions]

    def _answer(self, seen: dict[Fact, bool], question: Question) -> Answer:
        if isinstance(question, FactQuestion):
            told = seen.get((question.atom.predicate, *question.atom.arguments))
            if told is not None:
                reply = Reply.YES if told else Reply.NO
                return Answer(question, reply, source="recorded scene", text=reply.value)
        why = "Nothing of this kind was recorded."
        return Answer(question, Reply.UNKNOWN, source="recorded scene", text=why)

    def _arrangement(self) -> Arrangement:
        holds = self._truth.holds
        below = {
            block: {other for other in self._blocks if holds(Atom("on", (block, other)))}
            for block in self._blocks
        }

        def height(block: str) -> int:
            return 1 + max(map(height, below[block])) if below[block] else 0

        standing = sorted(self._blocks, key=height)
        return tuple(
            "".join(block for block in standing if holds(Atom("incolumn", (block, column))))
            for column in self._columns
        )

    def _drawn(self, columns: Arrangement) -> dict[Fact, bool]:
        draw = chance(self._seed, self._episode, "recorded scene", *columns)
        candidates = next(
            found
            for found in self._alike(tuple(map(len, columns)))
            if len(found) >= min(ENOUGH, len(self._scenes))
        )
        return as_seen(columns, draw.choice(candidates), draw)

    def _lasting(self, columns: Arrangement, drawn: dict[Fact, bool]) -> dict[Fact, bool]:
        """What is answered about a state: as drawn for it, or as it is in all of the trial."""
        if columns == self._first:
            return drawn
        true, first = true_facts(columns), true_facts(self._first)
        if self._first not in self._seen:
            self._seen[self._first] = self._drawn(self._first)
        found = dict(drawn)
        for fact in drawn:
            truth = fact in true
            if chance(self._seed, self._episode, "lasting", *fact).random() >= LASTING:
                continue
            if truth == (fact in first):
                found[fact] = self._seen[self._first][fact]
            else:
                draw = chance(self._seed, self._episode, "lasting answer", *fact, truth)
                found[fact] = self._any(fact[0], draw, truth=truth)
        return found

    def _any(self, predicate: str, draw: Random, *, truth: bool) -> bool:
        """How a fact of a predicate was answered in some initial scene."""
        scene = draw.choice([each for each in self._scenes if each.initial] or self._scenes)
        true = true_facts(scene.columns)
        told = [
            yes
            for fact, yes in scene.answers.items()
            if fact[0] == predicate and (fact in true) == truth
        ]
        return draw.choice(told) if told else truth

    def _alike(self, heights: tuple[int, ...]) -> Iterator[list[Scene]]:
        """Candidates, the most alike first; initial scenes before others, which were looked at
        again for their errors."""
        exact = [each for each in self._scenes if each.heights == heights]
        alike = [each for each in self._scenes if not apart(each.heights, heights)]
        yield [each for each in exact if each.initial]
        yield [each for each in alike if each.initial]
        yield alike
        for most in range(1, 2 * sum(heights) + 1):
            yield [each for each in self._scenes if apart(each.heights, heights) <= most]


def apart(one: Sequence[int], other: Sequence[int]) -> int:
    """How far the heights of columns are from those of others, whatever their order."""
    return sum(abs(a - b) for a, b in zip(sorted(one), sorted(other), strict=True))


def as_seen(columns: Arrangement, scene: Scene, draw: Random) -> dict[Fact, bool]:
    """What is answered about an arrangement by who sees it as a recorded scene.

    Where the scene differs in shape, a fact that holds in one of them only is answered as another
    of its predicate and truth was in the scene.

    Args:
        columns: How the blocks stand.
        scene: With as many blocks and columns.
        draw: Random numbers.
    """
    column, block = _renamed(columns, scene.columns)
    true, seen_true = true_facts(columns), true_facts(scene.columns)
    found = {}
    for fact in facts_of(columns):
        predicate, first, *rest = fact
        named = [column[each] if each in column else block[each] for each in rest]
        there = (predicate, block[first], *named)
        if (there in seen_true) != (fact in true):
            others = [
                other
                for other in scene.answers
                if other[0] == predicate and (other in seen_true) == (fact in true)
            ]
            there = draw.choice(others) if others else there
            found[fact] = scene.answers[there] if others else fact in true
        else:
            found[fact] = scene.answers[there]
    return found


def _renamed(here: Arrangement, there: Arrangement) -> tuple[dict[str, str], dict[str, str]]:
    """The columns and the blocks of another arrangement that stand for those of one."""
    numbers = range(len(here))
    own, others = list(numbers), list(numbers)
    if tuple(map(len, here)) != tuple(map(len, there)):
        own.sort(key=lambda number: len(here[number]))
        others.sort(key=lambda number: len(there[number]))
    column = dict(zip(own, others, strict=True))
    block: dict[str, str] = {}
    for number in numbers:
        block |= dict(zip(here[number], there[column[number]], strict=False))
    left = [each for each in "".join(here) if each not in block]
    spare = [each for each in "".join(there) if each not in block.values()]
    block |= dict(zip(left, spare, strict=True))
    return {f"c{one + 1}": f"c{other + 1}" for one, other in column.items()}, block
