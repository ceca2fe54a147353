"""A set of labelled pictures on disk."""

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar, Generic

from tpvqa.errors import PictureError, PictureSetError, shown
from tpvqa.pictures import read_picture
from tpvqa.worlds.pictures.manifest import MANIFEST, Manifest, P, Picture, digest, read_manifest


class PictureSet(Generic[P]):
    """Pictures on disk.

    Args:
        folder: Holds the pictures and their manifest.
        manifest: What the manifest says.

    Attributes:
        gone: What to do where a picture is missing, for messages.
        lacking: What to do where no picture shows something.
    """

    gone: ClassVar[str] = f"Put it back, or take it out of {MANIFEST}"
    lacking: ClassVar[str] = f"Add a picture of it to the set and its {MANIFEST}"

    def __init__(self, folder: Path, manifest: Manifest[P]):
        self.folder, self.manifest = folder, manifest

    @property
    def facts(self) -> Sequence[str]:
        """Every fact that a picture tells about, as PDDL atoms."""
        manifest = self.manifest
        return manifest.facts or sorted({fact for each in manifest.pictures for fact in each.seen})

    @property
    def paths(self) -> Sequence[Path]:
        """Every file of the set: its manifest, then the pictures."""
        return [
            self.folder / name for name in (MANIFEST, *(p.file for p in self.manifest.pictures))
        ]

    def read(self, picture: P) -> bytes:
        """The encoded picture.

        Raises:
            PictureSetError: Its file is missing, is no picture, or lies elsewhere.
        """
        try:
            return read_picture(picture.file, inside=self.folder)
        except PictureError as error:
            raise PictureSetError(f"{error}. {self.gone}") from error

    def see_domain(self, domain: str) -> None:
        """See that the pictures are of a task's domain.

        Raises:
            PictureSetError: They are of another.
        """
        if self.manifest.domain != domain:
            raise PictureSetError(
                f"{self.folder}: the pictures are of the domain {shown(self.manifest.domain)}, and "
                f"the task is of {shown(domain)}. Name another set"
            )

    def check(self) -> None:
        """See whether all pictures are there, and are those that the manifest means, and whether
        what it says of the same picture twice is the same.

        Raises:
            PictureSetError: One is not.
        """
        self._see_agreed()
        for picture in self.manifest.pictures:
            if digest(self.read(picture)) != picture.sha256:
                raise PictureSetError(
                    f"{self.folder / picture.file}: its SHA-256 is not the manifest's. "
                    f"Put the right picture there, or label it again in {MANIFEST}"
                )

    def _see_agreed(self) -> None:
        said: dict[str, dict[str, tuple[bool, str]]] = {}
        for picture in self.manifest.pictures:
            known, true = said.setdefault(picture.sha256, {}), set(picture.state)
            for fact in sorted(picture.seen):
                holds, file = known.setdefault(fact, (fact in true, picture.file))
                if holds != (fact in true):
                    also = "twice" if file == picture.file else f"as {shown(file)}, too"
                    raise PictureSetError(
                        f"{self.folder / picture.file}: the picture is listed {also}, and of "
                        f"{fact} it is said that it is true and that it is false. Keep one label "
                        f"in {MANIFEST}"
                    )


def load_set(folder: Path) -> PictureSet[Picture]:
    """Open a set of pictures of any domain.

    Raises:
        PictureSetError: There is no manifest, or it is broken.
    """
    manifest: Manifest[Picture] = read_manifest(
        folder,
        Manifest[Picture],
        missing="Name the folder that holds a set of pictures and their manifest",
        broken="Mend it, or make the set again",
    )
    return PictureSet(folder, manifest)
