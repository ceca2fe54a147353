"""A noise model that errs as a real VLM did. It knows the truth and sees nothing."""

from bisect import bisect
from collections.abc import Mapping, Sequence
from itertools import accumulate
from random import Random

from tpvqa.chance import chance
from tpvqa.observation import Observation
from tpvqa.pddl import Task
from tpvqa.plugins import PlainArguments
from tpvqa.questions.question import FactQuestion, Question, Way
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.capabilities import FactsOnly, NoiseModel, SaidInFull
from tpvqa.vlm.other_words import SHARED, words_drawn_for
from tpvqa.vlm.out_of_sight import out_of_sight
from tpvqa.vlm.protocol import TruthSource
from tpvqa.vlm.recorded.answers import Recording, Recordings
from tpvqa.vlm.recorded.lasting import Lasting
from tpvqa.vlm.recorded.spec import HOUSEHOLD, Errors, RecordedSpec
from tpvqa.vlm.scenes import scene_of, tells_scenes

COUNTERPART: Mapping[str, str] = {
    "near": "reachable",
    "in_hand": "holding",
    "on": "ontop",
    "opened": "open",
    "turned_on": "open",
    "clean": "open",
    "halved": "open",
}
"""Which recorded predicate of igibson stands for one of the household: where the robot is, what it
holds, where things lie, and, as the only recorded state of a thing, open for all such states."""
_KIND = {
    Way.PRECONDITION: "precondition",
    Way.ALTERNATIVE: "precondition",
    Way.EFFECT: "effect",
}


