"""A kitchen in pictures: the true state is simulated, what the robot sees is drawn from a set."""

from functools import cached_property
from pathlib import Path
from typing import Any

from tpvqa.errors import PluginError
from tpvqa.pddl import Atom, State
from tpvqa.plugins import PlainArguments
from tpvqa.worlds.pictures.world import VIEW, DrawnWorld
from tpvqa.worlds.simulation import Simulation
from tpvqa_household.images.manifest import Meshes, Picture, PictureSet, load_pictures
from tpvqa_household.images.paper import PaperSimulation
from tpvqa_household.images.visible import describe, mirrored, visible_state
from tpvqa_household.kitchen.household import Household

__all__ = ["VIEW", "ImageWorld"]


class ImageWorld(DrawnWorld[Picture], PlainArguments):
    """The paper's simulator: faults on a true state, pictures of what it looks like.

    Args:
        simulation: The true state and its faults; `PaperSimulation` for the paper to the letter.
        folder: The pictures; the shipped ones by default. Read at the first look.
        meshes: Draw only pictures of "known" or of "held_out" objects; None for both.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        folder: Path | None = None,
        meshes: Meshes | None = None,
    ):
        super().__init__(simulation)
        self._folder, self._meshes = folder, meshes

    @classmethod
    def from_spec(
        cls,
        arguments: str,
        *,
        simulation: Simulation,
        simulator: str = "state",
        pictures: str | None = None,
    ) -> "ImageWorld":
        """The world that a specification names: `images`, `images:paper`, `images:held_out`.

        Args:
            arguments: Words between colons: "paper" (as `simulator`), "known" or "held_out".
            simulation: The true state and its faults.
            simulator: "state", or "paper" for the paper's simulator to the letter.
            pictures: Folder of the set; the shipped one by default.

        Raises:
            PluginError: A word is none of these.
        """
        meshes: Meshes | None = None
        for word in filter(None, arguments.split(":")):
            if word == "known":
                meshes = "known"
            elif word == "held_out":
                meshes = "held_out"
            elif word == "paper":
                simulator = word
            else:
                raise PluginError(
                    f"The world 'images' knows the words paper, known and held_out, not {word!r}. "
                    "Write for example images:paper or images:held_out."
                )
        if simulator not in ("state", "paper"):
            raise PluginError(f"There is no simulator {simulator!r}: write state or paper.")
        Household.read(simulation.state)  # a task that has no pictures is refused at once
        return cls(
            PaperSimulation.like(simulation) if simulator == "paper" else simulation,
            folder=None if pictures is None else Path(pictures),
            meshes=meshes,
        )

    @cached_property
    def pictures(self) -> PictureSet:
        """The set, read when it is first needed."""
        return load_pictures(self._folder)

    def fitting(self, state: State) -> list[Picture]:
        """The pictures of what the camera shows of a true state."""
        found = self.pictures.of(visible_state(state))
        return [p for p in found if self._meshes is None or p.meshes == self._meshes]

    def describe(self, state: State) -> str:
        """What the camera shows of a true state."""
        return describe(visible_state(state))

    def shown(self, atom: Atom) -> bool:
        """Whether the picture last seen shows if a fact is true.

        Pictures serve both hands: what one shows of the left it may show of the right.
        """
        return super().shown(atom) or super().shown(mirrored(atom))

    def detail(self, picture: Picture) -> dict[str, Any]:
        """What the log says about a look at a picture."""
        return {**super().detail(picture), "renderer": picture.renderer}
