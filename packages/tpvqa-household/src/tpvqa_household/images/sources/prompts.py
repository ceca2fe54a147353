"""What generators are asked for in words: YAML files, one for each task, to read and to change."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from tpvqa.errors import PhotosError, suggestion_or_list
from tpvqa.yaml_places import Place, read_yaml
from tpvqa_household.images.manifest import OUTCOMES, Shows
from tpvqa_household.images.sources.labels import Label, file_name

STYLE = "style.yaml"


@dataclass(frozen=True)
class Prompts:
    """The prompts of all actions and outcomes.

    Attributes:
        camera: Said before each.
        variation: Said instead where a picture is varied.
        by_label: For each action and outcome, at least one.
    """

    camera: str
    variation: str
    by_label: Mapping[Shows, tuple[str, ...]]

    def of(self, label: Label, number: int) -> str:
        """The prompt of the picture of this number; they are used in turn."""
        choice = self.by_label[label.shows]
        return f"{self.camera} {choice[number % len(choice)]}"

    def for_variation(self, label: Label, *, as_usual: bool = True) -> str:
        """What a varied picture must still show.

        Args:
            label: What it was got for.
            as_usual: Whether it shows what the prompts say of its label; the facts of a photo may
                differ, and nothing more is said of them.
        """
        said = self.by_label[label.shows][0] if as_usual else "everything that can be seen now."
        return f"{self.variation} {said}"


def shipped_prompts() -> Path:
    """The folder of the prompts that come with the package."""
    return Path(str(files("tpvqa_household.images.sources") / "prompts"))


def read_prompts(labels: Sequence[Label], folder: Path | None = None) -> Prompts:
    """Read the prompts, the user's before those that come with the package.

    Args:
        labels: What prompts are needed of.
        folder: The user's: style.yaml and TASK.yaml, any of them may be absent.

    Raises:
        PhotosError: A file is broken or lacks a prompt; names the place.
    """
    tasks = list(dict.fromkeys(label.shows.task for label in labels))
    if folder is not None:
        known = [STYLE, *(f"{task}.yaml" for task in tasks)]
        if not folder.is_dir():
            raise PhotosError("there is no such folder of prompts", file=folder)
        if not any(os.path.lexists(folder / name) for name in known):
            raise PhotosError(f"none of these files is there: {', '.join(known)}", file=folder)
    style = _open(STYLE, folder).sections("camera", "variation")
    for name in ("camera", "variation"):
        if name not in style:
            raise PhotosError(f"{name!r} is missing", file=_path(STYLE, folder))
    found: dict[Shows, tuple[str, ...]] = {}
    for task in tasks:
        of_task = [label for label in labels if label.shows.task == task]
        found |= _read_task(_open(f"{task}.yaml", folder), of_task)
    return Prompts(style["camera"].text(), style["variation"].text(), found)


def _path(name: str, folder: Path | None) -> Path:
    own = None if folder is None else folder / name
    return own if own is not None and os.path.lexists(own) else shipped_prompts() / name


def _open(name: str, folder: Path | None) -> Place:
    path = _path(name, folder)
    place = read_yaml(path, PhotosError)
    if place is None:
        raise PhotosError("is empty", file=path)
    return place


def _read_task(place: Place, labels: Sequence[Label]) -> dict[Shows, tuple[str, ...]]:
    actions = {file_name(label.shows.action): label.shows.action for label in labels}
    said: dict[tuple[str, str], tuple[str, ...]] = {}
    for name, key, value in place.entries():
        action = file_name(name)
        if action not in actions:
            raise key.wrong(f"the plan has no action {name!r}{suggestion_or_list(action, actions)}")
        for outcome, entry in value.sections(*OUTCOMES).items():
            prompts = tuple(text.text() for text in entry.texts())
            if not prompts:
                raise entry.wrong("expected a prompt, or a list of prompts")
            said[action, outcome] = prompts
    found = {}
    for label in labels:
        prompts = said.get((file_name(label.shows.action), label.shows.outcome), ())
        if not prompts:
            raise PhotosError(
                f"there is no prompt for {label.shows.outcome} of {label.shows.action}",
                file=place.file,
            )
        found[label.shows] = prompts
    return found
