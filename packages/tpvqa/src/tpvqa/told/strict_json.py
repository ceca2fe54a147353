"""JSON, read without mercy: what another reader could take otherwise is refused."""

import json
import math
from codecs import BOM_UTF8
from typing import Any

LONGEST = 16 * 2**20
"""Bytes of a line at most. The first event of a large task has a few hundred thousand."""
_DIGITS = 20
_NUMBER = 400
"""Characters of a number with a fraction, at most."""


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise ValueError(f"{name[:40]!r} is given twice")
        found[name] = value
    return found


def _whole(text: str) -> int:
    if len(text) > _DIGITS:
        raise ValueError(f"a number has {len(text)} digits")
    return int(text)


def _real(text: str) -> float:
    value = float(text) if len(text) <= _NUMBER else math.inf
    if not math.isfinite(value):
        raise ValueError(f"{text[:20]} is no number that can be counted with")
    return value


def _never(text: str) -> None:
    raise ValueError(f"{text} is no number")


_DECODER = json.JSONDecoder(
    object_pairs_hook=_unique, parse_int=_whole, parse_float=_real, parse_constant=_never
)
_NAMES = json.JSONDecoder(
    object_pairs_hook=_unique, parse_int=str, parse_float=str, parse_constant=str
)


def check_json(line: bytes) -> None:
    """See that a line is one value of JSON: no name twice in an object, no number that is none or
    endless, nothing nested without end.

    Raises:
        ValueError: It is not; says why.
    """
    if len(line) > LONGEST:
        raise ValueError(f"the line is longer than {LONGEST:,} bytes")
    if line.startswith(BOM_UTF8):
        raise ValueError("it begins with a byte order mark; save the file as UTF-8 without one")
    try:
        _DECODER.decode(line.decode("utf-8"))
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    except UnicodeDecodeError as error:
        raise ValueError(f"it is not UTF-8 ({error.reason}); save the file as UTF-8") from None


def check_names(text: str | bytes) -> None:
    """See that a text is one value of JSON and has no name twice in an object; its numbers may be
    any.

    Raises:
        ValueError: It is not; says why.
        RecursionError: It is nested too deeply.
    """
    _NAMES.decode(text if isinstance(text, str) else text.decode("utf-8"))
