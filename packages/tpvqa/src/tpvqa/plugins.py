"""Planners, VLMs, worlds and monitors by name, also those of other packages.

A package offers one by an entry point in the group of its kind, `tpvqa.planners`, `tpvqa.vlms`,
`tpvqa.worlds` or `tpvqa.monitors`. Nothing is imported before it is asked for by name.

`tpvqa.trainers` has, under the name of a VLM, the class that trains it (see `tpvqa.training`).
Three more groups hold functions, which `load` finds and their readers call: `tpvqa.tasks` (families
of tasks), `tpvqa.calibrations` (of a VLM, by the name of its specification, see
`tpvqa.belief.calibrating.shipped`) and `tpvqa.commands` (see `tpvqa.cli.plugged`).

A *specification* is what users write: a name, or a name and what follows its first colon, such
as "oracle:0.8:0.5" or "openai:llama3:8b". The convention for what stands behind an entry point:

- A class (or function) that takes arguments has a class method
  `from_spec(arguments: str, **context)`. It is given the text after the first colon, "" where
  there is none, and of the context only what it names in its signature (or all, where it takes
  `**context`). It raises `PluginError` for arguments that it cannot read.
- One without `from_spec` is called with what it names of the context, and takes no arguments.

The truth of a simulated world (`truth`, `simulation`) is withheld, whatever a signature names,
from all that are not entitled to it: see `vlm.making` and `worlds.making`.
"""

import contextlib
import inspect
import re
import sys
import traceback
from collections.abc import Callable, Collection, Mapping
from enum import StrEnum
from functools import lru_cache
from importlib.metadata import EntryPoint, PackageNotFoundError, entry_points, requires, version
from types import MappingProxyType
from typing import Any, Protocol, runtime_checkable

from tpvqa.distributions import remedy
from tpvqa.errors import MissingExtraError, PluginError, TpvqaError, UnknownNameError, shown
from tpvqa.protocols import lacking

_TRUTH = frozenset({"truth", "simulation"})

PROTOCOL = 2
"""Of what tpvqa expects of plug-ins and gives them. 1 was that of tpvqa 0.1."""


@runtime_checkable
class Checked(Protocol):
    """A world or a VLM that can see whether all that it needs is there, before a robot moves."""

    def check(self) -> None:
        """See whether everything is there: files, keys, servers.

        Raises:
            TpvqaError: What is missing.
        """


@runtime_checkable
class Closing(Protocol):
    """A plug-in that has something to let go of."""

    def close(self) -> None:
        """Let go of everything. Can be called twice."""


class PlainArguments:
    """Declares that what follows a plug-in's name in a specification is words and numbers: no path,
    no address, no code. So it may come from the log of an episode that somebody else made."""

    @classmethod
    def plain(cls, arguments: str) -> bool:
        """Whether that is so of these; a plug-in that takes files, too, says of which it is not."""
        return True


def is_plain(kind: "Kind", spec: str) -> bool:
    """Whether a specification may come from a stranger: its arguments are numbers (`tpvqa:5`,
    `belief:question=0.05`), or its plug-in declares that they are harmless.

    Raises:
        TpvqaError: There is no such plug-in.
    """
    name, arguments = split(spec)
    target = load(kind, name)
    plugin = class_of(target)
    if not arguments or (issubclass(plugin, PlainArguments) and plugin.plain(arguments)):
        return True
    return all(map(_NUMBER.fullmatch, re.split("[:,]", arguments)))


_NUMBER = re.compile(r"(?:[a-z_]{1,40}=)?(?:[0-9]{0,6}|0?\.[0-9]{1,20}|1\.0{1,20})")
"""A count or a share, perhaps named; 16843009 and 10.1 are addresses, too."""


def class_of(thing: object) -> type:
    """The class of an object; a class itself."""
    return thing if isinstance(thing, type) else type(thing)


class Kind(StrEnum):
    """What can be plugged in, as messages call it."""

    PLANNER = "planner"
    VLM = "VLM"
    WORLD = "world"
    MONITOR = "monitor"
    FAMILY = "family of tasks"
    CALIBRATION = "calibration"
    COMMANDS = "set of commands"
    TRAINER = "trainer"

    @property
    def group(self) -> str:
        """The group of entry points."""
        other = {Kind.FAMILY: "tpvqa.tasks", Kind.COMMANDS: "tpvqa.commands"}
        return other.get(self, f"tpvqa.{self.value.lower()}s")


@lru_cache
def _points(path: tuple[str, ...]) -> Mapping[Kind, tuple[EntryPoint, ...]]:
    """The entry points of every kind; to find them reads the metadata of all packages on the path.

    So that is done once for all kinds.
    """
    found = entry_points()
    return {kind: tuple(found.select(group=kind.group)) for kind in Kind}


