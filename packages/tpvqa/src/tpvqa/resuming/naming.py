"""What a log may say of a trial, and what has to come from whoever goes on with it.

An episode may be a stranger's. Its log may name installed plug-ins, and give them words and
numbers. An address, a file, a folder or an option could send a key away, read or overwrite
something: such are taken from the user alone.
"""

import json
import os
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from tpvqa.config import TrialConfig
from tpvqa.config.layers import NAMEABLE, Key, Setting, settings
from tpvqa.errors import EpisodeError, NotNamedError
from tpvqa.events import Started
from tpvqa.plugins import Kind, is_plain, split
from tpvqa.vlm.making import as_logged, in_full

_KINDS = {
    ("world", "spec"): Kind.WORLD,
    ("vlm", "spec"): Kind.VLM,
    ("monitor", "spec"): Kind.MONITOR,
    ("planner", "spec"): Kind.PLANNER,
}
_WORDS = (("world", "simulator"), ("monitor", "majority"), ("vlm", "device"))
_OPTIONS = ("options",)
_ANSWERS = tuple(("vlm", name) for name in ("cache", "record", "replay"))
NOTHING: Mapping[str, Any] = MappingProxyType({})
_WORD = re.compile(r"[a-z_]{1,40}")
_SMALL = 10**6


def config_of(
    started: Started, named: Mapping[str, Any] = NOTHING, *, place: str = "the episode"
) -> TrialConfig:
    """The configuration that an episode was started with, names that were left open filled in.

    Args:
        started: The episode's first event.
        named: What only the user may name, as `TrialConfig.but` takes it:
            `{"vlm": {"base_url": "http://localhost:8000/v1"}}`.
        place: The episode, as messages name it.

    Raises:
        NotNamedError: The log names an address, a file or an option that is not in `named`.
        EpisodeError: What is named cannot be named here, or is another plug-in than the log's.
    """
    config = started.config.but(vlm={"spec": started.vlm}, world={"spec": started.world})
    given = _given(named)
    if any(key in given for key in _ANSWERS):  # one of them goes before all that the log names
        config = config.but(vlm=dict.fromkeys(name for _, name in _ANSWERS))
    missing: list[tuple[str, str]] = []
    for setting in settings():
        key = setting.key
        value = _of(config, key)
        if key == _OPTIONS:
            chosen, unnamed = _options(value, given.get(key, {}))
            missing += unnamed
        elif key in given:
            chosen = given[key]
            _same_plugin(setting, value, chosen)
            _same_words(setting, value, chosen)
        elif key not in NAMEABLE or value is None or _harmless(key, value):
            continue
        elif key == ("vlm", "base_url") and os.environ.get("OPENAI_BASE_URL"):
            chosen = None  # that of the environment
        else:
            missing.append((setting.option, str(value)))
            continue
        config = config.but(**({key[0]: {key[1]: chosen}} if len(key) > 1 else {key[0]: chosen}))
    if missing:
        raise NotNamedError(place, [*_words(given), *missing])
    if config.vlm.spec == started.vlm:
        config = config.but(vlm={"spec": as_logged(started.vlm)})
    return config


def _given(named: Mapping[str, Any]) -> dict[Key, Any]:
    """What is named, by where it stands; a name alone stands for a part."""
    found: dict[Key, Any] = {}
    for part, value in named.items():
        if (part,) == _OPTIONS:
            found[_OPTIONS] = dict(value)
        elif isinstance(value, str):
            found[(part, "spec")] = value
        else:
            found |= {(part, name): each for name, each in value.items()}
    for key in found:
        if key not in NAMEABLE:
            raise EpisodeError(
                f"{'.'.join(key)}: going on with an episode cannot change this; leave it out"
            )
    return found


def _of(config: TrialConfig, key: Key) -> Any:
    value: Any = config
    for name in key:
        value = getattr(value, name, None)
    return value


def _harmless(key: Key, value: str) -> bool:
    """Whether a value may come from a stranger."""
    if key[0] == "limits":
        return True
    if key in _KINDS:
        return is_plain(_KINDS[key], value)
    return key in _WORDS and _WORD.fullmatch(value) is not None


def _same_plugin(setting: Setting, value: str | None, chosen: str) -> None:
    if setting.key in _KINDS and split(value or chosen)[0] != split(chosen)[0]:
        raise EpisodeError(
            f"{setting.option} {chosen}: the episode was begun with {value}, and is gone on with "
            "that; only what follows the colon may be another"
        )


def _same_words(setting: Setting, value: str | None, chosen: str) -> None:
    """See that nobody names another than the log, where the log may be taken at its word."""
    if value is None or setting.key not in _KINDS or not is_plain(_KINDS[setting.key], value):
        return
    same, said = {value}, {chosen}
    if setting.key == ("vlm", "spec"):
        same |= {as_logged(value)}
        said |= {in_full(chosen), as_logged(chosen)}
    if not same & said:
        raise EpisodeError(
            f"{setting.option} {chosen}: the episode was begun with {value}, and is gone on with "
            f"that; leave {setting.option} out"
        )


def _options(
    logged: Mapping[str, Any], given: Mapping[str, Any]
) -> tuple[dict[str, Any], list[tuple[str, str]]]:
    """The options of plug-ins: a typed value of the log stays, where the user says the same."""
    chosen, missing = dict(given), []
    for name, value in logged.items():
        plain = isinstance(value, bool | None) or (
            isinstance(value, int | float) and abs(value) < _SMALL
        )
        if name in given:
            chosen[name] = value if given[name] in (value, _said(value)) else given[name]
        elif plain:
            chosen[name] = value
        else:
            missing.append(("--option", f"{name}={_said(value)}"))
    return chosen, missing


def _said(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def _words(given: Mapping[Key, Any]) -> list[tuple[str, str]]:
    """What is named already, as the command line says it."""
    options = {setting.key: setting.option for setting in settings()}
    words = [(options[key], str(value)) for key, value in given.items() if key != _OPTIONS]
    more = given.get(_OPTIONS, {})
    return words + [("--option", f"{name}={_said(value)}") for name, value in more.items()]
