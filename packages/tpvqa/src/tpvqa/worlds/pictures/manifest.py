"""The manifest of a set of pictures: one JSON file beside them, checked when it is read.

A package with more to say of its pictures makes subclasses of `Picture` and `Manifest`. Fields that
a reader does not know are passed over, so that every set can be read as a plain one.
"""

import hashlib
import re
from functools import cached_property, lru_cache
from json import JSONDecodeError
from pathlib import Path
from typing import Annotated, Generic, TypeVar
from typing import Literal as Choice

from pydantic import AfterValidator, ConfigDict, Field, ValidationError

from tpvqa.errors import PictureError, PictureSetError
from tpvqa.pddl import Atom, State
from tpvqa.pddl.arithmetic import COMPARISONS
from tpvqa.pictures import read_file
from tpvqa.told import ToldModel, check_names, first_fault

MANIFEST = "manifest.json"
_LONGEST_NAME = 300
_MOST_BYTES = 128 * 2**20  # 360 pictures take 0.5 MB


def _name(text: str) -> str:
    """Something that messages may repeat."""
    if len(text) > _LONGEST_NAME or not text.isprintable():
        raise ValueError(f"write it in one line of at most {_LONGEST_NAME} characters")
    return text


_WORD = r"[^\s(),]+"
_ATOM = re.compile(
    rf"\s*(\(\s*{_WORD}(\s+{_WORD})*\s*\)|{_WORD}(\s+{_WORD})*"
    rf"|{_WORD}\(\s*({_WORD}(\s*,\s*{_WORD})*)?\s*\))\s*"
)


@lru_cache(maxsize=4096)
def fact(text: str) -> str:
    """A fact as PDDL writes it.

    Raises:
        ValueError: It is none; `Atom.parse` overlooks a parenthesis too many or too few.
    """
    atom = Atom.parse(_name(text))
    if atom.predicate not in COMPARISONS and not _ATOM.fullmatch(text):
        raise ValueError(f"{text!r} is not an atom; write it as (predicate object …)")
    return atom.pddl()


Fact = Annotated[str, AfterValidator(fact)]


def _below(file: str) -> str:
    """The name of a file that lies beside the manifest or in a folder there."""
    if any(part in ("", ".", "..") for part in _name(file).split("/")):
        raise ValueError("name a file that lies in the manifest's folder, e.g. left.png")
    return file


File = Annotated[str, AfterValidator(_below)]


class Picture(ToldModel):
    """One picture and what is true in it.

    Attributes:
        file: Its name, beside the manifest or in a folder there; no link.
        sha256: Of the file.
        state: The facts that are true in it, as PDDL atoms; all others are false.
        seen: The facts, true or false, that can be told from it.
        visible: Names what is visible in it: the same for pictures that look alike. Without it,
            pictures look alike that show the same facts.
        group: Names pictures that were taken together, of one scene or in one home: in training
            none of a group is learnt from where others are held back. Without it, each picture is
            by itself.
    """

    model_config = ConfigDict(frozen=True, extra="ignore")

    file: File
    sha256: str
    state: tuple[Fact, ...]
    seen: frozenset[Fact]
    visible: str = ""
    group: Annotated[str, AfterValidator(_name)] = ""

    @cached_property
    def true_state(self) -> State:
        """The true state it was made from."""
        return frozenset(map(Atom.parse, self.state))

    @property
    def scene(self) -> str:
        """What is visible in it."""
        true = set(self.state)
        told = (fact if fact in true else f"(not {fact})" for fact in sorted(self.seen))
        return self.visible or " ".join(told)

    def holds(self, atom: Atom) -> bool:
        """Whether a fact is true in it."""
        return atom in self.true_state

    def shows_fact(self, atom: Atom) -> bool:
        """Whether the picture shows if a fact is true."""
        return atom.pddl() in self.seen


P = TypeVar("P", bound=Picture)


class Manifest(ToldModel, Generic[P]):
    """All pictures of a set.

    Attributes:
        version: Of this format.
        domain: The name of the PDDL domain that the facts belong to.
        facts: Every fact that a picture tells about, as PDDL atoms; without them, those that are
            seen in some picture.
        pictures: The pictures.
    """

    model_config = ConfigDict(frozen=True, extra="ignore")

    version: Choice[1] = 1
    domain: Annotated[str, AfterValidator(_name)]
    facts: tuple[Fact, ...] = ()
    pictures: tuple[P, ...] = Field(min_length=1)


M = TypeVar("M", bound=Manifest)  # type: ignore[type-arg]  # of whatever pictures


def read_manifest(folder: Path, kind: type[M], *, missing: str, broken: str) -> M:
    """Read the manifest of a folder.

    Args:
        folder: Holds it.
        kind: What to read it as.
        missing: What to do where there is none, for the message.
        broken: What to do where it is not as it should be.

    Raises:
        PictureSetError: There is no manifest, or it is broken.
    """
    path = folder / MANIFEST
    try:
        text = read_file(MANIFEST, inside=folder, most=_MOST_BYTES)
    except PictureError as error:
        raise PictureSetError(f"{error}. {missing}") from error
    try:
        check_names(text)
    except (JSONDecodeError, UnicodeDecodeError, RecursionError):
        pass  # the model that it is read into says so
    except ValueError as error:  # of two labels one would count, and nobody knows which is meant
        raise PictureSetError(f"{path}: {error} in one object. {broken}") from None
    try:
        return kind.model_validate_json(text)
    except ValidationError as error:
        first = first_fault(error)
        if first["loc"] == ("pictures",) and first["type"] == "too_short":
            raise PictureSetError(f"{path}: the set has no pictures. {broken}") from error
        place = ".".join(map(str, first["loc"]))
        raise PictureSetError(f"{path}: {place or 'the file'}: {first['msg']}. {broken}") from error


def digest(data: bytes) -> str:
    """SHA-256, as the manifest writes it."""
    return hashlib.sha256(data).hexdigest()


def media_type(file: str) -> str:
    """What a picture's file holds, by its name."""
    return "image/png" if file.lower().endswith(".png") else "image/jpeg"
