"""Sets of labelled pictures that a command names."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from tpvqa.cli.saying import tell

if TYPE_CHECKING:
    from tpvqa.questions import QuestionBook
    from tpvqa.worlds.pictures import PictureSet
    from tpvqa.worlds.pictures.manifest import Picture

SHIPPED = "shipped"
_NAMED = 5


def opened_set(where: str, books: "Sequence[QuestionBook] | None") -> "PictureSet[Picture]":
    """The set of a folder, or the shipped one; what is odd about its facts is told.

    Args:
        where: The folder, or `SHIPPED`.
        books: The user's own questions, where they named some.

    Raises:
        TpvqaError: There is no such set, it is of another domain than the questions, or a picture
            is not the one that its manifest means.
    """
    from tpvqa.bench.picture_facts import see_facts
    from tpvqa.worlds.pictures import load_set

    if where == SHIPPED:
        return load_set(shipped_set())
    opened = load_set(Path(where))
    if books:
        opened.see_domain(books[0].task.domain_name)
        for notice in see_facts(opened, books[0].task):
            tell(f"note: {notice}", error=True)
    opened.check()
    for notice in _see_shown(opened):
        tell(f"note: {notice}", error=True)
    return opened


def _see_shown(opened: "PictureSet[Picture]") -> Iterator[str]:
    """What is to be told of pictures in which nothing is to be seen."""
    from tpvqa.bench.labelled_pictures import look_at
    from tpvqa.vlm.sight import picture_fault
    from tpvqa.worlds.pictures import MANIFEST

    faults = {
        picture.file: why
        for picture in opened.manifest.pictures
        for frame in look_at(opened, picture, 0).frames.values()
        if (why := picture_fault(frame))
    }
    for file, why in list(faults.items())[:_NAMED]:
        yield (
            f"{opened.folder / file}: {why}, so that nothing can be told from it. Mend it, or take "
            f"it out of {MANIFEST}"
        )
    if len(faults) > _NAMED:
        yield f"and so it is with {len(faults) - _NAMED} more pictures"


def shipped_set() -> Path:
    """The pictures that come with the shipped tasks.

    Raises:
        CalibrationError: There are none, or several sets.
    """
    from tpvqa.distributions import HOUSEHOLD, how_to_install
    from tpvqa.errors import CalibrationError
    from tpvqa.tasks import shipped_tasks

    found = sorted({files.pictures for files in shipped_tasks() if files.pictures is not None})
    if not found:
        raise CalibrationError(
            "No pictures are shipped with what is installed. Those of the household come with "
            f"{HOUSEHOLD}: {how_to_install(HOUSEHOLD)}."
        )
    if len(found) > 1:
        folders = ", ".join(map(str, found))
        raise CalibrationError(f"Several sets of pictures are installed: name one of {folders}.")
    return found[0]
