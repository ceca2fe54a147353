"""What a server says, made fit to be printed and logged: without the key, on one screen, as text.

A server is sent the key and may send it back, in an answer, an error or a header. `ServerText` is
the one place that all its words go through. It finds the key, and any eight letters or digits of it
in a row, as they are, backwards, in hexadecimal, in Base64 at every offset and in percent encoding,
in whatever case and whatever stands between the letters. What it does not find is a key that a
server enciphers, spells in words or sends in shorter pieces.
"""

import base64
import re
from collections.abc import Iterator
from urllib.parse import quote

KEY = "[key]"
LONGEST = 2000
"""Characters that are kept of a text."""
_PIECE = 8
_SHORTEST = 4  # what is shorter is no key, but a word such as "x" for a server that needs none


class ServerText:
    """Takes a key out of a server's words, and what could steer a terminal.

    Args:
        key: The key; empty where none is sent.
    """

    def __init__(self, key: str):
        self._pieces = {
            plain[at : at + size]
            for plain in _writings(key)
            if (size := min(_PIECE, len(plain))) >= _SHORTEST
            for at in range(len(plain) - size + 1)
        }
        self._sizes = sorted({len(piece) for piece in self._pieces})

    def __call__(self, text: str) -> str:
        """The text as it may be told."""
        if len(text) > LONGEST:
            text = text[:LONGEST] + "…"
        return "".join(map(_shown, self._without_key(text)))

    def _without_key(self, text: str) -> str:
        letters = [(at, char) for at, char in enumerate(text) if char.isascii() and char.isalnum()]
        plain = "".join(char for _, char in letters).lower()
        marked = [
            (letters[start][0], letters[start + size - 1][0] + 1)
            for size in self._sizes
            for start in range(len(plain) - size + 1)
            if plain[start : start + size] in self._pieces
        ]
        found: list[str] = []
        end = 0
        for begin, after in sorted(marked):
            if after <= end:
                continue
            if begin > end or not found:
                found += [text[end:begin], KEY]
            end = after
        return "".join(found) + text[end:]


def _writings(key: str) -> Iterator[str]:
    """The ways to write a key, of each the letters and digits."""
    data = key.encode()
    ways = [key, data.hex(), quote(key, safe="")]
    for before in range(3):
        # what comes before and after the key shares letters of Base64 with it: these are left out
        encoded = base64.b64encode(b"\0" * before + data).decode().rstrip("=")
        ways.append(encoded[-(-before * 8 // 6) : -1])
    for way in ways:
        plain = "".join(re.findall("[A-Za-z0-9]", way)).lower()
        yield plain
        yield plain[::-1]


def _shown(char: str) -> str:
    if char.isprintable() or char == "\n":
        return char
    return " " if char in "\t\r" else char.encode("unicode_escape", "surrogatepass").decode()
