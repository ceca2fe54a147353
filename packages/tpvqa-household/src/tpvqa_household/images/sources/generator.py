"""What varies pictures and makes them from prompts: the seam for one's own generator."""

from dataclasses import dataclass, field
from typing import Protocol

from tpvqa_household.images.manifest import Picture, Renderer


@dataclass(frozen=True)
class Original:
    """A picture that is to be varied.

    Attributes:
        data: The encoded picture.
        prompt: What is asked for, for generators that want it said.
        picture: Its entry in a manifest, where it was rendered: from this the same true state can
            be rendered again. None for a photo.
    """

    data: bytes = field(repr=False)
    prompt: str
    picture: Picture | None = None


@dataclass(frozen=True)
class Drawn:
    """A picture that a generator made.

    Attributes:
        data: The encoded picture.
        seen: The facts that can be told from it, where the generator knows; otherwise those of
            the original are taken over.
        renderer: What rendered it, where something did.
        look: Of the arrangement, where it was rendered.
    """

    data: bytes = field(repr=False)
    seen: frozenset[str] | None = None
    renderer: Renderer | None = None
    look: int = 0


class ImageGenerator(Protocol):
    """Makes pictures: of other pictures, of words, or both.

    Attributes:
        name: As the manifest records it, e.g. "openai:MODEL".
        settings: What else decides its pictures. With other settings, pictures are made anew.
        remote: Whether it asks a server, which may cost: such pictures are never made twice, and
            the user is asked before.
        price: Dollars a picture, where known.
        requests: How many requests it has sent, with repeated ones.
    """

    @property
    def name(self) -> str: ...

    @property
    def settings(self) -> str: ...

    @property
    def remote(self) -> bool: ...

    @property
    def price(self) -> float | None: ...

    @property
    def requests(self) -> int: ...

    def vary(self, original: Original, *, seed: int) -> Drawn:
        """Make another picture of what a picture shows.

        Raises:
            PictureRefused: It will not make this one.
            GeneratorError: It cannot be used.
        """

    def generate(self, prompt: str, *, seed: int) -> Drawn:
        """Make a picture of what words say.

        Raises:
            PictureRefused: It will not make this one.
            GeneratorError: It cannot be used, or makes none from words.
        """

    def close(self) -> None:
        """Let go of connections and memory. Can be called twice."""
