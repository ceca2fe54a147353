"""YAML whose every value knows its line, for files that users write."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import yaml

from tpvqa.errors import PlacedError, suggestion


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
        if self.node.tag != "tag:yaml.org,2002:str" or not said:
            found = repr(said) if said else "nothing"
            raise self.wrong(f"expected text, found {found}; write it in quotes")
        return said

    def truth(self) -> bool:
        """The value as true or false."""
        said = str(self.node.value).lower()
        if self.node.tag != "tag:yaml.org,2002:bool":
            raise self.wrong(f"expected true or false, found {_kind(self.node)}")
        return said in ("true", "yes", "on")

    def count(self) -> int:
        """The value as a number of 1, 2, 3, …"""
        said = str(self.node.value) if isinstance(self.node, yaml.ScalarNode) else ""
        if len(said) > 9 or not said.isdecimal() or int(said) == 0:
            raise self.wrong(f"expected a number that counts from 1, found {_kind(self.node)}")
        return int(said)

    def is_text(self) -> bool:
        """Whether it is a single value, not a list or a mapping."""
        return isinstance(self.node, yaml.ScalarNode) and not _is_empty(self.node)

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
                raise place.wrong(f"{name!r} is given twice, first in line {first}")
            path = f"{self.path}.{name}" if self.path else name
            found[name] = (name, place, Place(self.file, value, self.error, path))
        return list(found.values())

    def sections(self, *known: str) -> "dict[str, Place]":
        """The entries of a mapping whose keys must be among those known."""
        sections: dict[str, Place] = {}
        for name, place, value in self.entries():
            if name not in known:
                raise place.wrong(
                    f"{name!r} is not known here{suggestion(name, known)} "
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
    text = _decoded(path, error)
    try:
        node = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as broken:
        mark = broken.problem_mark or broken.context_mark
        line = None if mark is None else mark.line + 1
        what = broken.problem or broken.context or "it cannot be read"
        raise error(f"broken YAML: {what}", file=path, line=line) from broken
    except yaml.reader.ReaderError as broken:
        line = text.count("\n", 0, broken.position) + 1
        raise error(f"broken YAML: {broken.reason}", file=path, line=line) from broken
    except (yaml.YAMLError, RecursionError, ValueError) as broken:
        raise error(f"broken YAML: {broken}", file=path) from broken
    return None if node is None or _is_empty(node) else Place(str(path), node, error)


def _decoded(path: Path, error: type[PlacedError]) -> str:
    try:
        data = path.read_bytes()
    except OSError as failed:
        raise error(f"cannot be read ({failed.strerror})", file=path) from failed
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as strange:
        raise error(
            f"the byte 0x{data[strange.start]:02x} is not UTF-8 text; save the file as UTF-8",
            file=path,
            line=data.count(b"\n", 0, strange.start) + 1,
        ) from strange


def _is_empty(node: yaml.Node) -> bool:
    return isinstance(node, yaml.ScalarNode) and node.tag == "tag:yaml.org,2002:null"


def _kind(node: yaml.Node) -> str:
    if isinstance(node, yaml.MappingNode):
        return "'name: value' entries"
    return "a list" if isinstance(node, yaml.SequenceNode) else repr(str(node.value)[:40])
