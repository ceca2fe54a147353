"""YAML whose every value knows its line."""

from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

import yaml

from tpvqa.errors import QuestionsError


@dataclass(frozen=True, slots=True)
class Place:
    """A value in a YAML file, read by what it should be. Errors carry file and line."""

    file: str
    node: yaml.Node
    path: str = ""

    @property
    def line(self) -> int:
        """The line it starts in, counted from 1."""
        return int(self.node.start_mark.line) + 1

    def wrong(self, message: str) -> QuestionsError:
        """An error about this value, to raise."""
        where = f"{self.path}: " if self.path else ""
        return QuestionsError(where + message, file=self.file, line=self.line)

    def text(self) -> str:
        """The value as text, white space evened out."""
        if not isinstance(self.node, yaml.ScalarNode):
            raise self.wrong(f"expected text, found {_kind(self.node)}")
        said = " ".join(str(self.node.value).split())
        if self.node.tag != "tag:yaml.org,2002:str" or not said:
            found = repr(said) if said else "nothing"
            raise self.wrong(f"expected text, found {found}; write it in quotes")
        return said

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
            place = Place(self.file, key, self.path)
            if not isinstance(key, yaml.ScalarNode):
                raise place.wrong("expected a name before the colon")
            # As written: YAML itself would read the predicate `on` as the truth value "true".
            name = str(key.value).strip().lower()
            if name in found:
                first = found[name][1].line
                raise place.wrong(f"{name!r} is given twice, first in line {first}")
            path = f"{self.path}.{name}" if self.path else name
            found[name] = (name, place, Place(self.file, value, path))
        return list(found.values())

    def sections(self, *known: str) -> "dict[str, Place]":
        """The entries of a mapping whose keys must be among those known."""
        sections: dict[str, Place] = {}
        for name, place, value in self.entries():
            if name not in known:
                raise place.wrong(
                    f"{name!r} is not known here{did_you_mean(name, known)} "
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
            yield Place(self.file, item, f"{self.path}[{at}]")


def read_yaml(path: Path) -> Place | None:
    """Read a file; None where it is empty.

    Raises:
        QuestionsError: It cannot be read or is not YAML.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise QuestionsError(f"cannot be read ({error.strerror})", file=path) from error
    except UnicodeDecodeError as error:
        raise QuestionsError("is not UTF-8 text", file=path) from error
    try:
        node = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = None if mark is None else mark.line + 1
        what = error.problem or error.context or "it cannot be read"
        raise QuestionsError(f"broken YAML: {what}", file=path, line=line) from error
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise QuestionsError(f"broken YAML: {error.reason}", file=path, line=line) from error
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise QuestionsError(f"broken YAML: {error}", file=path) from error
    return None if node is None or _is_empty(node) else Place(str(path), node)


def did_you_mean(name: str, known: "list[str] | tuple[str, ...]") -> str:
    """A sentence's end that suggests the nearest known name."""
    near = get_close_matches(name, known, n=1)
    return f". Did you mean {near[0]!r}?" if near else "."


def _is_empty(node: yaml.Node) -> bool:
    return isinstance(node, yaml.ScalarNode) and node.tag == "tag:yaml.org,2002:null"


def _kind(node: yaml.Node) -> str:
    if isinstance(node, yaml.MappingNode):
        return "'name: value' entries"
    return "a list" if isinstance(node, yaml.SequenceNode) else repr(str(node.value)[:40])
