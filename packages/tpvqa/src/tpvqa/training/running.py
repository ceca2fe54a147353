"""A whole training: figures before, learning, figures after, and what was learnt in its place."""

import json
import os
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any, Protocol

from pydantic import TypeAdapter

from tpvqa.errors import TrainingError, WriteError
from tpvqa.files import read_plain, write_whole
from tpvqa.plugins import Closing
from tpvqa.training.example import Example, consistent
from tpvqa.training.protocol import Noticing, Trainer, TrainingSettings
from tpvqa.training.scoring import Scores, answers_to, balanced_by_predicate, scores
from tpvqa.training.splitting import split
from tpvqa.vlm import Answer
from tpvqa.vlm.making import make_vlm

REPORT = "training.json"
_IDENTITY = "identity.json"
_LEARNT = "learnt"
_BEFORE = "before.json"
_ROOM = "Make room, or name another folder with --out"


class Progress(Protocol):
    """A bar that counts one thing after the other."""

    def count(self, what: str) -> None:
        """Count something else from here on."""

    def __call__(self, done: int, total: int) -> None:
        """Show how far it is."""


@dataclass(frozen=True, slots=True)
class Report:
    """What came of a training.

    Attributes:
        vlm: What was trained.
        out: Where what was learnt lies.
        learnt_from: Questions and pictures that it learnt from.
        held_back: Questions and pictures that it was judged by.
        before: Figures on what was held back, before.
        after: The same, after.
        taken_as: The specification of what was trained, for `--vlm`.
        balanced: Balanced accuracy after, by predicate; None where the right answers are all yes
            or all no.
        notices: What the trainer has to say besides.
    """

    vlm: str
    out: Path
    learnt_from: tuple[int, int]
    held_back: tuple[int, int]
    before: Scores
    after: Scores
    taken_as: str
    balanced: Mapping[str, float | None]
    notices: Sequence[str] = ()

    def plain(self) -> dict[str, Any]:
        """As JSON has it."""
        counts = {
            name: dict(zip(("questions", "pictures"), told, strict=True))
            for name, told in (("learnt_from", self.learnt_from), ("held_back", self.held_back))
        }
        return {
            "vlm": self.vlm,
            "out": str(self.out),
            **counts,
            "before": self.before.plain(),
            "after": self.after.plain(),
            "taken_as": self.taken_as,
            "balanced_accuracy_by_predicate": dict(self.balanced),
            "notices": list(self.notices),
        }


def train(
    spec: str,
    trainer: Trainer,
    examples: Sequence[Example],
    out: Path,
    *,
    settings: TrainingSettings,
    held_back: float,
    context: Mapping[str, Any],
    progress: Progress,
    going_on: Callable[[Path], None] = lambda _: None,
) -> Report:
    """Train a VLM, and judge it by pictures that it did not learn from.

    What is under way lies in a folder beside `out`, of the same name with `.part`; the same call
    goes on with it. `out` is there only when all is done.

    Args:
        spec: The VLM.
        trainer: Who trains it.
        examples: Labelled questions about pictures.
        out: The folder to write; must not be there.
        settings: How to train.
        held_back: Share of the pictures that is held back.
        context: What a VLM may ask for by naming it: device, dtype.
        progress: Told how far it is.
        going_on: Called with the folder where an earlier call was stopped.

    Raises:
        TrainingError: `out` is there already, there are too few pictures, or the folder of what is
            under way is of another training.
        WriteError: Something cannot be written.
        TpvqaError: The VLM cannot be asked or trained.
    """
    see_free(out)
    known = consistent(examples)
    learnt, held = split(known, held_back, seed=settings.seed)
    if len({each.truth for each in learnt}) < 2:
        raise TrainingError(
            "All questions that could be learnt from have the same answer. Label pictures where "
            "it is yes, and where it is no"
        )
    part = out.with_name(f"{out.name}.part")
    identity = _identity(spec, settings, held_back, known, context)
    going = _begin(part, identity)
    if going:
        going_on(part)
    before = _before(spec, held, part, settings.seed, context, progress)
    progress.count("training steps")
    try:
        trainer.fit(learnt, part, settings=settings, progress=progress)
    except TrainingError:
        if not going and {each.name for each in part.iterdir()} <= {_IDENTITY, _BEFORE}:
            shutil.rmtree(part, ignore_errors=True)  # so that more pictures may be given
        raise
    folder = part / _LEARNT
    shutil.rmtree(folder, ignore_errors=True)
    trained = trainer.save(folder)
    answers = _answers(trained, held, context, progress, "questions after")
    report = Report(
        spec,
        out,
        _counts(learnt),
        _counts(held),
        before,
        scores(held, answers, seed=settings.seed),
        trained.replace(str(folder), str(out)),
        balanced_by_predicate(held, answers),
        tuple(trainer.notices) if isinstance(trainer, Noticing) else (),
    )
    told = {**report.plain(), "settings": settings.plain(), "held_back_share": held_back}
    _write(folder / REPORT, told)
    try:
        os.rename(folder, out)
    except OSError as error:
        raise WriteError.of(out, error, _ROOM) from error
    shutil.rmtree(part, ignore_errors=True)
    return report