def names(kind: Kind) -> list[str]:
    """The names that can be asked for, sorted."""
    return sorted({point.name for point in _points(tuple(sys.path))[kind]})


def load(kind: Kind, name: str) -> Callable[..., Any]:
    """Import what stands behind a name.

    Raises:
        UnknownNameError: Nothing of that name; the message suggests the nearest one, or says what
            to install.
        MissingExtraError: A package is missing that an extra of the plug-in's package installs, or
            one of tpvqa's.
        PluginError: The plug-in cannot be imported, or two packages offer the name.
    """
    points = _points(tuple(sys.path))[kind]
    found = {point.value: point for point in points if point.name == name}
    if not found:
        raise UnknownNameError(kind.value, name, names(kind), remedy=remedy(kind.value, name))
    if len(found) > 1:
        packages = " and ".join(sorted(_package(point) for point in found.values()))
        raise PluginError(
            f"The {kind.value} {name!r} is offered by {packages}. Uninstall one of them."
        )
    (point,) = found.values()
    try:
        target = point.load()
    except (TpvqaError, KeyboardInterrupt):
        raise
    except BaseException as error:
        raise _cannot_import(kind, point, error) from error
    if not callable(target):
        raise PluginError(
            f"The {kind.value} {name!r} of {_package(point)} is {point.value}, which is neither "
            "a class nor a function."
        )
    written_for = getattr(target, "tpvqa_protocol", PROTOCOL)
    if written_for != PROTOCOL:
        raise PluginError(
            f"The {kind.value} {name!r} of {_package(point)} is written for protocol "
            f"{written_for} of plug-ins, and this is tpvqa {version('tpvqa')} with "
            f"protocol {PROTOCOL}. Install a version of that package that fits."
        )
    return target  # type: ignore[no-any-return]


def make(kind: Kind, spec: str, **context: Any) -> Any:
    """Make the plug-in that a specification names, whatever it turns out to be.

    Args:
        kind: What is wanted.
        spec: NAME or NAME:ARGUMENTS.
        **context: What a plug-in may ask for by naming it in its signature.

    Raises:
        UnknownNameError: Nothing of that name.
        MissingExtraError: An optional package is needed.
        PluginError: The plug-in cannot be imported or does not take these arguments.
    """
    return make_from(kind, spec, context)[0]


def make_from(
    kind: Kind,
    spec: str,
    context: Mapping[str, Any],
    *,
    entitled: Collection[str] = (),
    protocol: type | None = None,
) -> tuple[Any, set[str]]:
    """As `make`, and the names of what the plug-in takes of a context.

    Args:
        kind: What is wanted.
        spec: NAME or NAME:ARGUMENTS.
        context: What it may ask for by naming it in its signature.
        entitled: Of what tells the truth, what it may be given.
        protocol: What it must be able to do.

    Raises:
        UnknownNameError: Nothing of that name.
        MissingExtraError: An optional package is needed.
        PluginError: It cannot be imported or made, or is not what its kind has to be.
    """
    name, arguments = split(spec)
    context = {k: v for k, v in context.items() if k not in _TRUTH or k in entitled}
    made, taken = _construct(kind, name, load(kind, name), arguments, context)
    if protocol is not None:
        try:
            check(kind, name, made, protocol)
        except PluginError:
            if isinstance(made, Closing):
                with contextlib.suppress(Exception):
                    made.close()
            raise
    return made, taken


def check(kind: Kind, name: str, made: object, protocol: type) -> None:
    """See that what was made has what its protocol wants, before anything rests on it.

    Raises:
        PluginError: Something is missing or cannot be called as it has to be.
    """
    wrong = lacking(made, protocol)
    if wrong is not None:
        members = (each for each in vars(protocol) if not each.startswith("_"))
        raise PluginError(
            f"The {kind.value} {shown(name)} ({_class_name(made)}) {wrong}. "
            f"A {kind.value} has {', '.join(members)}: see {protocol.__module__}."
            f"{protocol.__qualname__}."
        )


def split(spec: str) -> tuple[str, str]:
    """The name of a specification and what follows its first colon."""
    name, _, arguments = spec.partition(":")
    return name.strip(), arguments.strip()


def load_spec(kind: Kind, spec: str) -> Callable[..., Any]:
    """Import what stands behind the name of a specification; raises as `load` does."""
    return load(kind, split(spec)[0])


def takes(target: Callable[..., Any]) -> set[str]:
    """The names of what a plug-in asks for; "*" among them where it takes whatever there is."""
    parameters = inspect.signature(getattr(target, "from_spec", target)).parameters.values()
    return {"*" if each.kind is each.VAR_KEYWORD else each.name for each in parameters}


