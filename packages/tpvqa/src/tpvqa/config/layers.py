"""One configuration from several sources: defaults, a file, the command line."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from tpvqa.config.model import TrialConfig
from tpvqa.errors import ConfigError, cut
from tpvqa.files import resolved
from tpvqa.told import first_fault
from tpvqa.yaml_places import Place, read_yaml

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

Key = tuple[str, ...]
"""Where a setting stands in the configuration: ("limits", "actions")."""
NAMEABLE: tuple[Key, ...] = (
    *(("world", name) for name in ("spec", "pictures", "simulator")),
    *(("vlm", name) for name in ("spec", "base_url", "prompt", "device")),
    *(("vlm", name) for name in ("cache", "record", "replay")),
    *(("limits", name) for name in ("requests", "tokens", "cost")),
    *(("monitor", name) for name in ("spec", "majority", "experience")),
    ("planner", "spec"),
    ("options",),
)
"""What whoever goes on with an episode may name. All else is the log's: its texts are used instead
of the files that it names, and so is the calibration that it holds."""
DEFAULT = "default"
SPECS = {
    "task": "name",
    "start": "what",
    **dict.fromkeys(("world", "vlm", "monitor", "planner"), "spec"),
}
"""The setting of a part for which a name alone stands."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of the configuration.

    Attributes:
        key: Where it stands.
        option: What the command line calls it.
        says: What it is.
        default: Its value where none is given.
        kind: Its type.
        file: Whether it names a file or a folder.
        text: Whether the command line takes any text for it.
    """

    key: Key
    option: str
    says: str
    default: Any
    kind: Any
    file: bool
    text: bool


@dataclass(frozen=True, slots=True)
class Layer:
    """Values from one source.

    Attributes:
        values: By where they stand.
        places: Where each was given, as messages say it: "trial.yaml:3" or "--seed".
    """

    values: Mapping[Key, Any] = field(default_factory=dict)
    places: Mapping[Key, str] = field(default_factory=dict)


def settings() -> Iterator[Setting]:
    """All settings of a trial, in the order of the model."""
    return _settings(TrialConfig, ())


def _settings(model: type[BaseModel], above: Key) -> Iterator[Setting]:
    for name, info in model.model_fields.items():
        key = (*above, name)
        told = info.json_schema_extra
        part = _part(info)
        if part is not None:
            yield from _settings(part, key)
        elif isinstance(told, dict):
            default = info.get_default(call_default_factory=True)
            yield Setting(
                key,
                str(told["option"]),
                info.description or "",
                default,
                info.annotation,
                bool(told["file"]),
                bool(told["text"]),
            )


def _part(info: FieldInfo) -> type[BaseModel] | None:
    """The model of a part, where a field is one."""
    kinds = (info.annotation, *getattr(info.annotation, "__args__", ()))
    return next((k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel)), None)


def combined(layers: Sequence[Layer]) -> TrialConfig:
    """The configuration that layers give, the later before the earlier ones.

    Raises:
        ConfigError: A value does not fit; says where it was given.
    """
    nested: dict[str, Any] = {}
    for layer in layers:
        for (first, *rest), value in layer.values.items():
            if not rest:
                known = nested.get(first)
                if isinstance(known, Mapping) and isinstance(value, Mapping):
                    value = {**known, **value}
                nested[first] = value
            else:
                part = nested.get(first)
                nested[first] = {**(part if isinstance(part, Mapping) else {}), rest[0]: value}
    try:
        return TrialConfig.model_validate(nested)
    except ValidationError as error:
        first_error = first_fault(error)
        key = tuple(str(part) for part in first_error["loc"][:2])
        place = next((o for n in (2, 1) if (o := origin(key[:n], layers)) != DEFAULT), DEFAULT)
        if place == DEFAULT:  # two settings that do not go together
            place = next(
                (layer.places[k] for layer in layers for k in layer.places if k[:1] == key[:1]),
                DEFAULT,
            )
        named = place if place.startswith("--") else f"{place}: {'.'.join(key)}:"
        raise ConfigError(f"{named} {_what_is_wrong(first_error)}") from None


_BOUNDS = {
    "greater_than_equal": ("ge", "at least"),
    "less_than_equal": ("le", "at most"),
    "greater_than": ("gt", "more than"),
    "less_than": ("lt", "less than"),
}
_KINDS = {
    "int": "a whole number",
    "float": "a number",
    "finite": "a number",
    "string": "text",
    "bool": "true or false",
    "dict": "'name: value' entries",
    "mapping": "'name: value' entries",
    "model": "'name: value' entries",
}


def _what_is_wrong(error: "ErrorDetails") -> str:
    """What pydantic says of a value, in our words."""
    kind, told = error["type"], error.get("ctx", {})
    if "input" not in error:  # one of very many
        return f"does not fit: {error['msg']}"
    if kind == "value_error":
        return f"does not fit: {told['error']}"
    if kind in _BOUNDS:
        key, words = _BOUNDS[kind]
        wanted = f"{words} {_in_full(told[key])}"
    elif kind == "literal_error":
        wanted = str(told["expected"])
    elif kind == "string_too_short":
        return "must not be empty"
    else:
        wanted = _KINDS.get(kind.partition("_")[0], "")
    if not wanted:
        return f"does not fit: {error['msg']}"
    value = error["input"]
    said = _in_full(value) if isinstance(value, float) else cut(value)
    return f"must be {wanted}, got {said}"


def _in_full(number: float) -> str:
    """A number without digits that say nothing, and with all that tell it from others."""
    short = f"{number:g}"
    return short if float(short) == number or number != number else repr(number)


def origin(key: Key, layers: Sequence[Layer]) -> str:
    """Where a setting was given; "default" where nowhere."""
    return next((layer.places[key] for layer in reversed(layers) if key in layer.places), DEFAULT)


def file_layer(path: Path) -> Layer:
    """What a configuration file says. Paths in it are relative to its folder, but for those within
    specifications (`scripted:FILE`).

    Raises:
        ConfigError: It cannot be read, or names something that there is not.
    """
    top = read_yaml(path, ConfigError)
    values: dict[Key, Any] = {}
    places: dict[Key, str] = {}
    known: dict[str, dict[str, Setting]] = {}
    for each in settings():
        known.setdefault(each.key[0], {})[each.key[-1]] = each
    for name, part in top.sections("schema", *known).items() if top is not None else ():
        if name == "simulation" and _value(part) is None:
            values[(name,)], places[(name,)] = None, f"{path}:{part.line}"
            continue
        if name == "schema":
            values[("schema",)], places[("schema",)] = _value(part), f"{path}:{part.line}"
            continue
        for setting, place in _given(name, part, known[name]):
            value = _value(place)
            if setting.file and isinstance(value, str):
                value = str(resolved(path.parent / value))
            values[setting.key], places[setting.key] = value, f"{path}:{place.line}"
    return Layer(values, places)


def _given(name: str, part: Place, known: Mapping[str, Setting]) -> list[tuple[Setting, Place]]:
    """The settings of a part, and their values."""
    if (name,) in {setting.key for setting in known.values()}:
        return [(known[name], part)]
    if isinstance(part.node, yaml.ScalarNode) and part.node.tag == "tag:yaml.org,2002:null":
        return []
    if name in SPECS and part.is_text():
        return [(known[SPECS[name]], part)]
    return [(known[key], place) for key, place in part.sections(*known).items()]


def _value(place: Place) -> Any:
    """A value of YAML as a plain one."""
    loader = yaml.SafeLoader("")
    try:
        return loader.construct_object(place.node, deep=True)
    except (yaml.YAMLError, AttributeError, LookupError, TypeError, ValueError) as error:
        # PyYAML trips in many ways over what explicit tags promise and values do not keep.
        problem = getattr(error, "problem", None) or error
        raise place.wrong(f"cannot be read: {cut(problem)}") from None
    finally:
        loader.dispose()


def as_yaml(config: TrialConfig, layers: Sequence[Layer]) -> str:
    """A configuration as a file, every setting with where it came from."""
    lines: list[str] = [f"schema: {config.schema_number}"]
    part = ""
    for setting in settings():
        value: Any = config
        for name in setting.key:
            value = None if value is None else getattr(value, name)
        if len(setting.key) > 1 and getattr(config, setting.key[0]) is None:
            if setting.key[0] != part:
                part = setting.key[0]
                lines.append(f"{part}: null")
            continue
        if len(setting.key) > 1 and setting.key[0] != part:
            part = setting.key[0]
            lines.append(f"{part}:")
        indent = "  " * (len(setting.key) - 1)
        said = (
            yaml.safe_dump(value, default_flow_style=True, width=10_000).split("\n...")[0].strip()
        )
        lines.append(f"{indent}{setting.key[-1]}: {said}  # {origin(setting.key, layers)}")
    return "\n".join(lines) + "\n"