def see_free(out: Path) -> None:
    """See that nothing lies where the result will.

    Raises:
        TrainingError: Something does, or its folder is not there.
    """
    if out.exists() or out.is_symlink():
        raise TrainingError(f"{out} is there already. Remove it, or name another folder with --out")
    if not out.parent.is_dir():
        raise TrainingError(f"{out.parent}: there is no such folder. Make it, or name another")


def _begin(part: Path, identity: str) -> bool:
    """Make the folder of what is under way; whether it was there."""
    path = part / _IDENTITY
    _see_own(part)
    try:
        if part.is_dir() and path.is_file():
            if path.read_bytes() != identity.encode():
                raise TrainingError(
                    f"{part} holds a training that was begun with other pictures or settings. Go "
                    "on with these, or remove that folder"
                )
            return True
        part.mkdir(exist_ok=True)
    except OSError as error:
        raise WriteError.of(part, error, _ROOM) from error
    write_whole(path, identity.encode(), remedy=_ROOM)
    return False


def _see_own(part: Path) -> None:
    """See that the folder of what is under way is one, or may become it: it is removed at the end.

    Raises:
        TrainingError: It is a link, or something else lies in it.
        WriteError: It cannot be read.
    """
    try:
        if not part.is_symlink() and not (part.is_dir() and any(part.iterdir())):
            return
    except OSError as error:
        raise WriteError.of(part, error, _ROOM) from error
    if part.is_symlink() or not (part / _IDENTITY).is_file():
        raise TrainingError(
            f"{part} is where what is under way would lie, and is "
            f"{'a link' if part.is_symlink() else 'a folder that no training made'}. Move it away, "
            "or name another folder with --out"
        )


def _identity(
    spec: str,
    settings: TrainingSettings,
    held_back: float,
    examples: Sequence[Example],
    context: Mapping[str, Any],
) -> str:
    learnt = sha256()
    for each in examples:
        learnt.update(json.dumps([each.picture, each.text, each.truth, each.group]).encode())
    told = {"version": 2, "vlm": spec, "held_back": held_back, "examples": learnt.hexdigest()}
    return json.dumps(told | settings.plain() | dict(context), sort_keys=True)


def _before(
    spec: str,
    held: Sequence[Example],
    part: Path,
    seed: int,
    context: Mapping[str, Any],
    progress: Progress,
) -> Scores:
    """The figures before; kept, as the same call is made again after a stop."""
    path = part / _BEFORE
    if path.is_file():
        try:
            data = read_plain(path)
            told = TypeAdapter(Scores).validate_json(data)
            if told.plain() == json.loads(data):  # no number that is none, nothing besides
                return told
        except (OSError, ValueError):
            pass
        raise TrainingError(
            f"{path} is damaged. Remove it, and the same command counts these figures again"
        )
    before = scores(held, _answers(spec, held, context, progress, "questions before"), seed=seed)
    _write(path, before.plain())
    return before


def _answers(
    spec: str,
    held: Sequence[Example],
    context: Mapping[str, Any],
    progress: Progress,
    what: str,
) -> list[Answer]:
    progress.count(what)
    vlm, _ = make_vlm(spec, context)
    try:
        return answers_to(vlm, held, done=progress)
    finally:
        if isinstance(vlm, Closing):
            vlm.close()


def _counts(examples: Sequence[Example]) -> tuple[int, int]:
    return len(examples), len({each.picture for each in examples})


def _write(path: Path, told: Mapping[str, Any]) -> None:
    write_whole(path, json.dumps(told, indent=1).encode(), remedy=_ROOM)
