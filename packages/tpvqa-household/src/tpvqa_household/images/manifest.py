"""The manifest of a set of pictures: one JSON file beside them, checked when it is read."""

import hashlib
from collections import defaultdict
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import Literal as Choice

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from tpvqa.errors import PictureSetError
from tpvqa.pddl import Atom, State
from tpvqa.worlds.images.visible import VisibleState, describe, visible_state

MANIFEST = "manifest.json"
Meshes = Choice["known", "held_out"]
Renderer = Choice["cycles", "mujoco"]
Outcome = Choice["success", "failure"]
OriginKind = Choice["photo", "rendered", "variation", "generated"]
ORIGINS: tuple[OriginKind, ...] = ("photo", "rendered", "variation", "generated")
OUTCOMES: tuple[Outcome, ...] = ("success", "failure")


class _Model(BaseModel):
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
    outcome: Outcome


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


class Picture(_Model):
    """One picture and what is true in it.

    Attributes:
        file: Its name, beside the manifest.
        sha256: Of the file.
        width: Pixels.
        height: Pixels.
        renderer: What rendered it; None where nothing did.
        meshes: "known": objects as in training, in new kitchens; "held_out": objects, grippers
            and dirt that training never saw, as on every photo.
        seed: Of the kitchen; None where it was not rendered.
        look: Of the arrangement and the camera in it.
        visible: What the camera shows, as `visible.describe` writes it.
        number: Tells it from others that show the same, from 0.
        state: The facts that are true in it, as PDDL atoms; all others are false.
        seen: The facts, true or false, that can be told from it.
        shows: The actions that it is an observation of.
        origin: Where it comes from.
    """

    file: str
    sha256: str
    width: int
    height: int
    renderer: Renderer | None = None
    meshes: Meshes
    seed: int | None = None
    look: int = 0
    visible: str
    number: int
    state: tuple[str, ...]
    seen: frozenset[str]
    shows: tuple[Shows, ...]
    origin: Origin = Origin()

    @cached_property
    def true_state(self) -> State:
        """The true state it was made from."""
        return frozenset(map(Atom.parse, self.state))

    @cached_property
    def visible_state(self) -> VisibleState:
        """What the camera shows of that state."""
        return visible_state(self.true_state)

    def holds(self, atom: Atom) -> bool:
        """Whether a fact is true in it."""
        return atom in self.true_state

    def shows_fact(self, atom: Atom) -> bool:
        """Whether the picture shows if a fact is true."""
        return atom.pddl() in self.seen


class Manifest(_Model):
    """All pictures of a set.

    Attributes:
        version: Of this format.
        domain: The PDDL domain that the facts belong to.
        facts: Every fact that a picture tells about, as PDDL atoms.
        pictures: The pictures, by file name.
    """

    version: Choice[1] = 1
    domain: str = "household"
    facts: tuple[str, ...]
    pictures: tuple[Picture, ...] = Field(min_length=1)


class PictureSet:
    """Pictures on disk, indexed by what they show.

    Args:
        folder: Holds the pictures and their manifest.
        manifest: What the manifest says.
    """

    def __init__(self, folder: Path, manifest: Manifest):
        self.folder, self.manifest = folder, manifest
        self._by_visible: dict[str, list[Picture]] = defaultdict(list)
        for picture in manifest.pictures:
            self._by_visible[picture.visible].append(picture)

    def of(self, visible: VisibleState) -> list[Picture]:
        """The pictures of a visible state, in the manifest's order; empty where there are none."""
        return list(self._by_visible.get(describe(visible), ()))

    def read(self, picture: Picture) -> bytes:
        """The encoded picture.

        Raises:
            PictureSetError: Its file is missing.
        """
        try:
            return (self.folder / picture.file).read_bytes()
        except OSError as error:
            raise PictureSetError(
                f"{self.folder / picture.file}: cannot be read ({error.strerror}). "
                "`tpvqa dataset verify` lists what is missing, `tpvqa dataset build` makes it again"
            ) from error


def shipped() -> Path:
    """The folder of the pictures that come with the package."""
    return Path(str(files("tpvqa.worlds.images") / "data"))


def load_pictures(folder: Path | None = None) -> PictureSet:
    """Open a set of pictures, by default the shipped one.

    Raises:
        PictureSetError: There is no manifest, or it is broken.
    """
    folder = folder or shipped()
    path = folder / MANIFEST
    try:
        text = path.read_bytes()
    except OSError as error:
        raise PictureSetError(
            f"{path}: cannot be read ({error.strerror}). Make them with "
            "`tpvqa dataset compose` or `tpvqa dataset build`, or name the folder that holds them"
        ) from error
    try:
        manifest = Manifest.model_validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise PictureSetError(
            f"{path}: {place or 'the file'}: {first['msg']} ({error.error_count()} faults in all). "
            "Make it again with `tpvqa dataset build`"
        ) from error
    return PictureSet(folder, manifest)


def digest(data: bytes) -> str:
    """SHA-256, as the manifest writes it."""
    return hashlib.sha256(data).hexdigest()
