"""A kitchen in pictures: the true state is simulated, what the robot sees is drawn from a set."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from threading import Event
from typing import Any

from tpvqa.chance import chance
from tpvqa.errors import PictureSetError, PluginError, UnknownNameError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Action, Atom, State
from tpvqa.worlds.images.manifest import Meshes, Picture, PictureSet, load_pictures
from tpvqa.worlds.images.paper import PaperSimulation
from tpvqa.worlds.images.visible import describe, mirrored, visible_state
from tpvqa.worlds.kitchen.household import Household
from tpvqa.worlds.protocol import Execution, Report
from tpvqa.worlds.simulation import Outcome, SimulatedTruth, Simulation

VIEW = "front"


class ImageWorld:
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
        self.simulation = simulation
        self.truth = SimulatedTruth(simulation, self._shown)
        self.last_outcome: Outcome | None = None
        self._folder, self._meshes = folder, meshes
        self._look = 0
        self._last: Picture | None = None

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

    def check(self) -> None:
        """See whether the pictures are there.

        Raises:
            TpvqaError: They cannot be read.
        """
        self.pictures  # noqa: B018 — read when it is first needed

    def views(self) -> Sequence[str]:
        """One view: the camera that the robot carries."""
        return (VIEW,)

    def observe(self, view: str | None = None) -> Observation:
        """Draw a picture of what the true state looks like; every call draws anew.

        Raises:
            UnknownNameError: There is no such view.
            PictureSetError: No picture shows the true state.
        """
        if view not in (None, VIEW):
            raise UnknownNameError("view", str(view), self.views())
        state = self.simulation.state
        shown = describe(visible_state(state))
        choice = self._choice(state)
        if not choice:
            raise PictureSetError(
                f"No picture shows: {shown}. `tpvqa dataset verify` lists what the set lacks"
            )
        look, self._look = self._look, self._look + 1
        draw = chance(self.simulation.seed, self.simulation.episode, "picture", look, shown)
        picture = choice[draw.randrange(len(choice))]
        self._last = picture
        frame = Frame(
            id=VIEW,
            view=VIEW,
            data=self.pictures.read(picture),
            media_type="image/jpeg",
            source=picture.file,
        )
        return Observation(
            time=float(look),
            frames={VIEW: frame},
            detail={"picture": picture.file, "renderer": picture.renderer},
        )

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Event | None = None
    ) -> Execution:
        """Try the action at once; the skill notices no fault.

        An action that would lead to a state which no picture shows is refused, and changes
        nothing.
        """
        if cancel is not None and cancel.is_set():
            return Execution(Report.CANCELLED, 0.0)
        if deadline is not None and deadline <= 0:
            return Execution(Report.LATE, 0.0, "no time was given")
        before = self.simulation.snapshot()
        outcome = self.simulation.execute(action)
        if not self._choice(outcome.after):
            self.simulation.restore(before)
            return Execution(
                Report.UNAVAILABLE,
                0.0,
                f"no picture shows what {action} could lead to: "
                f"{describe(visible_state(outcome.after))}",
            )
        self.last_outcome = outcome
        return Execution(Report.DONE, 0.0)

    def snapshot(self) -> Mapping[str, Any]:
        """The true state, the number of looks and the picture last seen."""
        return {
            "look": self._look,
            "picture": None if self._last is None else self._last.file,
            "simulation": self.simulation.snapshot(),
        }

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave.

        Raises:
            PictureSetError: The picture last seen is not in this set.
        """
        name = snapshot["picture"]
        last = next((p for p in self.pictures.manifest.pictures if p.file == name), None)
        if name is not None and last is None:
            raise PictureSetError(
                f"The episode saw the picture {name!r}, which is not in {self.pictures.folder}. "
                "Resume it with the set of pictures that it began with"
            )
        self._look, self._last = snapshot["look"], last
        self.simulation.restore(snapshot["simulation"])

    def close(self) -> None:
        """Nothing to let go of."""

    def _choice(self, state: State) -> list[Picture]:
        found = self.pictures.of(visible_state(state))
        return [p for p in found if self._meshes is None or p.meshes == self._meshes]

    def _shown(self, atom: Atom) -> bool:
        # Pictures serve both hands: what one shows of the left it may show of the right.
        return self._last is not None and (
            self._last.shows_fact(atom) or self._last.shows_fact(mirrored(atom))
        )