def _construct(
    kind: Kind, name: str, target: Callable[..., Any], arguments: str, context: Mapping[str, Any]
) -> tuple[Any, set[str]]:
    """Call what `load` gave by the convention that this module describes.

    Returns:
        What was made, and the names of what it takes of a context.

    Raises:
        PluginError: It does not take these arguments, or needs what the context does not have.
    """
    from_spec = getattr(target, "from_spec", None)
    if from_spec is None and arguments:
        raise PluginError(
            f"The {kind.value} {name!r} takes no arguments, but {arguments!r} was given. "
            f"Write {name!r} alone, or give {_class_name(target)} a class method "
            "from_spec(arguments, …): it receives what follows the colon."
        )
    function, given = (target, ()) if from_spec is None else (from_spec, (arguments,))
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError) as error:
        raise PluginError(
            f"The {kind.value} {name!r} cannot be made: what it takes is not to be seen ({error})."
        ) from error
    parameters = signature.parameters.values()
    takes_all = any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters)
    wanted = {
        key: value for key, value in context.items() if takes_all or key in signature.parameters
    }
    try:
        signature.bind(*given, **wanted)
    except TypeError as error:
        raise PluginError(
            f"The {kind.value} {name!r} cannot be made here: {error}. "
            f"It can have: {', '.join(sorted(context)) or 'nothing'}."
        ) from None
    try:
        made = function(*given, **wanted)
    except (TpvqaError, KeyboardInterrupt):
        raise
    except BaseException as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        said = " ".join(str(error).split())[:300]
        raise PluginError(
            f"The {kind.value} {name!r} cannot be made: {_class_name(target)} broke with "
            f"{type(error).__name__}{said and f': {said}'} ({where.filename}:{where.lineno})."
        ) from error
    return made, set(wanted) | set(signature.parameters)


def _class_name(thing: object) -> str:
    kind = thing if inspect.isroutine(thing) else class_of(thing)
    return f"{kind.__module__}.{kind.__qualname__}"


def _root(point: EntryPoint) -> str:
    return point.module.partition(".")[0]


def _package(point: EntryPoint) -> str:
    return point.dist.name if point.dist is not None else point.value


def _cannot_import(kind: Kind, point: EntryPoint, error: BaseException) -> Exception:
    missing = (getattr(error, "name", None) or "").partition(".")[0]
    if isinstance(error, ModuleNotFoundError) and missing != _root(point):
        for distribution in dict.fromkeys((_package(point), "tpvqa") if missing else ()):
            extra = extra_that_installs(missing, distribution)
            if extra is not None:
                purpose = f"The {kind.value} {point.name!r}"
                return MissingExtraError(missing, extra, purpose, distribution=distribution)
    return PluginError(
        f"The {kind.value} {point.name!r} of the package {_package(point)} cannot be imported: "
        f"{error}. Install that package again, with what it needs."
    )


def extra_that_installs(module: str, distribution: str = "tpvqa") -> str | None:
    """The smallest extra of a distribution that installs a package, by its metadata."""
    try:
        requirements = requires(distribution) or []
    except PackageNotFoundError:
        return None
    extras: dict[str, list[str]] = {}
    for requirement in requirements:
        package = re.match(r"[A-Za-z0-9._-]+", requirement)
        extra = re.search(r"extra\s*==\s*['\"]([^'\"]+)['\"]", requirement)
        if package and extra:
            extras.setdefault(extra[1], []).append(package[0])
    fitting = [
        name
        for name, packages in extras.items()
        if any(_same(package, module) for package in packages)
    ]
    return min(fitting, key=lambda name: len(extras[name]), default=None)


def _same(package: str, module: str) -> bool:
    return re.sub(r"[-_.]+", "-", package).lower() == re.sub(r"[-_.]+", "-", module).lower()


def see_free(options: Mapping[str, Any], context: Mapping[str, Any]) -> None:
    """See that options say nothing that plug-ins are given anyway.

    Raises:
        TpvqaError: One does.
    """
    for name, value in options.items():
        later = ("truth", "views", "calibration", "experience", "noise_model", "arguments")
        if name in later or context.get(name) is not value:
            raise TpvqaError(f"--option {name}: plug-ins are given {name!r} already; leave it out")


def see_taken(
    options: Mapping[str, Any],
    taken: Collection[str],
    context: Collection[str],
    *,
    whose: str = "this VLM",
    wanting: Mapping[str, str] = MappingProxyType({}),
) -> None:
    """See that every option is one that a plug-in took.

    Args:
        options: Those of the user.
        taken: The names of what plug-ins took.
        context: All that they could have had.
        whose: Of what the options are, for the message.
        wanting: What is said instead of an option that is not taken, where that is known.

    Raises:
        PluginError: One of `wanting` is not taken.
        UnknownNameError: Another is not.
    """
    for option in options:
        if option not in taken:
            if option in wanting:
                raise PluginError(wanting[option])
            known = set(taken) - (set(context) - set(options)) - {"arguments", "truth"}
            raise UnknownNameError(f"option for {whose}", option, known)
