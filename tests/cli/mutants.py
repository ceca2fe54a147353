"""Damaged and forged logs, made from whole ones; a function of a seed."""

import json
import random
from collections.abc import Callable, Iterator
from typing import Any

Line = dict[str, Any]
_ODD: tuple[Any, ...] = (
    None,
    True,
    -1,
    0,
    10**6,
    10**18,
    0.5,
    -0.1,
    1e308,
    "",
    "x",
    "(",
    "(near plate)",
    "../../etc/passwd",
    "/dev/zero",
    "frames/../../x",
    "\x1b]0;title\x07[red]{{7*7}}",
    "\u202eabc\u2028",
    "a" * 5000,
    [],
    {},
    [[]],
    [None],
    {"x": 1},
    [1, 2, 3],
)
_RAW = (
    b"NaN",
    b"Infinity",
    b"1e999",
    b"1" * 5000,
    b"[" * 3000 + b"]" * 3000,
    b'"\\ud800"',
    b'{"a":1,"a":2}',
    b"\xff",
    b"0x1",
    b"",
)


def mutants(log: bytes, number: int, seed: int) -> Iterator[bytes]:
    """So many mutants of a log, each with one to three changes."""
    for at in range(number):
        draw = random.Random(f"{seed} {at}")
        lines: list[Line] = [json.loads(line) for line in log.splitlines()]
        lines = lines[: draw.randrange(1, len(lines)) + 1]
        for _ in range(draw.randint(1, 3)):
            draw.choice(_CHANGES)(lines, draw)
        if draw.random() < 0.7:
            for place, line in enumerate(lines):
                line["number"] = place
        data = b"".join(json.dumps(line).encode() + b"\n" for line in lines)
        yield _bytes(data, draw) if draw.random() < 0.2 else data


def _delete(lines: list[Line], draw: random.Random) -> None:
    if len(lines) > 1:
        del lines[draw.randrange(len(lines))]


def _again(lines: list[Line], draw: random.Random) -> None:
    lines.insert(draw.randrange(len(lines) + 1), json.loads(json.dumps(draw.choice(lines))))


def _swap(lines: list[Line], draw: random.Random) -> None:
    one, other = draw.randrange(len(lines)), draw.randrange(len(lines))
    lines[one], lines[other] = lines[other], lines[one]


def _change(lines: list[Line], draw: random.Random) -> None:
    holder, key = draw.choice(_places(draw.choice(lines)))
    holder[key] = draw.choice(_ODD)


def _drop(lines: list[Line], draw: random.Random) -> None:
    holder, key = draw.choice(_places(draw.choice(lines)))
    del holder[key]


def _splice(lines: list[Line], draw: random.Random) -> None:
    there, name = draw.choice(_places(draw.choice(lines)))
    holder, key = draw.choice(_places(draw.choice(lines)))
    holder[key] = json.loads(json.dumps(there[name]))


def _alike(lines: list[Line], draw: random.Random) -> None:
    """Another value from where the same name stands in another event."""
    kind = draw.choice(lines)
    others = [line for line in lines if line.get("kind") == kind.get("kind")]
    holder, key = draw.choice(_places(kind))
    for there, name in _places(draw.choice(others)):
        if name == key:
            holder[key] = json.loads(json.dumps(there[name]))
            return


def _alter(lines: list[Line], draw: random.Random) -> None:
    holder, key = draw.choice(_places(draw.choice(lines)))
    value = holder[key]
    if isinstance(value, bool):
        holder[key] = not value
    elif isinstance(value, int | float):
        holder[key] = value + draw.choice((1, -1, 0.5, 10**7))
    elif isinstance(value, str):
        at = draw.randrange(len(value) + 1)
        holder[key] = (
            value[:at] + draw.choice(("\x1b[2J", ")", "(", " ", "é", "")) + value[at + 1 :]
        )
    elif isinstance(value, list) and value:
        del value[draw.randrange(len(value))]


_CHANGES: tuple[Callable[[list[Line], random.Random], None], ...] = (
    _delete,
    _again,
    _swap,
    _change,
    _change,
    _drop,
    _splice,
    _alike,
    _alter,
    _alter,
)


def _places(value: Any) -> list[tuple[Any, Any]]:
    """Every place within a value: what holds it, and its name or number there."""
    found: list[tuple[Any, Any]] = []
    todo = [value]
    while todo:
        here = todo.pop()
        if isinstance(here, dict | list):
            keys = list(here) if isinstance(here, dict) else range(len(here))
            found += [(here, key) for key in keys]
            todo += [here[key] for key in keys]
    return found or [({"": 0}, "")]


def _bytes(data: bytes, draw: random.Random) -> bytes:
    at = draw.randrange(len(data))
    match draw.randrange(4):
        case 0:
            return data[:at]
        case 1:
            return data[:at] + bytes([draw.randrange(256)]) + data[at + 1 :]
        case 2:
            return data[:at] + data[at + draw.randrange(1, 40) :]
    # a value of its own in place of a number
    colon = data.find(b":", at)
    end = min(i for i in (data.find(b",", colon), data.find(b"}", colon), len(data)) if i >= 0)
    return data[: colon + 1] + draw.choice(_RAW) + data[end:] if colon >= 0 else data[:at]
