"""A person labelling: one question after the other, back and forth."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

from tpvqa.episodes.log import episode_folder
from tpvqa.errors import CalibrationError
from tpvqa.labelling.labels import Labels, Said
from tpvqa.labelling.order import Order, Standing
from tpvqa.labelling.recorded import Asking, check_apart, read_recorded, said_in_trial

KEYS: dict[str, Said] = {"y": "yes", "n": "no", "c": "cannot see"}
"""Keys that label. The others are s (skip), b (back) and q (quit)."""


@dataclass(frozen=True, slots=True)
class Progress:
    """How far it has come.

    Attributes:
        labels: Labels yes or no, those of earlier sessions included.
        cannot_see: Labels that say that the pictures do not tell.
        skipped: Questions that were skipped now; they come again the next time.
        standing: What is known by the labels.
        answers: Answers of the VLM that the labels are about.
    """

    labels: int
    cannot_see: int
    skipped: int
    standing: Standing
    answers: int


class Session:
    """Goes through the questions of recorded episodes, and keeps labels beside their logs.

    Use it as a context manager: it closes the files.

    Args:
        folders: The episodes'.
        vlm: Whose answers to label; by default whoever answered in the first.

    Attributes:
        vlm: Whose answers they are.
        now: The question to label now; None where there is none left.
        notice: What to tell of the last label: what others have labelled meanwhile; mostly empty.

    Raises:
        CalibrationError: Different VLMs answered in the episodes, one is a copy of another,
            nothing was asked in any, or labels that there are are damaged.
        EpisodeError: There is no episode, or it is damaged.
    """

    def __init__(self, folders: Sequence[Path | str], *, vlm: str | None = None):
        episodes = [read_recorded(folder) for folder in dict.fromkeys(map(episode_folder, folders))]
        check_apart(episodes)
        self.vlm = vlm or episodes[0].started.vlm
        for episode in episodes:
            check_vlm(episode.folder, episode.started.vlm, self.vlm)
        self.order = Order([asking for episode in episodes for asking in episode.askings])
        if not self.order.askings:
            raise CalibrationError(
                f"Nothing was asked in {', '.join(map(str, folders))}: give episodes of a monitor "
                "that asks, e.g. --monitor tpvqa"
            )
        self._labels = {episode.folder: Labels(episode) for episode in episodes}
        self._skipped: list[Asking] = []
        self._behind: list[Asking] = []
        self._standing: Standing | None = None
        self.notice = ""
        self.now = self.order.next(self.label_of)

    def label_of(self, asking: Asking) -> Said | None:
        """The label of a question, or what a person answered in the trial; None for neither."""
        return self._labels[asking.episode].known.get(asking.key) or said_in_trial(asking)

    @property
    def progress(self) -> Progress:
        """How far it has come."""
        told = [(each, self.label_of(each)) for each in self.order.askings]
        sure = [each for each, said in told if said in ("yes", "no")]
        if self._standing is None:
            self._standing = self.order.standing(self.label_of)
        return Progress(
            labels=len(sure),
            cannot_see=sum(said == "cannot see" for _, said in told),
            skipped=len(self._skipped),
            standing=self._standing,
            answers=sum(len(each.of_vlm) for each in sure),
        )

    def say(self, said: Said) -> None:
        """Label the question; the next one comes.

        Where another session has labelled the question since this one read the labels, that label
        stays, and `notice` says so.

        Raises:
            WriteError: The label cannot be written.
            CalibrationError: Another process labels this episode.
        """
        self.notice = ""
        if self.now is None:
            return
        labels = self._labels[self.now.episode]
        seen = len(labels.meanwhile)
        kept = labels.append(self.now, said)
        self._tell_others(labels, new=len(labels.meanwhile) - seen, kept=kept)
        self._standing = None
        self._go_on(self.now)

    def _tell_others(self, labels: Labels, *, new: int, kept: bool) -> None:
        if new <= 0 or self.now is None:
            return
        given = "1 label was" if new == 1 else f"{new} labels were"
        self.notice = f"{given} given in {self.now.episode} by another session meanwhile, and count"
        if not kept:
            self.notice += (
                f"; this question was labelled {self.label_of(self.now)!r} there, and stays so: go "
                "back to label it anew"
            )

    def skip(self) -> None:
        """Leave the question for another time; the next one comes."""
        self.notice = ""
        if self.now is None:
            return
        self._skipped.append(self.now)
        self._go_on(self.now)

    def back(self) -> bool:
        """Go back to the question before, to label it anew; whether there is one."""
        self.notice = ""
        if not self._behind:
            return False
        self.now = self._behind.pop()
        self._skipped = [each for each in self._skipped if each is not self.now]
        return True

    def _go_on(self, done: Asking) -> None:
        self._behind.append(done)
        self.now = self.order.next(self.label_of, self._skipped)

    def close(self) -> None:
        """Close the files."""
        for labels in self._labels.values():
            labels.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def check_vlm(folder: Path | str, answered: str, wanted: str) -> None:
    """See that a VLM answered in an episode.

    Raises:
        CalibrationError: Another one did.
    """
    if answered != wanted:
        raise CalibrationError(
            f"{folder}: {answered} answered in it, not {wanted}. A calibration is of one VLM: "
            "give the episodes of each apart"
        )
