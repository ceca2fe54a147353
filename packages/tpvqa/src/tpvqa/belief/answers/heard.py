"""What was heard of a question: what is known of the scene's own answer, in every joint state.

In a joint state it is known what was true at every answer, and so which of them were wrong. Where
ways come together in one, they are averaged.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.lasting import EVERY, Columns, shares_of, stays_of
from tpvqa.belief.answers.led import Led, Places


class Drawn(NamedTuple):
    """What is known of the scene's own answer, one row for each of several cases.

    Attributes:
        yes: P(it is a yes and was drawn before), for everything that is told apart of the noise.
        new: P(it is not drawn yet).
        kept: P(the fact is what it was at the last answer).
        answers: How many there were in this scene.
        yeses: How many of them were yeses.
    """

    yes: Floats
    new: Floats
    kept: Floats
    answers: Floats
    yeses: Floats

    def only(self, columns: Columns) -> "Drawn":
        """That of some of what is told apart of the noise."""
        return self._replace(yes=self.yes[:, columns], new=self.new[:, columns])

    def elsewhere(self, stays: Floats) -> "Drawn":
        """What that says of another scene.

        Args:
            stays: As of `lasting.Kind`, for everything that is told apart of the noise.
        """
        none = np.zeros_like(self.kept)
        return Drawn(stays * self.yes, stays * self.new + 1 - stays, self.kept, none, none)


@dataclass(slots=True)
class Heard:
    """What was heard of one question, from one view.

    Attributes:
        by_truth: Where yes is right and where no is: two rows, of joint states of which no more is
            known.
        said: How probable the answers in this scene were so, as logarithms for everything that is
            told apart of the noise; None where none came.
        numbers: Of the joint states of which more is known.
        rows: What is known in them.
        true: P(yes is right) by all that is told apart, before anything was done; None where it is
            as the belief has it.
        believed: As the belief had it after the last answer.
    """

    by_truth: Drawn | None = None
    numbers: tuple[int, ...] = ()
    rows: Drawn | None = None
    true: Floats | None = None
    believed: float = 0.5
    said: Floats | None = None

    def drawn(
        self,
        numbers: tuple[int, ...],
        truth: NDArray[np.bool_],
        size: int,
        columns: Columns = EVERY,
    ) -> Drawn:
        """What is known in joint states.

        Args:
            numbers: Theirs; none where nothing was done, for where yes is right and where no is.
            truth: Whether yes is right in them.
            size: How much is told apart of the noise.
            columns: Of which of that.
        """
        first = _never(size) if self.by_truth is None else self.by_truth
        if not isinstance(columns, slice):
            first = first.only(columns)
        if not numbers:
            return first
        rows = self.rows
        if rows is not None and not isinstance(columns, slice):
            rows = rows.only(columns)
        if rows is not None and numbers == self.numbers:
            return rows
        unknown = np.where(truth, 0, 1)
        if rows is None:
            return Drawn(*(each[unknown] for each in first))
        taken = _places(self.numbers, numbers)
        taken = np.where(taken < 0, unknown, taken + 2)
        return Drawn(*(np.concatenate(each)[taken] for each in zip(first, rows, strict=True)))

    def told(self, numbers: tuple[int, ...], drawn: Drawn) -> None:
        """Take in what is known after an answer; arguments as those of `drawn`, and its result."""
        if numbers:
            self.numbers, self.rows = numbers, drawn
        else:
            self.by_truth = drawn

    def begun(self, present: NDArray[np.bool_], drawn: Drawn) -> Drawn:
        """What is known where yes is right and where no is, before an answer in this scene.

        Args:
            present: Which of the two some joint state has.
            drawn: What is known in these, on the average.
        """
        if self.said is not None and self.by_truth is not None:
            return self.by_truth
        none = _never(drawn.yes.shape[1]) if self.by_truth is None else self.by_truth
        taken = np.where(present, [0, 1], [2, 3])
        return Drawn(*(np.concatenate(each)[taken] for each in zip(drawn, none, strict=True)))

    def say(self, likely: Floats, drawn: Drawn) -> None:
        """Take in an answer where yes is right and where no is.

        Args:
            likely: Its probability (two rows), for everything that is told apart of the noise.
            drawn: What is known then.
        """
        said = np.log(np.maximum(likely, 1e-300))
        self.by_truth, self.said = drawn, said if self.said is None else self.said + said

    def elsewhere(self, columns: Columns = EVERY) -> "Heard":
        """What that says of another view.

        Args:
            columns: Of which of all that is told apart of the noise it is.
        """
        first, rows = (
            each and each.elsewhere(stays_of(each.yes.shape[-1], columns))
            for each in (self.by_truth, self.rows)
        )
        return Heard(first, self.numbers, rows, self.true, self.believed)

    def acted(self, led: Led | None, truth: Mapping[int, bool]) -> None:
        """Go on after an action.

        Where nothing was changed the scene's own answer is what it was; where something was, that
        it is a misreading, or none, may stay, and where the fact has changed, so has the answer.

        Args:
            led: Where joint states have led; None where that is not known.
            truth: In which joint states yes is right.
        """
        self.said = None
        if led is None:
            self.numbers, self.rows, self.by_truth = (), None, None
            return
        was, now = (np.array([truth[n] for n in each]) for each in (led.before, led.after))
        known = Drawn(*(k[led.begun] for k in self.drawn(led.before, was, led.mixed.shape[1])))
        turns = (was[led.begun] != now[led.came])[:, None]
        stays = np.where(led.same[:, None], 1.0, stays_of(led.mixed.shape[1], led.columns))
        yes = stays * np.where(turns, np.maximum(1 - known.yes - known.new, 0.0), known.yes)
        new = 1 - stays * (1 - known.new)
        kept = np.where(turns[:, 0], 1 - known.kept, known.kept)
        once = np.stack([kept, led.same * known.answers, led.same * known.yeses])
        drawn = Drawn(led.carried(yes), led.carried(new), *led.averaged(once))
        if self.by_truth is not None:
            lasts = stays_of(led.mixed.shape[1], led.columns)
            self.by_truth = self.by_truth.elsewhere(lasts)
        self.told(led.after, drawn)

    def tell_apart(self, taken: Places) -> None:
        """Go on with other columns, each with what is known of one until now."""
        self.by_truth, self.rows = (
            each and each.only(taken) for each in (self.by_truth, self.rows)
        )
        self.said = None if self.said is None else self.said[:, taken]

    def renumbered(self, numbers: Mapping[int, int]) -> None:
        """Go on with other numbers of the joint states."""
        if self.rows is None:
            return
        kept = [place for place, number in enumerate(self.numbers) if number in numbers]
        self.rows = Drawn(*(each[kept] for each in self.rows))
        self.numbers = tuple(numbers[self.numbers[place]] for place in kept)


@lru_cache(maxsize=64)
def _places(known: tuple[int, ...], numbers: tuple[int, ...]) -> NDArray[np.intp]:
    """Where some joint states stand among those that are known; -1 where they do not."""
    places = {number: place for place, number in enumerate(known)}
    return np.array([places.get(number, -1) for number in numbers], np.intp)


def own(drawn: Drawn, rate: Floats) -> Floats:
    """P(the scene's own answer is a yes), where one that is not drawn yet is with a rate."""
    found: Floats = np.clip(drawn.yes + drawn.new * rate, 0.0, 1.0)  # what is above 1 would grow
    return found


def after_answer(
    yes: bool, own_yes: Floats, rate: Floats, repeated: Floats, columns: Columns = EVERY
) -> Floats:
    """P(the scene's own answer is a yes) after an answer.

    Args:
        yes: Whether it is a yes.
        own_yes: The same before.
        rate: P(yes) of one drawn afresh.
        repeated: Probability that it is the answer before once more.
        columns: Of which of all that is told apart of the noise.
    """
    shares = shares_of(own_yes.shape[-1], columns)
    this, fresh = (own_yes, rate) if yes else (1 - own_yes, 1 - rate)
    agrees = this * (shares + (1 - shares) * fresh)
    agrees = agrees / np.maximum(shares * this + (1 - shares) * fresh, 1e-12)
    found: Floats = repeated * own_yes + (1 - repeated) * (agrees if yes else 1 - agrees)
    return found


@lru_cache(maxsize=128)
def _never(size: int) -> Drawn:
    nothing, none = np.zeros((2, size)), np.zeros(2)
    return Drawn(nothing, nothing + 1, none + 1, none, none)
