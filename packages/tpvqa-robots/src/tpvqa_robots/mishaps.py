"""What goes wrong on the toys' table besides what physics and cameras do by themselves."""

from dataclasses import dataclass, fields, replace
from typing import Any, Self

from tpvqa.chance import chance
from tpvqa.errors import PluginError

APPENDIX = "appendix"
MOST = {"noise": 10.0, "calibration": 10.0, "slip_at": 3600.0}
"""The greatest number that a word may have; 1 of all others, which are probabilities."""


@dataclass(frozen=True, slots=True)
class Mishaps:
    """How often something is made to go wrong.

    Attributes:
        slip: Probability that the fingers give way while the base turns with a container.
        bad: Probability that a grasp is made 8 cm beside the thing.
        noise: A factor on all errors of the cameras.
        calibration: A factor besides on where they are taken to be.
        slip_at: Seconds of the robot's time at which the fingers give way once, whatever they hold;
            0 for never.
        far: Probability that the first toy stands at first where the arm reaches it only if the
            base drives; it drives where this is not 0.
        appendix: The trial of the paper's appendix instead: the first container slips, the first
            grasp of the toy is bad, and nothing else.
    """

    slip: float = 0.0
    bad: float = 0.0
    noise: float = 1.0
    calibration: float = 1.0
    slip_at: float = 0.0
    far: float = 0.0
    appendix: bool = False

    @classmethod
    def read(cls, words: str, world: str = "toys") -> Self:
        """Read `appendix` (also where nothing is said), or `slip=0.2:bad=0.1:noise=1:far=1`.

        Args:
            words: The words.
            world: The world that they are for; named in errors. Only `toys` has an appendix, and
                something far away.

        Raises:
            PluginError: A word is not known, or no number from 0 to 1 (noise and
                calibration: 0 to 10, slip_at: 0 to 3600) follows it.
        """
        toys = world == "toys"
        if toys and words in ("", APPENDIX):
            return cls(appendix=True)
        said: dict[str, Any] = {}
        known = {field.name for field in fields(cls)} - {"appendix"} - (set() if toys else {"far"})
        for word in words.split(":"):
            name, _, number = word.partition("=")
            try:
                value = float(number)
            except ValueError:
                value = -1.0
            if name in said:
                raise PluginError(f"The world {world!r} is told {name!r} twice.")
            if name in known and not 0 <= value <= MOST.get(name, 1.0):
                raise PluginError(
                    f"The world {world!r} takes {name} from 0 to {MOST.get(name, 1.0):g}, not "
                    f"{number[:40]!r}."
                )
            if name not in known:
                alone = ", which stands alone" if toys and word == APPENDIX else ""
                raise PluginError(
                    f"The world {world!r} does not understand {word[:40]!r}{alone}. Write {world}, "
                    + ("toys:appendix, toys:far=1, " if toys else "")
                    + f"or {world}:slip=0.2:bad=0.1:noise=1: probabilities, and of noise a "
                    "factor on the cameras' errors from 0 to 10, of calibration another one on "
                    f"where they are taken to be; {world}:slip_at=9 has the "
                    "fingers give way once, so many seconds from the start."
                )
            said[name] = value
        return replace(cls(), **said)


class Drawn:
    """The mishaps of one trial.

    Args:
        mishaps: How often.
        seed: With `episode`, see `tpvqa.chance`.
        episode: The same.
    """

    def __init__(self, mishaps: Mishaps, seed: int, episode: int):
        self._mishaps, self._seed, self._episode = mishaps, seed, episode
        self.turns = 0
        self.grasps: dict[str, int] = {}

    def slips(self) -> bool:
        """Whether the grip slips in this turn with a container in the hand."""
        self.turns += 1
        if self._mishaps.appendix:
            return self.turns == 1
        return self._draw("slip", self.turns) < self._mishaps.slip

    def is_bad(self, thing: str) -> bool:
        """Whether this grasp of a thing goes wrong."""
        count = self.grasps[thing] = self.grasps.get(thing, 0) + 1
        if self._mishaps.appendix:
            return thing.startswith("toy") and count == 1
        return self._draw("bad grasp", thing, count) < self._mishaps.bad

    def is_far(self) -> bool:
        """Whether the first toy stands far from the robot at first."""
        return self._draw("far") < self._mishaps.far

    def _draw(self, purpose: str, *key: object) -> float:
        return chance(self._seed, self._episode, purpose, *key).random()
