"""The whole exception tree. Every message says what is wrong, where, and what to do about it.

TpvqaError
├── PlacedError            a file that a user wrote is wrong; says where
│   ├── PDDLError          the domain or problem cannot be read
│   ├── QuestionsError     a questions file is broken
│   ├── WorldFileError     a world file or a script is broken
│   ├── PriorsError        a file of priors is broken
│   ├── ConfigError        a trial's configuration is wrong
│   ├── PromptError        a file of what a server is told is wrong
│   └── PhotosError        a photo, its label or a file of prompts is wrong
├── PlannerError           the planner itself could not be run (never "there is no plan")
│   └── GroundingTimedOut  reading and grounding took longer than allowed
├── AnswerError            a VLM could not be asked at all
│   └── BudgetError        one more request would go beyond what may be spent
├── CacheError             recorded answers cannot be read, or lack one that is asked for
├── WorldError             a world cannot do what it is asked to
│   └── HaltedError        somebody stopped the robot: an emergency stop
├── PictureError           a picture cannot be read, is of another format, or is too large
├── PictureSetError        the set of pictures is incomplete or damaged
├── GeneratorError         pictures cannot be varied or generated (no key, say)
│   └── PictureRefused     this one picture was refused, others may be made
├── EpisodeError           an episode cannot be read or resumed
│   └── NotNamedError      its log names what only the user may name
├── WriteError             something cannot be written: a full disk, no permission
├── BeliefError            no consistent state was found near what is believed
│   └── ContradictionError there is none: facts that are wished for cannot hold together
├── BenchError             a bench cannot be run, read or written
├── CalibrationError       a calibration cannot be learnt, read or written
├── TrainingError          a VLM cannot be trained, or not from what is given
├── UnknownNameError       no plug-in or task of that name
├── PluginError            a plug-in cannot be imported, does not take its arguments, or broke
│   └── PluginBrokeError       it raised what is no TpvqaError, which is the cause
└── MissingExtraError      an optional package is needed
"""

import shlex
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from pathlib import Path

from tpvqa.distributions import how_to_install

_LONGEST = 80
"""Letters of what a user wrote that a message repeats."""


def cut(text: object) -> str:
    """What a user wrote, cut to what fits into a message."""
    said = str(text)
    return said if len(said) <= _LONGEST else said[: _LONGEST - 1] + "…"


def shown(text: object) -> str:
    """The same in quotes."""
    return repr(cut(text))


def pasted(path: object) -> str:
    """A path as it can be pasted into a shell after a command, also one that looks like an
    option: -x as ./-x."""
    said = str(path)
    return shlex.quote(f"./{said}" if said.startswith("-") else said)


def a(noun: str) -> str:
    """A noun with its article: a lamp, an item."""
    return f"{'an' if noun[:1] in 'aeiou' else 'a'} {noun}"


def suggestion(word: str, known: Iterable[str], *, near_by: float = 0.6) -> str:
    """The end of a sentence about an unknown name, and the nearest known one, where one is near.

    Args:
        word: The unknown name.
        known: The known ones.
        near_by: How alike two names have to be, of 1.
    """
    near = (
        get_close_matches(word, list(known), n=1, cutoff=near_by) if len(word) <= _LONGEST else []
    )
    return f". Did you mean {shown(near[0])}?" if near else "."


def suggestion_or_list(word: str, known: Iterable[str]) -> str:
    """As `suggestion`, and all known names where none is near."""
    known = sorted(known)
    said = suggestion(word, known)
    if said != ".":
        return said
    listed = ", ".join(map(cut, known[:20]))
    more = f" and {len(known) - 20} more" if len(known) > 20 else ""
    return f". Known: {listed or 'none'}{more}."


def _bounded(message: str) -> str:
    """A message that repeats what a file says, and files may say anything."""
    return message if len(message) <= 1000 else f"{message[:700]} … {message[-200:]}"


class TpvqaError(Exception):
    """Base of all errors that tpvqa raises on purpose."""


class PlacedError(TpvqaError):
    """A file that a user wrote is wrong; the message starts with file and line, where known.

    Args:
        message: What is wrong and what was expected.
        file: The file it stands in, where known.
        line: The line, counted from 1, where known.

    Attributes:
        message: The message without the place.
        file: The file.
        line: The line.
    """

    def __init__(self, message: str, *, file: str | Path | None = None, line: int | None = None):
        message = _bounded(message)
        self.message, self.file, self.line = message, file, line
        place = "" if file is None else f"{file}:" + ("" if line is None else f"{line}:") + " "
        super().__init__(place + message)


class PDDLError(PlacedError):
    """The domain or problem cannot be read."""


class PlannerError(TpvqaError):
    """The planner could not be run. That no plan exists is a result, not this error."""


class GroundingTimedOut(PlannerError):  # noqa: N818
    """Reading and grounding a task took longer than allowed; the message ends with "give it more
    time"."""

    def by(self, option: str) -> "GroundingTimedOut":
        """The same, with the option that gives more."""
        return GroundingTimedOut(f"{self} by {option}")


