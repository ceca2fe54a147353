"""Parts of a definition: found, made and said."""

from collections.abc import Iterator

from tpvqa.errors import shown
from tpvqa.pddl.worker.lisp import Block, Word


def sections(definition: Block, name: str) -> Iterator[Block]:
    """The parts of a definition that begin with a word, such as `:init`."""
    for part in list(definition):
        if isinstance(part, Block) and part[:1] == [name]:
            yield part


def blocks(item: object) -> Iterator[Block]:
    """A block and all blocks within."""
    if isinstance(item, Block):
        yield item
        for part in item:
            yield from blocks(part)


def block_of(line: int | None, *parts: object) -> Block:
    """A block of some parts, whose words stand in a line."""
    block = Block(line or 1)
    block += [Word(part, line or 1) if type(part) is str else part for part in parts]
    return block


def said(item: object) -> str:
    """A block or a word as it is written, for a message."""

    def text(part: object) -> str:
        return f"({' '.join(map(text, part))})" if isinstance(part, list) else str(part)

    return shown(text(item))
