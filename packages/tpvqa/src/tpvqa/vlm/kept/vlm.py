"""Answers from a file, and from a VLM where the file has none: to whoever asks it is that VLM."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from typing import Any, Protocol, runtime_checkable

from tpvqa.errors import CacheError, EpisodeError
from tpvqa.observation import Observation
from tpvqa.plugins import Checked, Closing
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import Answer
from tpvqa.vlm.capabilities import StandsIn, is_deterministic
from tpvqa.vlm.checking import ask_checked
from tpvqa.vlm.kept.file import ANYBODY, AnswerFile, Asking
from tpvqa.vlm.kept.fingerprint import picture_of
from tpvqa.vlm.protocol import VLM


@runtime_checkable
class _Restorable(Protocol):
    """As `tpvqa.worlds.Restorable`, which this room does not know."""

    def snapshot(self) -> Mapping[str, Any]: ...

    def restore(self, snapshot: Mapping[str, Any]) -> None: ...


class Use(StrEnum):
    """How recorded answers are used."""

    CACHE = "cache"  # what is there is given, the rest asked and written
    RECORD = "record"  # all is asked and written
    REPLAY = "replay"  # nothing is asked


class KeptVLM(StandsIn):
    """Gives the answers of a VLM from a file, and writes those that are not there.

    Within one look the same question gets the same answer. A VLM may answer differently when the
    very same pictures come again at a later look of a trial: the n-th look that shows them is
    answered with the n-th draw, of which there may be many. One that is deterministic has one.

    Args:
        file: Of answers; closed with this.
        model: The number of VLM and parameters in the file.
        use: How the file is used.
        name: What the log calls the VLM.
        stands_for: The VLM's class.
        inner: The VLM; None for replaying.
        trial: Tells the trial that asks from others; None where each asking is for itself.
        owned: Whether the VLM is closed with this, too.

    Attributes:
        given: Questions that were answered from the file.
        asked: Questions that the VLM was asked.
    """

    def __init__(
        self,
        file: AnswerFile,
        model: int,
        *,
        use: Use,
        name: str,
        stands_for: type,
        inner: VLM | None,
        trial: bytes | None,
        owned: bool = False,
    ):
        self.file, self.use, self.stands_for = file, use, stands_for
        self.inner: VLM | None = inner
        self._model, self._name, self._owned = model, name, owned
        self._trial, self._fixed = trial, is_deterministic(stands_for)
        self.given = self.asked = 0
        self._looks: dict[str, list[int]] = {}
        self._now: tuple[int, bytes] = (-1, b"")
        self._told: dict[str, Answer] = {}

    @property
    def name(self) -> str:
        """That of the VLM."""
        return self._name

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order, each text once within a look.

        Raises:
            CacheError: The file cannot be read or written, an answer is not there and nobody is
                to be asked, or the look has no picture.
            AnswerError: The VLM cannot be asked at all.
        """
        if not observation.frames:
            raise CacheError(
                f"{self.file.path}: answers are recorded by their pictures, and this look has "
                "none. Leave the file out"
            )
        picture = picture_of(observation)
        if (observation.look, picture) != self._now:
            self._now, self._told = (observation.look, picture), {}
        new = {each.text: each for each in questions if each.text not in self._told}
        if new:
            self._told |= self._answered(observation, picture, list(new.values()))
        return [replace(self._told[each.text], question=each) for each in questions]

    def _answered(
        self, observation: Observation, picture: bytes, questions: list[Question]
    ) -> dict[str, Answer]:
        trial = ANYBODY if self._fixed or self._trial is None else self._trial
        draw = 0 if self._fixed else self._draw(observation.look, picture.hex()[:12])
        asking = Asking(self._model, picture, trial, draw)
        found: dict[str, Answer] = {}
        if self.use is not Use.RECORD:
            whatever = self._fixed or self.use is Use.REPLAY
            found = self.file.find(asking, questions, unknown=whatever)
        missing = [each for each in questions if each.text not in found]
        self.given += len(found)
        if not missing:
            return found
        if self.inner is None:
            raise self._unseen(observation, picture, draw, missing)
        self.asked += len(missing)
        given = ask_checked(self.inner, observation, missing)
        if self.use is Use.CACHE:
            return found | self._kept(asking, given)
        self.file.write(asking, given, append=self._trial is None and not self._fixed)
        return {answer.question.text: answer for answer in given}

    def _kept(self, asking: Asking, given: Sequence[Answer]) -> dict[str, Answer]:
        if self._fixed:
            self.file.write(asking, given)
            return {answer.question.text: answer for answer in given}
        return self.file.keep(asking, given)

    def _draw(self, look: int, picture: str) -> int:
        """How many earlier looks showed the very same and were asked about."""
        looks = self._looks.setdefault(picture, [])
        if look not in looks:
            looks.append(look)
        return looks.index(look)

    def _unseen(
        self, observation: Observation, picture: bytes, draw: int, missing: Sequence[Question]
    ) -> CacheError:
        source = ", ".join(filter(None, (each.source for each in observation.frames.values())))
        again = "" if not draw else f", seen {draw + 1} times"
        return CacheError(
            f"{self.file.path}: {self._name} has no recorded answer to {missing[0].text!r} about "
            f"the picture of look {observation.look}{again} "
            f"({source and f'{source}, '}{picture.hex()}). Record it with --cache instead of "
            "--replay"
        )

    def check(self) -> None:
        """See whether the VLM is there, where it may be asked."""
        if isinstance(self.inner, Checked):
            self.inner.check()

    def close(self) -> None:
        """Close the file, and the VLM where it belongs to this. Can be called twice."""
        self.file.close()
        if self._owned and isinstance(self.inner, Closing):
            self.inner.close()


class CountingVLM(KeptVLM):
    """One whose answers depend on what was asked before, which a log has to hold to be gone on
    with."""

    def snapshot(self) -> Mapping[str, Any]:
        """Which looks showed the same, and the state of the VLM where it has one."""
        inner = self.inner.snapshot() if isinstance(self.inner, _Restorable) else None
        return {"looks": {name: list(looks) for name, looks in self._looks.items()}, "vlm": inner}

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave; what the VLM itself gave without this goes to it.

        Raises:
            EpisodeError: It is not such a snapshot.
        """
        inner: Any = snapshot
        if snapshot.keys() == {"looks", "vlm"}:
            inner, looks = snapshot["vlm"], snapshot["looks"]
            try:
                self._looks = {str(name): list(map(int, known)) for name, known in looks.items()}
            except (AttributeError, TypeError, ValueError) as error:
                raise EpisodeError(
                    f"What the log keeps of recorded answers is damaged ({error}). Show the "
                    "episode instead"
                ) from error
        if inner is not None and isinstance(self.inner, _Restorable):
            self.inner.restore(inner)


def keeps_state(vlm: object) -> bool:
    """Whether a VLM has a state that a log has to hold."""
    return isinstance(vlm, _Restorable)
