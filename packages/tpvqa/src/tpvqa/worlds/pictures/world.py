"""A world in pictures: the true state is simulated, what the robot sees is drawn from a set.

A picture *fits* a true state if every fact that it shows is as the true state says. Where another
fitting picture shows all of these facts and more, it is not drawn; among the rest each is as likely
as any other. So pictures that show different parts of a scene take turns, and a picture that shows
next to nothing comes only where nothing better is there.
"""

import operator
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from threading import Event
from typing import Any, Generic

from tpvqa.chance import chance
from tpvqa.errors import PictureSetError, PluginError, UnknownNameError, suggestion_or_list
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Action, Atom, State
from tpvqa.worlds.capabilities import Simulated
from tpvqa.worlds.outcome import Outcome
from tpvqa.worlds.pictures.manifest import P, Picture, media_type
from tpvqa.worlds.pictures.picture_set import PictureSet, load_set
from tpvqa.worlds.protocol import Execution, Report
from tpvqa.worlds.simulation import LEAST_TIME, SimulatedTruth, Simulation

VIEW = "front"


class DrawnWorld(Simulated, Generic[P]):
    """Faults on a true state, and pictures of what it looks like; what fits is for subclasses.

    Args:
        simulation: The true state and its faults.
    """

    def __init__(self, simulation: Simulation):
        self.simulation = simulation
        self.truth = SimulatedTruth(simulation, self.shown)
        self.last_outcome: Outcome | None = None
        self.last: P | None = None
        self._look = 0

    @cached_property
    def pictures(self) -> PictureSet[P]:
        """The set, read when it is first needed."""
        raise NotImplementedError

    def fitting(self, state: State) -> Sequence[P]:
        """The pictures that may be drawn in a true state, in an order that is always the same."""
        raise NotImplementedError

    def describe(self, state: State) -> str:
        """What there is to see in a true state, in one line that is always the same."""
        raise NotImplementedError

    def shown(self, atom: Atom) -> bool:
        """Whether the picture last seen shows if a fact is true."""
        return self.last is not None and self.last.shows_fact(atom)

    def detail(self, picture: P) -> dict[str, Any]:
        """What the log says about a look at a picture."""
        return {"picture": picture.file}

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
        shown = self.describe(state)
        choice = self.fitting(state)
        if not choice:
            raise PictureSetError(f"No picture shows: {shown}. {self.pictures.lacking}")
        look, self._look = self._look, self._look + 1
        draw = chance(self.simulation.seed, self.simulation.episode, "picture", look, shown)
        picture = choice[draw.randrange(len(choice))]
        self.last = picture
        frame = Frame(
            id=VIEW,
            view=VIEW,
            data=self.pictures.read(picture),
            media_type=media_type(picture.file),
            source=picture.file,
        )
        return Observation(
            time=float(look),
            frames={VIEW: frame},
            detail=self.detail(picture),
            facts=self.simulation.sensed(),
        )

    def senses(self) -> frozenset[str]:
        """The predicates that the world file says are sensed."""
        return self.simulation.senses()

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Event | None = None
    ) -> Execution:
        """Try the action at once; skill and sensors notice what the world file says.

        An action that would lead to a state which no picture shows is refused, and changes
        nothing.
        """
        if cancel is not None and cancel.is_set():
            return Execution(Report.CANCELLED, 0.0)
        if deadline is not None and deadline < LEAST_TIME:
            return Execution(Report.LATE, 0.0, "no time was given")
        before = self.simulation.snapshot()
        outcome = self.simulation.execute(action)
        if not self.fitting(outcome.after):
            self.simulation.restore(before)
            return Execution(
                Report.UNAVAILABLE,
                0.0,
                f"no picture shows what {action} could lead to: {self.describe(outcome.after)}. "
                f"{self.pictures.lacking}",
            )
        self.last_outcome = outcome
        return outcome.execution(0.0)

    def snapshot(self) -> Mapping[str, Any]:
        """The true state, the number of looks and the picture last seen."""
        return {
            "look": self._look,
            "picture": None if self.last is None else self.last.file,
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
        self._look, self.last = operator.index(snapshot["look"]), last
        self.simulation.restore(snapshot["simulation"])

    def close(self) -> None:
        """Nothing to let go of."""


class PictureWorld(DrawnWorld[Picture]):
    """The world of a set of labelled pictures, for any domain.

    Args:
        simulation: The true state and its faults.
        folder: The pictures and their manifest. Read at the first look.
    """

    def __init__(self, simulation: Simulation, folder: Path):
        super().__init__(simulation)
        self._folder = folder
        self._fitting: dict[State, Sequence[Picture]] = {}

    @classmethod
    def from_spec(
        cls, arguments: str, *, simulation: Simulation, pictures: str | None = None
    ) -> "PictureWorld":
        """Make it from `pictures:FOLDER`.

        Args:
            arguments: The folder.
            simulation: The true state and its faults.
            pictures: The folder, where the specification names none.

        Raises:
            PluginError: No folder is named.
        """
        folder = arguments or pictures
        if not folder:
            raise PluginError("The world 'pictures' needs a set: write pictures:FOLDER.")
        return cls(simulation, Path(folder))

    @cached_property
    def pictures(self) -> PictureSet[Picture]:
        """The set, read when it is first needed."""
        return load_set(self._folder)

    def check(self) -> None:
        """See whether the pictures are there and belong to the task's domain.

        Raises:
            PictureSetError: One is missing or damaged, or tells of what the domain does not know.
        """
        task, manifest = self.simulation.task, self.pictures.manifest
        self.pictures.see_domain(task.domain_name)
        for picture in manifest.pictures:
            place = f"{self._folder / picture.file}:"
            if Path(picture.file).suffix.lower() not in (".jpg", ".jpeg", ".png"):
                raise PictureSetError(f"{place} make it a file that ends in .jpg or .png")
            for text in (*picture.state, *sorted(picture.seen)):
                predicate = Atom.parse(text).predicate
                if predicate not in task.predicates:
                    near = suggestion_or_list(predicate, task.predicates)
                    raise PictureSetError(f"{place} {text} has no predicate of the domain{near}")
        self.pictures.check()

    def fitting(self, state: State) -> Sequence[Picture]:
        """The fitting pictures, less those of which another one shows all and more."""
        found = self._fitting.get(state)
        if found is None:
            true = self.simulation.task.extend(state)
            fit = [
                picture
                for picture, shows_true, shows_false in self._told
                if shows_true <= true and true.isdisjoint(shows_false)
            ]
            found = [p for p in fit if not any(p.seen < other.seen for other in fit)]
            self._fitting[state] = found
        return found

    def describe(self, state: State) -> str:
        """The facts that hold and can change: `clear(red), on(red, blue)`."""
        fluents = self.simulation.task.fluents
        return ", ".join(str(atom) for atom in sorted(state) if atom.predicate in fluents)

    @cached_property
    def _told(self) -> list[tuple[Picture, State, State]]:
        """Each picture with the facts that it shows to hold, and those that it shows not to."""
        task = self.simulation.task
        static = frozenset(atom for atom in task.init if atom.predicate not in task.fluents)
        found = []
        for picture in self.pictures.manifest.pictures:
            stated = {atom for atom in picture.true_state if atom.predicate not in task.derived}
            true = task.extend(static | stated)
            seen = frozenset(map(Atom.parse, picture.seen))
            found.append((picture, seen & true, seen - true))
        return found
