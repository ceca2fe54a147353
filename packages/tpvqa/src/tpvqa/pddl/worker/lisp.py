"""PDDL text → nested lists whose every word and parenthesis knows its line."""

import re
from collections.abc import Iterator

from tpvqa.errors import shown
from tpvqa.pddl.lines import lines_of

_DEEPEST = 150
_LONGEST = 255
"""Letters of a word."""
_SECTIONS = frozenset(
    {":domain", ":requirements", ":types", ":constants", ":predicates", ":functions", ":action"}
    | {":durative-action", ":derived", ":objects", ":init", ":goal", ":metric"}
)
"""What begins a block of a definition, and nothing within one."""
_OF_AN_ACTION = frozenset({":parameters", ":precondition", ":effect"})

_TYPED = re.compile(r"(?<!\S)-(?=[A-Za-z])")
"""The hyphen before a type that is written onto it, as in `?b -boat`; no name begins so."""


class Word(str):
    """A word of PDDL, in lower case, with the line it stands in."""

    line: int

    def __new__(cls, text: str, line: int) -> "Word":
        word = super().__new__(cls, text)
        word.line = line
        return word


class Block(list[object]):
    """A parenthesised list, with the line of its opening parenthesis."""

    # The translator keeps words and blocks in sets. What ought to be a word is then no member,
    # instead of an error that names no place.
    __hash__ = object.__hash__  # type: ignore[assignment]

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
        if not code.isascii() or "\0" in code:
            strange = next(letter for letter in code if letter == "\0" or not letter.isascii())
            raise LispError(
                f"the character {strange!r} stands outside a comment; PDDL expects ASCII", number
            )
        for mark in "()":
            code = code.replace(mark, f" {mark} ")
        code = _TYPED.sub("- ", code.replace("?", " ?"))
        for word in code.split():
            if len(word) > _LONGEST:
                raise LispError(
                    f"the word that begins with {word[:20]!r} has {len(word):,} letters; expected "
                    f"{_LONGEST} at most",
                    number,
                )
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
                f"{shown(word)} stands after the end of the definition; expected the end of the "
                f"file (is there a ')' too many before it{_within(result)}?)",
                word.line,
            )
        if len(open_blocks) > _DEEPEST:
            raise LispError(f"blocks are nested more than {_DEEPEST} deep", word.line)
        if word == "(":
            open_blocks.append(Block(word.line))
        elif not open_blocks:
            raise LispError(f"expected '(define', got {shown(word)}", word.line)
        elif word == ")":
            closed = open_blocks.pop()
            if open_blocks:
                open_blocks[-1].append(closed)
            elif closed[:1] != ["define"]:
                start = str(closed[0]) if closed and isinstance(closed[0], str) else ""
                raise LispError(f"expected '(define …)', got {shown('(' + start)}", closed.line)
            else:
                result = closed
        else:
            _check_place(word, open_blocks)
            open_blocks[-1].append(word)
    if open_blocks:
        block = open_blocks[-1]
        form = open_blocks[1] if len(open_blocks) > 1 else None
        where = _within(block) if form is None else f", in {_named(form)}"
        raise LispError(
            f"a ')' is missing: the file ends inside the block {shown(_head(block))} of this line"
            + where,
            block.line,
        )
    if result is None:
        raise LispError("the file is empty; expected '(define …)'", 1)
    return result


def _check_place(word: Word, open_blocks: list[Block]) -> None:
    """See that what begins a section, or a part of an action, does not stand deeper inside.

    It does where a parenthesis before it is missing, and that is then known to lie between.
    """
    if word in _SECTIONS and not open_blocks[-1] and len(open_blocks) > 2:
        unclosed = open_blocks[-2]
        raise LispError(
            f"a ')' is missing in {_named(open_blocks[1])}: '({word}' of line "
            f"{open_blocks[-1].line} stands inside the block {shown(_head(unclosed))} of this line",
            unclosed.line,
        )
    if word in _OF_AN_ACTION and len(open_blocks) > 2 and open_blocks[1][:1] == [":action"]:
        unclosed = open_blocks[-1]
        raise LispError(
            f"a ')' is missing in {_named(open_blocks[1])}: '{word}' of line {word.line} stands "
            f"inside the block {shown(_head(unclosed))} of this line",
            unclosed.line,
        )


def _head(block: Block) -> str:
    return f"({block[0]}" if block and isinstance(block[0], str) else "("


def _named(form: Block) -> str:
    """A block of a definition, as messages call it."""
    if form[:1] == [":action"] and len(form) > 1 and isinstance(form[1], str):
        return f"the action {shown(form[1])} (line {form.line})"
    return f"the block {shown(_head(form))} of line {form.line}"


def _within(definition: Block) -> str:
    """Where a definition that ends too early, or not at all, was left."""
    forms = [part for part in definition if isinstance(part, Block)]
    return f", in {_named(forms[-1])} or after it" if len(forms) > 1 else ""


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
