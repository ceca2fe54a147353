"""Calls into worlds and VLMs of other packages: what they raise or return may be anything."""

import traceback
from typing import TypeVar

from tpvqa.errors import PluginError, TpvqaError

T = TypeVar("T")


def called(part: object, method: str, wanted: type[T], /, *given: object, **named: object) -> T:
    """What a method of a world or a VLM returns.

    Args:
        part: The world or VLM.
        method: Which of its methods.
        wanted: What it has to return.
        *given: Its arguments.
        **named: More of them.

    Raises:
        TpvqaError: What it raised itself.
        PluginError: It raised something else, or returned something else; says where.
    """
    where = f"{type(part).__module__}.{type(part).__qualname__}.{method}"
    try:
        result = getattr(part, method)(*given, **named)
    except TpvqaError:
        raise
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        raise PluginError(
            f"{where} broke: {type(error).__name__}: {error} ({place.filename}:{place.lineno}). "
            "Mend it; the episode can be gone on with"
        ) from error
    if not isinstance(result, wanted):
        raise PluginError(f"{where} has to return {wanted.__name__}, not {_short(result)}")
    return result


def _short(value: object) -> str:
    text = repr(value)
    return f"{type(value).__name__} {text if len(text) <= 60 else text[:57] + '…'}"
