"""YAML whose every value knows its line, for files that users write."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from tpvqa.errors import PlacedError, cut, shown, suggestion
from tpvqa.text_files import read_text

LARGEST = 2 << 20
"""Bytes of a file: PyYAML reads half a megabyte a second."""
_DEEPEST = 50
_LONGEST_NUMBER = 100
_STRING = "tag:yaml.org,2002:str"


class _Loader(yaml.SafeLoader):
    """Composes plain trees: no anchors and aliases, which make small files
    huge, and no key given twice."""

    _depth = 0

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        mark = self._next().start_mark
        if self.check_event(yaml.AliasEvent):
            raise _Refused(
                f"the alias *{cut(self._next().anchor)} is not read here; write out what it "
                "stands for",
                mark,
            )
        anchor = getattr(self._next(), "anchor", None)
        if anchor is not None:
            raise _Refused(f"the anchor &{cut(anchor)} is not read here; leave it out", mark)
        tag = getattr(self._next(), "tag", None)
        if tag is not None:
            raise _Refused(f"the tag {shown(tag)} is not read here; leave it out", mark)
        if self._depth >= _DEEPEST:
            raise _Refused(f"values are nested more than {_DEEPEST} deep", mark)
        self._depth += 1
        try:
            node = super().compose_node(parent, index)
        finally:
            self._depth -= 1
        if isinstance(node, yaml.MappingNode):
            _check_keys(node)
        elif isinstance(node, yaml.ScalarNode):
            _check_length(node)
        return node

    def _next(self) -> Any:
        return self.peek_event()  # type: ignore[no-untyped-call]


def _check_length(node: yaml.ScalarNode) -> None:
    """Numbers and dates of any length take any time to read."""
    if node.tag != _STRING and len(node.value) > _LONGEST_NUMBER:
        raise _Refused(
            f"{shown(node.value)} has {len(node.value):,} letters; write text in quotes",
            node.start_mark,
        )


def _check_keys(node: yaml.MappingNode) -> None:
    first: dict[str, int] = {}
    for key, _ in node.value:
        if not isinstance(key, yaml.ScalarNode):
            continue
        if key.value in first:
            line = first[key.value] + 1
            raise _Refused(
                f"{shown(key.value)} is given twice, first in line {line}", key.start_mark
            )
        first[key.value] = key.start_mark.line


class _Refused(yaml.MarkedYAMLError):
    def __init__(self, problem: str, mark: yaml.Mark):
        super().__init__(problem=problem, problem_mark=mark)
        self.said, self.line = problem, mark.line + 1


@dataclass(frozen=True, slots=True)
class Place:
    """A value in a YAML file, read by what it should be.

    Attributes:
        file: The file.
        node: The value.
        error: What is raised where it is wrong, with file and line.
        path: Where in the file it stands, e.g. `actions.place`.
    """

    file: str
    node: yaml.Node
    error: type[PlacedError]
    path: str = ""

    @property
    def line(self) -> int:
        """The line it starts in, counted from 1."""
        return int(self.node.start_mark.line) + 1

    def wrong(self, message: str) -> PlacedError:
        """An error about this value, to raise."""
        where = f"{self.path}: " if self.path else ""
        return self.error(where + message, file=self.file, line=self.line)

    def text(self) -> str:
        """The value as text, white space evened out."""
        if not isinstance(self.node, yaml.ScalarNode):
            raise self.wrong(f"expected text, found {_kind(self.node)}")
        said = " ".join(str(self.node.value).split())
        if self.node.tag != _STRING and said:
            raise self.wrong(f"expected text, found {shown(said)}; write it in quotes")
        if not said:
            raise self.wrong("expected text, found nothing; write some, or leave the key out")
        return said

    def truth(self) -> bool:
        """The value as true or false."""
        said = str(self.node.value).lower()
        known = said in ("true", "yes", "on", "false", "no", "off")
        if self.node.tag != "tag:yaml.org,2002:bool" or not known:
            raise self.wrong(f"expected true or false, found {_kind(self.node)}")
        return said in ("true", "yes", "on")

    def count(self) -> int:
        """The value as a number of 1, 2, 3, …"""
        said = str(self.node.value) if isinstance(self.node, yaml.ScalarNode) else ""
        if len(said) > 9 or not said.isdecimal() or int(said) == 0:
            raise self.wrong(f"expected a number that counts from 1, found {_kind(self.node)}")
        return int(said)

    def share(self) -> float:
        """The value as a number from 0 to 1."""
        said = str(self.node.value) if isinstance(self.node, yaml.ScalarNode) else ""
        try:
            share = float(said) if len(said) <= _LONGEST_NUMBER else -1.0
        except ValueError:
            share = -1.0
        if not 0 <= share <= 1:
            raise self.wrong(f"expected a number from 0 to 1, found {_kind(self.node)}")
        return share

    def is_text(self) -> bool:
        """Whether it is a single value, not a list or a mapping."""
        return isinstance(self.node, yaml.ScalarNode) and not _is_empty(self.node)

    def is_list(self) -> bool:
        """Whether it is a list."""
        return isinstance(self.node, yaml.SequenceNode)

    def texts(self) -> "list[Place]":
        """The items of a list, or the value alone where it is a single one."""
        return [self] if self.is_text() else list(self.items())

    def entries(self) -> "list[tuple[str, Place, Place]]":
        """The entries of a mapping: key in lower case, place of the key, value."""
        if _is_empty(self.node):
            return []
        if not isinstance(self.node, yaml.MappingNode):
            raise self.wrong(f"expected 'name: value' entries, found {_kind(self.node)}")
        found: dict[str, tuple[str, Place, Place]] = {}
        for key, value in self.node.value:
            place = Place(self.file, key, self.error, self.path)
            if not isinstance(key, yaml.ScalarNode):
                raise place.wrong("expected a name before the colon")
            # As written: YAML itself would read the predicate `on` as the truth value "true".
            name = str(key.value).strip().lower()
            if name in found:
                first = found[name][1].line
                raise place.wrong(f"{shown(name)} is given twice, first in line {first}")
            path = f"{self.path}.{name}" if self.path else name
            found[name] = (name, place, Place(self.file, value, self.error, path))
        return list(found.values())

    def sections(self, *known: str) -> "dict[str, Place]":
        """The entries of a mapping whose keys must be among those known."""
        sections: dict[str, Place] = {}
        for name, place, value in self.entries():
            if name not in known:
                raise place.wrong(
                    f"{shown(name)} is not known here{suggestion(name, known)} "
                    f"Known: {', '.join(known)}."
                )
            sections[name] = value
        return sections

    def items(self) -> "Iterator[Place]":
        """The items of a list."""
        if _is_empty(self.node):
            return
        if not isinstance(self.node, yaml.SequenceNode):
            raise self.wrong(f"expected a list with dashes, found {_kind(self.node)}")
        for at, item in enumerate(self.node.value, start=1):
            yield Place(self.file, item, self.error, f"{self.path}[{at}]")


def read_yaml(path: Path, error: type[PlacedError]) -> Place | None:
    """Read a file; None where it is empty.

    Args:
        path: The file.
        error: What is raised, also later, where something in it is wrong.

    Raises:
        PlacedError: It cannot be read or is not YAML.
    """
    text = read_text(path, error, largest=LARGEST)
    try:
        node = yaml.compose(text, Loader=_Loader)
    except _Refused as refused:
        raise error(refused.said, file=path, line=refused.line) from None
    except yaml.MarkedYAMLError as broken:
        mark = broken.problem_mark or broken.context_mark
        line = None if mark is None else mark.line + 1
        what = broken.problem or broken.context or "it cannot be read"
        raise error(f"broken YAML: {what}{_quotes(broken)}", file=path, line=line) from broken
    except yaml.reader.ReaderError as broken:
        line = text.count("\n", 0, broken.position) + 1
        letter = ascii(text[broken.position : broken.position + 1])
        raise error(
            f"broken YAML: the character {letter} may not stand in it; remove it, or save the file "
            "as plain text in UTF-8",
            file=path,
            line=line,
        ) from broken
    except (yaml.YAMLError, RecursionError, ValueError) as broken:
        raise error(f"broken YAML: {broken}", file=path) from broken
    return None if node is None or _is_empty(node) else Place(str(path), node, error)


def _quotes(broken: yaml.MarkedYAMLError) -> str:
    """The remedy where a variable or a placeholder stands in brackets without quotes."""
    bare = (broken.problem or "").endswith(("'?'", "'{'"))
    if not bare or "flow" not in (broken.context or ""):
        return ""
    return '; within [ ] and { } write a text that has ? or { in quotes, such as "(near ?x)"'


def _is_empty(node: yaml.Node) -> bool:
    return isinstance(node, yaml.ScalarNode) and node.tag == "tag:yaml.org,2002:null"


def _kind(node: yaml.Node) -> str:
    if isinstance(node, yaml.MappingNode):
        return "'name: value' entries"
    return "a list" if isinstance(node, yaml.SequenceNode) else repr(str(node.value)[:40])
