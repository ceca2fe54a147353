"""The options of `tpvqa run` and its like, made from the configuration: none is written twice."""

import inspect
from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

from tpvqa.config.layers import Key, Layer, Setting, combined, file_layer, settings
from tpvqa.config.model import TrialConfig
from tpvqa.errors import TpvqaError

_TYPES = {"int | None": int, "float | None": float, "str | None": str}
CONFIG = "config_file"


def trial_options(
    *without: Key, defaults: Layer | None = None
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options that make a trial; it is called with `layers` instead of them.

    Args:
        *without: Settings that it has no options for.
        defaults: Other values than the configuration's, for this command.
    """
    offered = [each for each in settings() if each.key not in without and each.option[0] == "-"]

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        own = [p for p in inspect.signature(command).parameters.values() if p.name != "layers"]
        made = [_parameter(each, defaults) for each in offered]
        config = inspect.Parameter(
            CONFIG,
            inspect.Parameter.KEYWORD_ONLY,
            default=None,
            annotation=Annotated[
                Path | None,
                typer.Option("--config", help="Settings from a YAML file; see `tpvqa config`."),
            ],
        )

        @wraps(command)
        def call(**given: Any) -> None:
            file = given.pop(CONFIG)
            typed = [(each, given.pop(_name(each))) for each in offered]
            layers = [] if defaults is None else [defaults]
            if file is not None:
                layers.append(file_layer(file))
            layers.append(_layer(typed))
            command(layers=layers, **given)

        order = [p for p in own if p.kind is p.POSITIONAL_OR_KEYWORD]
        order += [*made, config, *(p for p in own if p.kind is p.KEYWORD_ONLY)]
        call.__signature__ = inspect.Signature(order)  # type: ignore[attr-defined]
        call.__annotations__ = {p.name: p.annotation for p in order}
        return call

    return decorate


def trial_layers(
    layers: Sequence[Layer], task: str | None = None, problem: Path | None = None
) -> list[Layer]:
    """What a command line gives, with its arguments.

    Args:
        layers: Of a command with `trial_options`.
        task: A shipped task, or one's own domain where a problem follows.
        problem: One's own problem.

    Raises:
        TpvqaError: A task is given in two ways.
    """
    files = {("task", "domain"), ("task", "problem")}
    given = files & {key for layer in layers for key in layer.values}
    own: dict[Key, Any] = {}
    if task is not None and problem is not None:
        if given:
            raise TpvqaError("Domain and problem were given twice; leave one pair out.")
        own = {("task", "domain"): _resolved(task), ("task", "problem"): _resolved(problem)}
    elif task is not None:
        if given:
            raise TpvqaError("Give either a shipped task or --domain and --problem, not both.")
        if task.lower().endswith(".pddl"):
            raise TpvqaError(f"{task} is a domain or a problem alone; name both, the domain first.")
        own = {("task", "name"): task}
    return [*layers, Layer(own, dict.fromkeys(own, "argument"))]


def trial_config(
    layers: Sequence[Layer], task: str | None = None, problem: Path | None = None
) -> TrialConfig:
    """The configuration that a command line gives; arguments and errors as of `trial_layers`.

    Raises:
        TpvqaError: A value does not fit.
    """
    config = combined(trial_layers(layers, task, problem))
    for name, spec in (("--monitor", config.monitor.spec), ("--vlm", config.vlm.spec)):
        if spec is not None and not spec.strip():
            raise TpvqaError(f"{name} must not be empty.")
    return config


def _layer(typed: Sequence[tuple[Setting, Any]]) -> Layer:
    values: dict[Key, Any] = {}
    for setting, value in typed:
        if value is None or value == []:
            continue
        if setting.key == ("options",):
            value = dict(map(_pair, value))
        values[setting.key] = _resolved(value) if setting.file else value
    options = {each.key: each.option for each, _ in typed}
    return Layer(values, {key: options[key] for key in values})


def _pair(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        raise TpvqaError(f"--option {text!r}: write NAME=VALUE")
    return name.strip(), value


def _resolved(path: str | Path) -> str:
    return str(Path(path).resolve())


def _name(setting: Setting) -> str:
    return setting.option.lstrip("-").replace("-", "_")


def _parameter(setting: Setting, defaults: Layer | None) -> inspect.Parameter:
    known = (
        setting.default if defaults is None else defaults.values.get(setting.key, setting.default)
    )
    shown = "" if known in (None, {}) else f" Default: {known}."
    says = setting.says if setting.says.endswith(".") else f"{setting.says}."
    option = typer.Option(setting.option, help=f"{says}{shown}", show_default=False)
    return inspect.Parameter(
        _name(setting),
        inspect.Parameter.KEYWORD_ONLY,
        default=None,
        annotation=Annotated[_type(setting), option],
    )


def _type(setting: Setting) -> Any:
    if setting.key == ("options",):
        return list[str] | None
    if setting.file:
        return Path | None
    kind = setting.kind
    return _TYPES.get(str(kind), kind) | None
