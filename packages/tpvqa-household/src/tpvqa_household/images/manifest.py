"""The manifest of a set of pictures: one JSON file beside them, checked when it is read."""

from collections import defaultdict
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import ClassVar
from typing import Literal as Choice

from pydantic import ConfigDict

from tpvqa.errors import PictureSetError, WorldError
from tpvqa.told import ToldModel
from tpvqa.worlds.pictures import MANIFEST
from tpvqa.worlds.pictures import Manifest as AnyManifest
from tpvqa.worlds.pictures import Picture as AnyPicture
from tpvqa.worlds.pictures import PictureSet as AnyPictureSet
from tpvqa.worlds.pictures.manifest import Fact, read_manifest
from tpvqa_household.images.visible import VisibleState, describe, visible_state

Meshes = Choice["known", "held_out"]
Renderer = Choice["cycles", "mujoco"]
ActionResult = Choice["success", "failure"]
OriginKind = Choice["photo", "rendered", "variation", "generated"]
ORIGINS: tuple[OriginKind, ...] = ("photo", "rendered", "variation", "generated")
OUTCOMES: tuple[ActionResult, ...] = ("success", "failure")
BROKEN = (
    "Mend it, or move it away and give the command again that made the set: `tpvqa dataset "
    "compose` takes up the pictures that lie there, `tpvqa dataset build` renders them anew"
)
"""What to do where the manifest of a set is not as it should be."""


class _Model(ToldModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Shows(_Model):
    """An action that a picture is an observation of.

    Attributes:
        task: The task.
        action: The action without hands, e.g. `find(plate)`.
        outcome: Whether it is what is seen after a success or after a failure.
    """

    task: str
    action: str
    outcome: ActionResult


class Origin(_Model):
    """Where a picture comes from.

    Attributes:
        kind: "photo": taken by a camera; "rendered": by this package, also where it stands in for
            a photo; "variation": of another picture; "generated": from a prompt.
        got_for: The action and outcome that it was got for, in a set that was composed.
        source: The file that it is, or is a variation of: below the folder of photos, or of the
            set that comes with the package.
        source_sha256: Of that file.
        prompt: What a generator was asked for, where it was asked in words.
        generator: What made it, e.g. "openai:MODEL".
        seed: What the generator was given, where it takes one; tells requests apart otherwise.
        cost: Dollars, where known.
    """

    kind: OriginKind = "rendered"
    got_for: Shows | None = None
    source: str = ""
    source_sha256: str = ""
    prompt: str = ""
    generator: str = ""
    seed: int | None = None
    cost: float | None = None


class Picture(AnyPicture):
    """One picture of the household and what is true in it.

    Attributes:
        width: Pixels.
        height: Pixels.
        renderer: What rendered it; None where nothing did.
        meshes: "known": objects as in training, in new kitchens; "held_out": objects, grippers
            and dirt that training never saw, as on every photo.
        seed: Of the kitchen; None where it was not rendered.
        look: Of the arrangement and the camera in it.
        visible: What the camera shows, as `visible.describe` writes it. Pictures look alike that
            are of the same.
        number: Tells it from others that show the same, from 0.
        shows: The actions that it is an observation of.
        origin: Where it comes from.
    """

    model_config = ConfigDict(extra="forbid")

    width: int
    height: int
    renderer: Renderer | None = None
    meshes: Meshes
    seed: int | None = None
    look: int = 0
    visible: str
    number: int
    shows: tuple[Shows, ...]
    origin: Origin = Origin()

    @cached_property
    def visible_state(self) -> VisibleState:
        """What the camera shows of that state."""
        return visible_state(self.true_state)

    @property
    def impossible(self) -> str | None:
        """Why no kitchen is in that state; None where one can be."""
        try:
            self.visible_state  # noqa: B018 — for what it raises
        except WorldError as error:
            return f"its facts are no state of the kitchen: {error} Label it again in {MANIFEST}"
        return None


class Manifest(AnyManifest[Picture]):
    """All pictures of a set of the household, by file name."""

    model_config = ConfigDict(extra="forbid")

    domain: str = "household"
    facts: tuple[Fact, ...]


class PictureSet(AnyPictureSet[Picture]):
    """Pictures on disk, indexed by what they show.

    Args:
        folder: Holds the pictures and their manifest.
        manifest: What the manifest says.
    """

    gone: ClassVar[str] = (
        "`tpvqa dataset verify` lists what is missing, `tpvqa dataset build` makes it again"
    )
    lacking: ClassVar[str] = "`tpvqa dataset verify` lists what the set lacks"

    def __init__(self, folder: Path, manifest: Manifest):
        super().__init__(folder, manifest)
        self._by_visible: dict[str, list[Picture]] = defaultdict(list)
        for picture in manifest.pictures:
            self._by_visible[picture.visible].append(picture)

    def check(self) -> None:
        """As for any set; and whether the kitchen can be as it is said of each picture.

        Raises:
            PictureSetError: A picture is not as it should be.
        """
        super().check()
        for picture in self.manifest.pictures:
            if (why := picture.impossible) is not None:
                raise PictureSetError(f"{self.folder / picture.file}: {why}")

    def of(self, visible: VisibleState) -> list[Picture]:
        """The pictures of a visible state, in the manifest's order; empty where there are none."""
        return list(self._by_visible.get(describe(visible), ()))


def shipped() -> Path:
    """The folder of the pictures that come with the package."""
    return Path(str(files("tpvqa_household.images") / "data"))


def load_pictures(folder: Path | None = None) -> PictureSet:
    """Open a set of pictures, by default the shipped one.

    Raises:
        PictureSetError: There is no manifest, or it is broken.
    """
    folder = folder or shipped()
    manifest = read_manifest(
        folder,
        Manifest,
        missing="Make them with `tpvqa dataset compose` or `tpvqa dataset build`, or name the "
        "folder that holds them",
        broken=BROKEN,
    )
    return PictureSet(folder, manifest)
