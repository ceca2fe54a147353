"""Noise models with one flaw, for experiments: what a monitor has to find out, and is not told.

Their P(yes) says how right they are but for the flaw: they do not know of it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from tpvqa.chance import chance
from tpvqa.errors import PluginError, UnknownNameError
from tpvqa.pddl import Action, Atom, Task
from tpvqa.plugins import PlainArguments
from tpvqa.questions.question import FactQuestion, Question
from tpvqa.vlm.oracle import Oracle
from tpvqa.vlm.other_words import SHARED, split_words, words_drawn_for
from tpvqa.vlm.protocol import Remembering, TruthSource

SAME = "same"
"""The word that has the same questions misread in every trial of a seed."""
FORMS = (
    "flawed:misread:SHARE[:ACCURACY[:same[:N]]][:words:SHARE], flawed:biased:PREDICATE:YES_IF_TRUE:"
    "YES_IF_FALSE[:ACCURACY], flawed:late[:ACCURACY] or flawed:useless[:CLAIMED], with "
    "numbers between 0 and 1, and N a whole one"
)


@dataclass(frozen=True, slots=True)
class Trial:
    """Which trial it is, and what is true in it.

    Attributes:
        truth: What is true now.
        task: Names the predicates.
        seed: The user's seed.
        episode: Number of the episode under this seed.
        words: How often what lasts in another wording is what lasts in the first one.
    """

    truth: TruthSource
    task: Task
    seed: int
    episode: int
    words: float = SHARED


class Flawed(Oracle, PlainArguments):
    """An oracle with one flaw. The kinds are its subclasses.

    Args:
        trial: Which.
        spec: What it was made from.
        accuracy: Probability that a fresh answer is right, but for the flaw.
        truth: What it answers from; by default what is true now.
    """

    def __init__(
        self, trial: Trial, spec: str, *, accuracy: float, truth: TruthSource | None = None
    ) -> None:
        answers_from = trial.truth if truth is None else truth
        super().__init__(
            answers_from,
            accuracy=accuracy,
            words=trial.words,
            seed=trial.seed,
            episode=trial.episode,
        )
        self._spec = spec

    @classmethod
    def from_spec(  # type: ignore[override]
        cls, arguments: str, *, truth: TruthSource, task: Task, seed: int = 0, episode: int = 0
    ) -> "Flawed":
        """Make it from KIND[:…], see `FORMS`.

        Raises:
            PluginError: There is no such kind, or it is told something else.
            UnknownNameError: The task has no such predicate.
        """
        said, share = split_words(arguments)
        kind, *words = said.split(":")
        if kind not in _KINDS:
            raise UnknownNameError("flaw", kind, _KINDS, remedy=f"Write {FORMS}.")
        trial = Trial(truth, task, seed, episode, share)
        return _KINDS[kind](trial, f"flawed:{arguments}", words)

    @property
    def name(self) -> str:
        """The specification it can be made from again."""
        return self._spec


class Misread(Flawed):
    """A share of the questions is always answered wrongly, whatever is seen.

    Which is drawn by the question's words: in other words the same fact may be read rightly, where
    that is not drawn as for the first wording.

    Args:
        trial: Which.
        spec: What it was made from.
        share: Of the questions.
        accuracy: Probability that a fresh answer to another is right.
        draw: Which draw of such questions: trials with the same one misread the same. By default
            each trial has its own.
    """

    def __init__(
        self, trial: Trial, spec: str, *, share: float, accuracy: float, draw: str | None = None
    ) -> None:
        super().__init__(trial, spec, accuracy=accuracy)
        self.share, self._draw = share, trial.episode if draw is None else draw

    @classmethod
    def told(cls, trial: Trial, spec: str, words: list[str]) -> "Misread":
        """From SHARE[:ACCURACY[:same[:N]]]; every N has other questions misread in every trial."""
        draw = None
        if words[2:3] == [SAME] and (len(words) == 3 or (len(words) == 4 and words[3].isdecimal())):
            draw, words = " ".join(("every trial", *words[3:])), words[:2]
        share, accuracy = _numbers(spec, words, (None, 0.95))
        return cls(trial, spec, share=share, accuracy=accuracy, draw=draw)

    def misreads(self, question: Question) -> bool:
        """Whether a question is one of those that it always answers wrongly."""

        def drawn(purpose: str, words: str) -> float:
            return chance(self._seed, 0, purpose, self._draw, words).random()

        return drawn("misread", words_drawn_for(question, self.words, drawn)) < self.share

    def right_of(self, question: Question, *, truth: bool) -> float:
        """Never, where the question is misread."""
        return 0.0 if self.misreads(question) else self.accuracy


class Biased(Flawed):
    """Says yes too often, or too rarely, of the facts of one predicate.

    Args:
        trial: Which.
        spec: What it was made from.
        predicate: The one.
        yes: Probability of yes of such a fact where it is false, and where it is true.
        accuracy: Probability that a fresh answer to another question is right.

    Raises:
        UnknownNameError: The task has no such predicate.
    """

    def __init__(
        self, trial: Trial, spec: str, *, predicate: str, yes: tuple[float, float], accuracy: float
    ) -> None:
        if predicate not in trial.task.predicates:
            raise UnknownNameError("predicate", predicate, trial.task.predicates)
        super().__init__(trial, spec, accuracy=accuracy)
        self.predicate, self.yes = predicate, yes

    @classmethod
    def told(cls, trial: Trial, spec: str, words: list[str]) -> "Biased":
        """From PREDICATE:YES_IF_TRUE:YES_IF_FALSE[:ACCURACY]."""
        true, false, accuracy = _numbers(spec, words[1:], (None, None, 0.8))
        name = words[0].lower()  # PDDL knows no capitals
        return cls(trial, spec, predicate=name, yes=(false, true), accuracy=accuracy)

    def right_of(self, question: Question, *, truth: bool) -> float:
        """By the two rates of yes, where it is about the predicate."""
        if not isinstance(question, FactQuestion) or question.subject != self.predicate:
            return self.accuracy
        return self.yes[truth] if truth else 1 - self.yes[truth]


class Late(Flawed):
    """Answers as the world was before the last action.

    Args:
        trial: Which.
        spec: What it was made from.
        accuracy: Probability that a fresh answer is right of the world as it was.

    Raises:
        PluginError: The world does not know what was true before.
    """

    def __init__(self, trial: Trial, spec: str, *, accuracy: float) -> None:
        if not isinstance(trial.truth, Remembering):
            kind = type(trial.truth)
            raise PluginError(
                f"{spec!r} answers as the world was before the last action, and the world's truth "
                f"({kind.__module__}.{kind.__qualname__}) has no earlier() that tells. Choose a "
                "simulated world, e.g. 'symbolic'."
            )
        super().__init__(trial, spec, accuracy=accuracy, truth=_Delayed(trial.truth))

    @classmethod
    def told(cls, trial: Trial, spec: str, words: list[str]) -> "Late":
        """From [ACCURACY]."""
        (accuracy,) = _numbers(spec, words, (0.8,))
        return cls(trial, spec, accuracy=accuracy)


class Useless(Flawed):
    """Says yes or no by the toss of a coin, and is as sure of it as one that knows something.

    Args:
        trial: Which.
        spec: What it was made from.
        accuracy: What it claims to be.
    """

    @classmethod
    def told(cls, trial: Trial, spec: str, words: list[str]) -> "Useless":
        """From [CLAIMED]."""
        (claimed,) = _numbers(spec, words, (0.8,))
        return cls(trial, spec, accuracy=claimed)

    def right_of(self, question: Question, *, truth: bool) -> float:
        """By chance."""
        return 0.5


class _Delayed:
    """The truth one action late."""

    def __init__(self, now: Remembering) -> None:
        self._now = now
        self.visible = now.visible

    def holds(self, atom: Atom) -> bool:
        return self._now.earlier().holds(atom)

    def possible(self, action: Action) -> bool:
        return self._now.earlier().possible(action)

    def successful(self, action: Action) -> bool:
        return self._now.earlier().successful(action)

    def scene(self) -> str:
        return self._now.earlier().scene()


def _numbers(spec: str, words: list[str], usual: tuple[float | None, ...]) -> list[float]:
    """The probabilities that are written, and the usual ones for those that are left out."""
    try:
        given = [float(word) for word in words]
    except ValueError:
        given = [-1.0]
    found = [*given, *usual[len(given) :]]
    if len(found) > len(usual) or not all(n is not None and 0 <= n <= 1 for n in found):
        raise PluginError(f"{spec!r} is not understood. Write {FORMS}.")
    return [float(number) for number in found if number is not None]


_KINDS: Mapping[str, Callable[[Trial, str, list[str]], Flawed]] = MappingProxyType(
    {"misread": Misread.told, "biased": Biased.told, "late": Late.told, "useless": Useless.told}
)