class QuestionsError(PlacedError):
    """A questions file is broken."""


class AnswerError(TpvqaError):
    """A VLM could not be asked at all (no key, say). A bad answer is *unknown* instead."""


class RecordError(PlacedError):
    """A table of a VLM's answers is broken, or lacks what is asked for."""


class CacheError(TpvqaError):
    """A file of recorded answers cannot be used, or lacks an answer that is asked for."""


class BudgetError(AnswerError):
    """One more request would go beyond what may be spent.

    Args:
        what: Requests, tokens or money.
        spent: How much of how much is spent, with what tested the server before the trial.
        option: What sets the limit.
    """

    def __init__(self, what: str, spent: str, option: str):
        super().__init__(
            f"the budget of {what} does not allow another request: {spent} spent, with the "
            "question that tests the server before a trial. Go on with "
            f"`tpvqa resume` and a larger {option}"
        )


class PromptError(PlacedError):
    """A file of what a server is told is wrong."""


class ConfigError(PlacedError):
    """The configuration of a trial is wrong."""


class WorldFileError(PlacedError):
    """A world file or a script is broken."""


class PriorsError(PlacedError):
    """A file of priors is broken."""


class WorldError(TpvqaError):
    """A world cannot do what it is asked to."""


class HaltedError(WorldError):
    """Somebody stopped the robot while it was not acting: an emergency stop."""


class PictureError(TpvqaError):
    """A picture cannot be read, is of a format that is not decoded, or is too large."""


class PictureSetError(TpvqaError):
    """The set of pictures is incomplete or damaged."""


class PhotosError(PlacedError):
    """A photo of the user's, its label or a file of prompts is wrong."""


class GeneratorError(TpvqaError):
    """Pictures cannot be varied or generated: no key, no model, a server that does not answer."""


class PictureRefused(GeneratorError):  # noqa: N818
    """The generator refuses this one picture (for what it shows, say); it may make others."""


class EpisodeError(TpvqaError):
    """An episode cannot be read or resumed."""


class NotNamedError(EpisodeError):
    """A log names an address, a file or the like, which a stranger's log might: it has to come from
    whoever goes on with the episode.

    Args:
        place: The episode.
        options: What has to be named, as the command line calls it, with what the log says.

    Attributes:
        options: The same.
    """

    def __init__(self, place: str, options: Sequence[tuple[str, str]]):
        self.options = tuple(options)
        words = " ".join(
            f"{option}={shlex.quote(value)}"
            if value.startswith("-")
            else f"{option} {shlex.quote(value)}"
            for option, value in options
        )
        super().__init__(
            f"{place}: the log names what only you may name, as an episode may be a stranger's. "
            f"Where you agree with all of it, go on with:\n"
            f"tpvqa resume {pasted(place)} {words}"
        )


class WriteError(TpvqaError):
    """Something cannot be written: the disk is full, a limit was reached, permission is lacking.

    What was written before is whole. The command line ends with exit code 6.
    """

    @classmethod
    def of(cls, path: str | Path, error: OSError, remedy: str) -> "WriteError":
        """The error of a file that cannot be written.

        Args:
            path: The file.
            error: What the system says.
            remedy: What to do about it; a sentence without its full stop.
        """
        return cls(f"{path}: cannot be written ({error.strerror or error}). {remedy}")


class BeliefError(TpvqaError):
    """No consistent state was found near what is believed."""


class ContradictionError(BeliefError):
    """Facts that are wished for cannot hold together, so there is no consistent state."""


class BenchError(TpvqaError):
    """A bench cannot be run, or its results cannot be read or written."""


class CalibrationError(TpvqaError):
    """A calibration cannot be learnt from the data given, or its file cannot be read or written."""


class TrainingError(TpvqaError):
    """A VLM cannot be trained, or not from the labelled pictures that are given."""


class UnknownNameError(TpvqaError):
    """No plug-in, task or view of that name; the message suggests the nearest one.

    Args:
        kind: What was looked for.
        name: The name.
        known: The names that there are.
        remedy: What to do about it, where that is known; a sentence.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str], *, remedy: str = ""):
        known = sorted(known)
        near = "." if remedy else suggestion(name, known)
        super().__init__(
            f"There is no {kind} {shown(name)}{near} Known: {', '.join(known) or 'none'}."
            + (f" {remedy}" if remedy else "")
        )


class PluginError(TpvqaError):
    """A plug-in cannot be imported, does not take the arguments of its specification, or broke."""


class PluginBrokeError(PluginError):
    """A plug-in raised what is no `TpvqaError`, in words that are not meant for users; that is the
    `__cause__`."""


class MissingExtraError(TpvqaError):
    """An optional package is needed.

    Args:
        package: What is missing.
        extra: The extra that installs it.
        purpose: What needs it.
        distribution: Whose extra it is.
    """

    def __init__(self, package: str, extra: str, purpose: str, *, distribution: str = "tpvqa"):
        super().__init__(
            f"{purpose} needs the package {package!r}. "
            f"Install it: {how_to_install(distribution, extra)}"
        )
