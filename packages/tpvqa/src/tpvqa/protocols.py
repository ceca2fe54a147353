"""What a plug-in lacks of the protocol of its kind, seen when it is made, not when it is used; and
calls into it, which may raise anything."""

import inspect
import traceback
from collections.abc import Callable
from difflib import get_close_matches
from typing import TypeVar

from tpvqa.errors import PluginBrokeError, TpvqaError

T = TypeVar("T")

_ANY = object()


def lacking(thing: object, protocol: type) -> str | None:
    """What is missing or of the wrong form; None where all is there.

    Args:
        thing: What was made of a plug-in.
        protocol: The `Protocol` class of its kind.
    """
    for name, member in vars(protocol).items():
        if name.startswith("_"):
            continue
        if isinstance(member, property):
            wrong = _value(thing, name)
        elif inspect.isfunction(member):
            wrong = _method(thing, name, member)
        else:
            continue
        if wrong is not None:
            return wrong
    return None


def _value(thing: object, name: str) -> str | None:
    """All properties of the protocols are texts."""
    try:
        value = getattr(thing, name)
    except AttributeError:
        return f"has no {name!r}, a text{_meant(thing, name)}"
    except Exception as error:  # noqa: BLE001 — a property of another package's
        return f"has a {name!r} that broke: {type(error).__name__}: {error}"
    if not isinstance(value, str) or not value.strip():
        return f"has a {name!r} that is {value!r:.80}; expected a text"
    return None


def _method(thing: object, name: str, wanted: object) -> str | None:
    expected = inspect.signature(wanted)  # type: ignore[arg-type]
    parameters = list(expected.parameters.values())[1:]
    form = f"{name}({_plain(parameters)})"
    try:
        method = getattr(thing, name)
    except AttributeError:
        return f"has no {form}{_meant(thing, name)}"
    except Exception as error:  # noqa: BLE001
        return f"has a {name!r} that broke: {type(error).__name__}: {error}"
    if not callable(method) or isinstance(thing, type):
        return f"has a {name!r} that is no method of an object; expected {form}"
    if inspect.iscoroutinefunction(method):
        return f"has a {name!r} that is a coroutine; expected {form}, which is called in a thread"
    try:
        signature = inspect.signature(method)
    except (TypeError, ValueError):
        return None  # written in C: nobody can tell
    for optional in (True, False):
        taken = [each for each in parameters if optional or each.default is each.empty]
        positional = [_ANY for each in taken if each.kind is each.POSITIONAL_OR_KEYWORD]
        named = {each.name: _ANY for each in taken if each.kind is each.KEYWORD_ONLY}
        try:
            signature.bind(*positional, **named)
        except TypeError as error:
            return f"has {name}{signature}, which cannot be called as {form}: {error}"
    return None


def _plain(parameters: list[inspect.Parameter]) -> str:
    """Parameters without annotations, as a user would write them."""
    bare = [each.replace(annotation=each.empty) for each in parameters]
    return str(inspect.Signature(bare)).strip("()")


def _meant(thing: object, name: str) -> str:
    known = [each for each in dir(thing) if not each.startswith("__")]
    near = get_close_matches(name, known, n=1)
    return f". Did you mean it by {near[0]!r}?" if near else ""


def called_at(where: str, call: Callable[[], T], *, then: str = "Mend it") -> T:
    """What a call into a plug-in returns.

    Args:
        where: What is called, for messages.
        call: Calls it.
        then: What to do where it broke.

    Raises:
        TpvqaError: What it raised itself.
        KeyboardInterrupt: Ctrl-C.
        PluginBrokeError: It raised something else; says where.
    """
    try:
        return call()
    except (TpvqaError, KeyboardInterrupt):
        raise
    except BaseException as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        said = f": {error}" if str(error) else ""
        broke = f"{where} broke: {type(error).__name__}{said}"
        raise PluginBrokeError(f"{broke} ({place.filename}:{place.lineno}). {then}") from error


def short(value: object) -> str:
    """A value for a message, with its type."""
    if value is None:
        return "None"
    text = repr(value)
    return f"{type(value).__name__} {text if len(text) <= 60 else text[:57] + '…'}"
