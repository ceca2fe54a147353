"""A noise model for experiments: it knows the truth and errs at a given rate. It sees nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tpvqa.chance import chance
from tpvqa.errors import EpisodeError, PluginError
from tpvqa.observation import Observation
from tpvqa.questions.question import ActionQuestion, FactQuestion, Question, Way
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.capabilities import NoiseModel
from tpvqa.vlm.other_words import SHARED, split_words, with_words, words_drawn_for
from tpvqa.vlm.out_of_sight import out_of_sight
from tpvqa.vlm.protocol import TruthSource
from tpvqa.vlm.scenes import scene_of, tells_scenes


@dataclass(frozen=True, slots=True)
class _LastAnswer:
    """The last answer to a question: at which look, what was true then, what was said."""

    look: int
    truth: bool
    yes: bool


class Oracle(NoiseModel):
    """Answers from the truth, errs at rate 1 - accuracy, and can repeat its errors.

    A noise model, not a VLM: it does not look at the pictures. It answers yes or no to every
    question about a fact or an action, also where the picture would not show it; in a world without
    pictures it cannot see what the world file says is not shown.

    Real errors repeat: with probability `rho` it gives its last answer again when it looks again
    at an unchanged fact. And they last: with probability `persistent` an answer is the scene's own
    draw, the same each time that this is asked of this scene (true state and view) in the trial,
    so that two answers to a question about a scene correlate by the square of it. Otherwise each
    look is drawn afresh; the draw is a function of seed, episode, the question's text, its true
    answer and the look. As a VLM hears only words, two questions in the same words are the same
    question, and get the same answer within one look.

    Its P(yes) is `accuracy` where it says yes and 1 - `accuracy` where it says no: how reliable
    the model believes itself to be, which is exact by construction.

    Args:
        truth: What is true in the world.
        accuracy: Probability that a fresh answer is right.
        rho: Probability that a further look at an unchanged fact repeats the last answer.
        persistent: The lasting share: probability that an answer is the scene's own draw.
        words: How often the scene's own draw for another wording of a question is that for the
            first one; otherwise it has its own.
        seed: The user's seed.
        episode: Number of the episode under this seed.

    Raises:
        PluginError: One of the three is not a probability, or errors are to last in a world that
            does not tell scenes apart.
    """

    def __init__(
        self,
        truth: TruthSource,
        *,
        accuracy: float = 1.0,
        rho: float = 0.0,
        persistent: float = 0.0,
        words: float = SHARED,
        seed: int = 0,
        episode: int = 0,
    ) -> None:
        shares = {"accuracy": accuracy, "rho": rho, "lasting share": persistent, "words": words}
        for what, value in shares.items():
            if not 0 <= value <= 1:
                raise PluginError(f"The oracle's {what} is {value}; it must lie between 0 and 1.")
        self.accuracy, self.rho = float(accuracy), float(rho)
        self.persistent, self.words = float(persistent), float(words)
        if persistent:
            fresh = f"oracle:{accuracy:g}:{rho:g}"
            tells_scenes(truth, f"{fresh}:{persistent:g}", fresh)
        self._truth, self._seed, self._episode = truth, seed, episode
        self._last: dict[str, _LastAnswer] = {}

    @classmethod
    def from_spec(
        cls, arguments: str, *, truth: TruthSource, seed: int = 0, episode: int = 0
    ) -> "Oracle":
        """Make it from `ACCURACY[:RHO[:PERSISTENT]][:words:SHARE]`; without it never errs.

        Raises:
            PluginError: The arguments are not one to three probabilities.
        """
        said, words = split_words(arguments)
        try:
            numbers = [float(word) for word in said.split(":")] if said else []
        except ValueError:
            numbers = [-1.0]
        if len(numbers) > 3 or not all(0 <= number <= 1 for number in numbers):
            raise PluginError(
                f"'oracle:{arguments}' is not understood. Write oracle, oracle:ACCURACY, "
                "oracle:ACCURACY:RHO or oracle:ACCURACY:RHO:PERSISTENT with numbers between 0 "
                "and 1, e.g. oracle:0.8:0.5, or oracle:0.8:0:0.74 for errors that last; "
                "behind it words:0.5, where half of what lasts is the same in all wordings."
            )
        given = dict(zip(("accuracy", "rho", "persistent"), numbers, strict=False))
        return cls(truth, **given, words=words, seed=seed, episode=episode)

    @property
    def name(self) -> str:
        """The specification it can be made from again, e.g. "oracle:0.8:0.5"."""
        name = f"oracle:{self.accuracy:g}"
        if self.persistent:
            name = f"{name}:{self.rho:g}:{self.persistent:g}"
        elif self.rho:
            name = f"{name}:{self.rho:g}"
        return with_words(name, self.words)

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order; only look and scene matter, never the pictures."""
        return [
            out_of_sight(observation, each, self._truth) or self._answer(observation, each)
            for each in questions
        ]

    def snapshot(self) -> Mapping[str, Any]:
        """The last answers as plain JSON values, so that an episode can be resumed."""
        return {
            "answers": [
                {"text": text, "look": given.look, "truth": given.truth, "yes": given.yes}
                for text, given in self._last.items()
            ]
        }

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave.

        Raises:
            EpisodeError: It is not such a snapshot.
        """
        try:
            self._last = {
                str(entry["text"]): _LastAnswer(
                    int(entry["look"]), bool(entry["truth"]), bool(entry["yes"])
                )
                for entry in snapshot["answers"]
            }
        except (KeyError, TypeError, ValueError) as error:
            raise EpisodeError(
                f"The oracle cannot go on from this state ({error!r} is missing or wrong in it). "
                "The episode is damaged, or was written by another version."
            ) from error

    def _answer(self, observation: Observation, question: Question) -> Answer:
        truth = self._true_answer(question)
        yes = self._yes(observation, question, truth=truth)
        accuracy = self.accuracy_of(question)
        return Answer(
            question=question,
            reply=Reply.YES if yes else Reply.NO,
            p_yes=accuracy if yes else 1 - accuracy,
            source="oracle",
            text="yes" if yes else "no",
        )

    def accuracy_of(self, question: Question) -> float:
        """How reliable it believes itself to be: what its P(yes) says."""
        return self.accuracy

    def right_of(self, question: Question, *, truth: bool) -> float:
        """The probability that a fresh answer is right; by default what it believes."""
        return self.accuracy_of(question)

    def _true_answer(self, question: Question) -> bool:
        match question:
            case FactQuestion():
                return question.true_in(self._truth.holds)
            case ActionQuestion(way=Way.POSSIBLE):
                return self._truth.possible(question.action)
            case ActionQuestion():
                return self._truth.successful(question.action)

    def _yes(self, observation: Observation, question: Question, *, truth: bool) -> bool:
        look, text = observation.look, question.text
        last = self._last.get(text)
        if last is not None and last.look == look:
            return last.yes
        key = (text, truth, look)
        drawn = self._drawn("answer", *key)
        if self.persistent and self._drawn("answer lasts", *key) < self.persistent:
            scene = scene_of(observation, self._truth)
            words = words_drawn_for(
                question, self.words, lambda *words: self._drawn(*words, truth, scene)
            )
            drawn = self._drawn("answer of the scene", words, truth, scene)
        yes = truth if drawn < self.right_of(question, truth=truth) else not truth
        if self.rho and last is not None and last.truth == truth:
            yes = last.yes if self._drawn("answer again", *key) < self.rho else yes
        self._last[text] = _LastAnswer(look, truth, yes)
        return yes

    def _drawn(self, purpose: str, *key: object) -> float:
        return chance(self._seed, self._episode, purpose, *key).random()
