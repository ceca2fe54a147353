"""PDDL text → nested lists whose every word and parenthesis knows its line."""

from collections.abc import Iterator

from tpvqa.pddl.lines import lines_of

_DEEPEST = 150


class Word(str):
    """A word of PDDL, in lower case, with the line it stands in."""

    line: int

    def __new__(cls, text: str, line: int) -> "Word":
        word = super().__new__(cls, text)
        word.line = line
        return word


class Block(list[object]):
    """A parenthesised list, with the line of its opening parenthesis."""

    def __init__(self, line: int):
        super().__init__()
        self.line = line


class LispError(Exception):
    """The parentheses or characters are wrong."""

    def __init__(self, message: str, line: int):
        super().__init__(message)
        self.message, self.line = message, line


def _words(text: str) -> Iterator[Word]:
    for number, raw in enumerate(lines_of(text), start=1):
        code = raw.split(";", 1)[0]
        if not code.isascii():
            strange = next(letter for letter in code if not letter.isascii())
            raise LispError(
                f"the character {strange!r} stands outside a comment; PDDL expects ASCII", number
            )
        for mark in "()":
            code = code.replace(mark, f" {mark} ")
        for word in code.replace("?", " ?").split():
            yield Word(word.lower(), number)


def read_block(text: str) -> Block:
    """Read the one block that a PDDL file consists of.

    Raises:
        LispError: The file is empty, a parenthesis is missing or there is one too many.
    """
    open_blocks: list[Block] = []
    result: Block | None = None
    for word in _words(text):
        if result is not None:
            raise LispError(
                f"{str(word)!r} stands after the end of the definition; expected the end of the "
                "file (is there a ')' too many before it?)",
                word.line,
            )
        if len(open_blocks) > _DEEPEST:
            raise LispError(f"blocks are nested more than {_DEEPEST} deep", word.line)
        if word == "(":
            open_blocks.append(Block(word.line))
        elif not open_blocks:
            raise LispError(f"expected '(define', got {str(word)!r}", word.line)
        elif word == ")":
            closed = open_blocks.pop()
            if open_blocks:
                open_blocks[-1].append(closed)
            elif closed[:1] != ["define"]:
                start = str(closed[0]) if closed else ")"
                raise LispError(f"expected '(define …)', got '({start}'", closed.line)
            else:
                result = closed
        else:
            open_blocks[-1].append(word)
    if open_blocks:
        block = open_blocks[-1]
        start = f" {block[0]}" if block and isinstance(block[0], str) else ""
        raise LispError(
            f"a ')' is missing: the file ends inside the block '({start.strip()}' of this line",
            block.line,
        )
    if result is None:
        raise LispError("the file is empty; expected '(define …)'", 1)
    return result


def line_of(item: object) -> int | None:
    """The line of a word, a block or the first word of a part of a block."""
    line = getattr(item, "line", None)
    if isinstance(line, int):
        return line
    if isinstance(item, list | tuple):
        for part in item:
            line = line_of(part)
            if line is not None:
                return line
    return None
