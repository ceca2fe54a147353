"""A noise model that errs as a real VLM did. It knows the truth and sees nothing."""

from bisect import bisect
from collections.abc import Mapping, Sequence
from itertools import accumulate

from tpvqa.chance import chance
from tpvqa.errors import PluginError
from tpvqa.observation import Observation
from tpvqa.pddl import Task
from tpvqa.plugins import PlainArguments
from tpvqa.questions.question import FactQuestion, Question, Way
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.capabilities import FactsOnly, NoiseModel
from tpvqa.vlm.out_of_sight import out_of_sight
from tpvqa.vlm.protocol import TruthSource
from tpvqa.vlm.recorded.answers import Recording, Recordings, models, recordings

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


class Recorded(NoiseModel, FactsOnly, PlainArguments):
    """Draws answers from those that a model gave to questions of the same kind.

    A noise model, not a VLM. An answer with its P(yes) is drawn from the model's recorded answers
    of the same kind (precondition or effect), of the same predicate where it has 30 of them (in
    each half 15), and of the same truth. Within one look the same question gets the same answer.

    What is assumed: that errors depend on nothing else, so that answers at different looks are
    independent; that questions about where else a thing is are answered as preconditions are; and
    for the household that its predicates are as hard as their counterparts (`COUNTERPART`). About
    whole actions nothing was recorded: such questions are *unknown*.

    Args:
        truth: What is true in the world.
        told: The recorded answers.
        spec: What it was made from.
        seed: The user's seed.
        episode: Number of the episode under this seed.
    """

    def __init__(
        self, truth: TruthSource, told: Recordings, *, spec: str, seed: int = 0, episode: int = 0
    ):
        self._truth, self._told, self._spec = truth, told, spec
        self._seed, self._episode = seed, episode

    @classmethod
    def from_spec(
        cls, arguments: str, *, truth: TruthSource, task: Task, seed: int = 0, episode: int = 0
    ) -> "Recorded":
        """Make it from `recorded:MODEL[:HALF]`, with HALF 0 or 1 for one half of the problems.

        The environment is blocksworld for a domain of that name, else igibson.

        Raises:
            UnknownNameError: No such model was recorded, or not in that environment.
            PluginError: The arguments are others.
        """
        told = told_by(arguments, task)
        return cls(truth, told, spec=f"recorded:{arguments}", seed=seed, episode=episode)

    @property
    def name(self) -> str:
        """The specification it can be made from again."""
        return self._spec

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order; only the number of the look matters."""
        return [
            out_of_sight(observation, each, self._truth) or self._answer(observation.look, each)
            for each in questions
        ]

    def _answer(self, look: int, question: Question) -> Answer:
        if not isinstance(question, FactQuestion):
            return _silent(question, "No answers to questions about whole actions were recorded.")
        truth = question.true_in(self._truth.holds)
        choice = drawn_from(self._told, question.way, question.subject, truth=truth)
        if not choice:
            return _silent(question, "No answers to questions of this kind were recorded.")
        draw = chance(self._seed, self._episode, "recorded answer", question.text, truth, look)
        shares = list(accumulate(recording.count for recording in choice))
        told = choice[bisect(shares, draw.randrange(shares[-1]))]
        return Answer(
            question,
            Reply.YES if told.yes else Reply.NO,
            p_yes=told.p_yes,
            source="recorded",
            text="yes" if told.yes else "no",
        )


def told_by(arguments: str, task: Task) -> Recordings:
    """The answers that MODEL[:HALF] stands for in the environment of a task.

    Raises:
        UnknownNameError: No such model was recorded, or not in that environment.
        PluginError: The arguments are others.
    """
    model, _, half = arguments.partition(":")
    if not model or half not in ("", "0", "1"):
        raise PluginError(
            f"'recorded:{arguments}' is not understood. Write recorded:MODEL or "
            f"recorded:MODEL:HALF (0 or 1), with a model of {', '.join(models())}."
        )
    environment = "blocksworld" if task.domain_name == "blocksworld" else "igibson"
    return recordings(model, environment, int(half) if half else None)


def drawn_from(told: Recordings, way: Way, predicate: str, *, truth: bool) -> tuple[Recording, ...]:
    """The recorded answers that one is drawn from; none where nothing was recorded."""
    if way not in _KIND:
        return ()
    if told.environment == "igibson":
        predicate = COUNTERPART.get(predicate, "")
    return told.of(_KIND[way], predicate, truth=truth)


def _silent(question: Question, why: str) -> Answer:
    return Answer(question, Reply.UNKNOWN, source="recorded", text=why)