class Recorded(NoiseModel, FactsOnly, PlainArguments, SaidInFull):
    """Draws answers from those that a model gave to questions of the same kind.

    A noise model, not a VLM. An answer with its P(yes) is drawn from the model's recorded answers
    of the same kind (precondition or effect), of the same predicate where it has 30 of them (in
    each half 15), and of the same truth. Within one look the same question gets the same answer.

    Errors last as they did in the record (see `Lasting`): a share of the answers is the scene's own
    draw, the same each time that this is asked of this scene, part of which is one for the whole
    trial; only the rest is drawn at each look.

    What is assumed: that errors depend on nothing else; that questions about where else a thing is
    are answered as preconditions are; and for the household that its predicates are as hard as
    their counterparts (`COUNTERPART`). About whole actions nothing was recorded: such questions are
    *unknown*.

    Args:
        truth: What is true in the world.
        told: The recorded answers.
        spec: What it was made from.
        lasts: What share of them lasts; None for answers that are drawn anew at every look.
        words: How often what lasts in another wording is what lasts in the first one.
        seed: The user's seed.
        episode: Number of the episode under this seed.

    Raises:
        PluginError: Errors are to last in a world that does not tell scenes apart.
    """

    def __init__(
        self,
        truth: TruthSource,
        told: Recordings,
        *,
        spec: str,
        lasts: Lasting | None = None,
        words: float = SHARED,
        seed: int = 0,
        episode: int = 0,
    ) -> None:
        self._truth, self._told, self._spec = truth, told, spec
        self._lasts, self._seed, self._episode = lasts, seed, episode
        self._words = words
        if lasts is not None:
            tells_scenes(truth, spec, spec.replace(f":{Errors.LASTING}", f":{Errors.FRESH}"))

    @classmethod
    def from_spec(
        cls, arguments: str, *, truth: TruthSource, task: Task, seed: int = 0, episode: int = 0
    ) -> "Recorded":
        """Make it from `recorded:MODEL[:HALF][:fresh]`, with HALF 0 or 1 for one half of the
        problems; instead of MODEL also FILE or FILE:MODEL for a table of one's own.

        The environment is blocksworld for a domain of that name, else igibson.

        Raises:
            UnknownNameError: No such model was recorded, or not in that environment.
            RecordError: The table is broken, or holds no answers of that kind.
            PluginError: The arguments are others, or errors are to last in a world that does not
                tell scenes apart.
        """
        spec = RecordedSpec.parse(arguments).with_errors(Errors.LASTING)
        told = spec.told(task)
        return cls(
            truth,
            told,
            spec=f"recorded:{spec}",
            lasts=spec.lasts(told),
            words=spec.words,
            seed=seed,
            episode=episode,
        )

    @classmethod
    def plain(cls, arguments: str) -> bool:
        """Not where it names a file."""
        return not RecordedSpec.names_table(arguments)

    @classmethod
    def in_full(cls, arguments: str) -> str:
        """Says that errors last, where nothing is said."""
        return str(RecordedSpec.parse(arguments).with_errors(Errors.LASTING))

    @classmethod
    def of_before(cls, arguments: str) -> str:
        """Says that errors are drawn afresh, where nothing is said: all once were."""
        return str(RecordedSpec.parse(arguments).with_errors(Errors.FRESH))

    @property
    def name(self) -> str:
        """The specification it can be made from again."""
        return self._spec

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order; only look and scene matter, never the pictures."""
        return [
            out_of_sight(observation, each, self._truth) or self._answer(observation, each)
            for each in questions
        ]

    def _answer(self, observation: Observation, question: Question) -> Answer:
        if not isinstance(question, FactQuestion):
            return _silent(question, "No answers to questions about whole actions were recorded.")
        truth = question.true_in(self._truth.holds)
        choice = drawn_from(self._told, question.way, question.subject, truth=truth)
        if not choice:
            return _silent(question, "No answers to questions of this kind were recorded.")
        shares = list(accumulate(recording.count for recording in choice))
        told = choice[bisect(shares, self._place(observation, question, shares[-1], truth))]
        return Answer(
            question,
            Reply.YES if told.yes else Reply.NO,
            p_yes=told.p_yes,
            source="recorded",
            text="yes" if told.yes else "no",
        )

    def _place(
        self, observation: Observation, question: FactQuestion, count: int, truth: bool
    ) -> int:
        """Which of so many recorded answers it is."""
        key, lasts = (question.text, truth), self._lasts
        if lasts is None or self._drawn("lasts", *key, observation.look) >= lasts.scene:
            draw = self._chance("recorded answer", *key, observation.look)
            return draw.randrange(count)
        # In one scale for all kinds: asked otherwise, the same words are answered alike.
        scene = scene_of(observation, self._truth)
        if self._drawn("lasts for the trial", *key, scene) < lasts.trial:
            return int(self._lasting("of the trial", question, truth) * count)
        return int(self._lasting("of the scene", question, truth, scene) * count)

    def _lasting(self, purpose: str, question: FactQuestion, *where: object) -> float:
        """What is drawn once, for a question's words or for the first ones in which it is asked."""
        words = words_drawn_for(
            question,
            self._words,
            lambda *other: self._drawn(f"{purpose}, {other[0]}", other[1], *where),
        )
        return self._drawn(purpose, words, *where)

    def _drawn(self, purpose: str, *key: object) -> float:
        return self._chance(f"recorded answer {purpose}", *key).random()

    def _chance(self, purpose: str, *key: object) -> Random:
        return chance(self._seed, self._episode, purpose, *key)


def told_by(arguments: str, task: Task) -> Recordings:
    """The answers that MODEL[:HALF][:fresh] stands for in the environment of a task.

    Raises:
        UnknownNameError: No such model was recorded, or not in that environment.
        RecordError: A table is broken, or holds no answers of that kind.
        PluginError: The arguments are others.
    """
    return RecordedSpec.parse(arguments).told(task)


def drawn_from(told: Recordings, way: Way, predicate: str, *, truth: bool) -> tuple[Recording, ...]:
    """The recorded answers that one is drawn from; none where nothing was recorded."""
    if way not in _KIND:
        return ()
    kind = _KIND[way]
    if told.environment == HOUSEHOLD and (kind, predicate, truth) not in told.by_kind:
        predicate = COUNTERPART.get(predicate, predicate)
    return told.of(kind, predicate, truth=truth)


def _silent(question: Question, why: str) -> Answer:
    return Answer(question, Reply.UNKNOWN, source="recorded", text=why)
