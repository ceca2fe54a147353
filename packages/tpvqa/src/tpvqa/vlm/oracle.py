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
from tpvqa.vlm.out_of_sight import out_of_sight
from tpvqa.vlm.protocol import TruthSource


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
    at an unchanged fact. Otherwise each look is drawn afresh; the draw is a function of seed,
    episode, the question's text, its true answer and the look. As a VLM hears only words, two
    questions in the same words are the same question, and get the same answer within one look.

    Its P(yes) is `accuracy` where it says yes and 1 - `accuracy` where it says no: how reliable
    the model believes itself to be, which is exact by construction.

    Args:
        truth: What is true in the world.
        accuracy: Probability that a fresh answer is right.
        rho: Probability that a further look at an unchanged fact repeats the last answer.
        seed: The user's seed.
        episode: Number of the episode under this seed.

    Raises:
        PluginError: `accuracy` or `rho` is not a probability.
    """

    def __init__(
        self,
        truth: TruthSource,
        *,
        accuracy: float = 1.0,
        rho: float = 0.0,
        seed: int = 0,
        episode: int = 0,
    ) -> None:
        for what, value in (("accuracy", accuracy), ("rho", rho)):
            if not 0 <= value <= 1:
                raise PluginError(f"The oracle's {what} is {value}; it must lie between 0 and 1.")
        self.accuracy, self.rho = float(accuracy), float(rho)
        self._truth, self._seed, self._episode = truth, seed, episode
        self._last: dict[str, _LastAnswer] = {}

    @classmethod
    def from_spec(
        cls, arguments: str, *, truth: TruthSource, seed: int = 0, episode: int = 0
    ) -> "Oracle":
        """Make it from `ACCURACY[:RHO]`; without arguments it never errs.

        Raises:
            PluginError: The arguments are not one or two probabilities.
        """
        words = arguments.split(":") if arguments else []
        try:
            numbers = [float(word) for word in words]
        except ValueError:
            numbers = [-1.0]
        if len(numbers) > 2 or not all(0 <= number <= 1 for number in numbers):
            raise PluginError(
                f"'oracle:{arguments}' is not understood. Write oracle, oracle:ACCURACY or "
                "oracle:ACCURACY:RHO with numbers between 0 and 1, e.g. oracle:0.8:0.5."
            )
        accuracy = numbers[0] if numbers else 1.0
        rho = numbers[1] if len(numbers) > 1 else 0.0
        return cls(truth, accuracy=accuracy, rho=rho, seed=seed, episode=episode)

    @property
    def name(self) -> str:
        """The specification it can be made from again, e.g. "oracle:0.8:0.5"."""
        name = f"oracle:{self.accuracy:g}"
        return f"{name}:{self.rho:g}" if self.rho else name

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order; only the number of the look matters."""
        return [
            out_of_sight(observation, each, self._truth) or self._answer(observation.look, each)
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

    def _answer(self, look: int, question: Question) -> Answer:
        truth = self._true_answer(question)
        accuracy = self.accuracy_of(question)
        yes = self._yes(look, question.text, accuracy, truth=truth)
        return Answer(
            question=question,
            reply=Reply.YES if yes else Reply.NO,
            p_yes=accuracy if yes else 1 - accuracy,
            source="oracle",
            text="yes" if yes else "no",
        )

    def accuracy_of(self, question: Question) -> float:
        """The probability that a fresh answer to a question is right."""
        return self.accuracy

    def _true_answer(self, question: Question) -> bool:
        match question:
            case FactQuestion():
                return question.true_in(self._truth.holds)
            case ActionQuestion(way=Way.POSSIBLE):
                return self._truth.possible(question.action)
            case ActionQuestion():
                return self._truth.successful(question.action)

    def _yes(self, look: int, text: str, accuracy: float, *, truth: bool) -> bool:
        last = self._last.get(text)
        if last is not None and last.look == look:
            return last.yes
        key = (text, truth, look)
        right = chance(self._seed, self._episode, "answer", *key).random() < accuracy
        yes = truth if right else not truth
        if self.rho and last is not None and last.truth == truth:
            again = chance(self._seed, self._episode, "answer again", *key).random()
            yes = last.yes if again < self.rho else yes
        self._last[text] = _LastAnswer(look, truth, yes)
        return yes
