"""The options of `tpvqa run` and its like, made from the configuration: none is written twice."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, Literal, get_origin

import typer

from tpvqa.config.layers import Key, Layer, Setting, combined, file_layer, origin, settings
from tpvqa.config.model import TaskConfig, TrialConfig
from tpvqa.config.parts import VLMConfig
from tpvqa.errors import TpvqaError
from tpvqa.files import resolved
from tpvqa.plugins import Kind, names

_TYPES = {"int | None": int, "float | None": float, "str | None": str}
_OF_TRIALS = ("spec", "before_after")
ANSWERING: tuple[Key, ...] = (
    *(("vlm", name) for name in VLMConfig.model_fields if name not in _OF_TRIALS),
    *(("limits", name) for name in ("requests", "tokens", "cost")),
    ("options",),
)
"""Settings of who answers that commands without a trial have, too."""
CONFIG = "config_file"
_INSTALLED: Mapping[Key, Kind] = {("monitor", "spec"): Kind.MONITOR}
"""Settings whose help names everything that is installed."""


def trial_options(
    *without: Key, defaults: Layer | None = None, file: bool = True
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options that make a trial; it is called with `layers` instead of them.

    Args:
        *without: Settings that it has no options for.
        defaults: Other values than the configuration's, for this command.
        file: Whether it has --config, too.
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
            path = given.pop(CONFIG, None)
            typed = [(each, given.pop(_name(each))) for each in offered]
            layers = [] if defaults is None else [defaults]
            if path is not None:
                layers.append(file_layer(path))
            layers.append(_layer(typed))
            command(layers=layers, **given)

        order = [p for p in own if p.kind is p.POSITIONAL_OR_KEYWORD]
        order += [*made, *([config] if file else []), *(p for p in own if p.kind is p.KEYWORD_ONLY)]
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
        task: A shipped task, a folder that holds one's own domain and problem, or one's own domain
            where a problem follows.
        problem: One's own problem.

    Returns:
        The layers, and before them one of the files that lie beside one's own domain or problem.

    Raises:
        TpvqaError: A task is given in two ways.
    """
    from tpvqa.tasks import is_program, shipped_tasks
    from tpvqa.tasks.folder import only_task

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
        if is_program(task):
            own = {("task", "domain"): _resolved(task)}
            return _with_own(layers, own)
        if task.lower().endswith(".pddl"):
            raise TpvqaError(f"{task} is a domain or a problem alone; name both, the domain first.")
        if task not in {files.name for files in shipped_tasks()} and Path(task).is_dir():
            paths = zip(
                (("task", "domain"), ("task", "problem")), only_task(Path(task)), strict=True
            )
            own = {key: _resolved(path) for key, path in paths}
        else:
            own = {("task", "name"): task}
    return _with_own(layers, own)


def _with_own(layers: Sequence[Layer], own: dict[Key, Any]) -> list[Layer]:
    given_layers = _named_twice([*layers, Layer(own, dict.fromkeys(own, "argument"))])
    return [_beside(given_layers), *given_layers]


def _named_twice(layers: Sequence[Layer]) -> list[Layer]:
    """The same, with a logic program that was named once as domain and as problem."""
    from tpvqa.tasks import domain_and_problem

    keys: tuple[Key, Key] = (("task", "domain"), ("task", "problem"))
    known = {key: value for layer in layers for key, value in layer.values.items() if key in keys}
    if not all(isinstance(value, str) for value in known.values()):
        return [*layers]
    both = dict(zip(keys, domain_and_problem(*(known.get(key) for key in keys)), strict=True))
    added = {key: value for key, value in both.items() if value != known.get(key)}
    places = {key: origin(other, layers) for key, other in zip(keys, reversed(keys), strict=True)}
    return [*layers, Layer(added, {key: places[key] for key in added})]


BESIDE = "beside the domain"
"""Where a setting was given that nobody gave: its file lies there."""


def _beside(layers: Sequence[Layer]) -> Layer:
    """The questions and the world file that lie beside one's own domain or problem.

    What was named goes before them; so does `questions: null` in a file.
    """
    from tpvqa.tasks import QUESTIONS, WORLD, beside

    known = {key: value for layer in layers for key, value in layer.values.items()}
    domain, problem = known.get(("task", "domain")), known.get(("task", "problem"))
    found: dict[Key, Any] = {}
    if isinstance(domain, str) and isinstance(problem, str):
        for name, file in (("questions", QUESTIONS), ("world_file", WORLD)):
            path = beside(file, Path(problem), Path(domain))
            if ("task", name) not in known and path is not None:
                found["task", name] = str(path)
    return Layer(found, dict.fromkeys(found, BESIDE))


def about_files(layers: Sequence[Layer]) -> list[str]:
    """What to know of the files that are used without having been named."""
    options = {each.key: each.option for each in settings()}
    return [
        f"{layer.values[key]} is used; name another with {options[key]}"
        for layer in layers
        for key, place in layer.places.items()
        if place == BESIDE
    ]


def task_config(
    task: str | None,
    problem_after: Path | None,
    domain: Path | None,
    problem: Path | None,
    questions: Path | None = None,
    world_file: Path | None = None,
) -> tuple[TaskConfig, list[str]]:
    """The task that a command names, by arguments and options as `tpvqa run` takes them.

    Returns:
        The task, and what to know of files that were not named.

    Raises:
        TpvqaError: None is named, or one in two ways.
    """
    named = {
        "domain": domain,
        "problem": problem,
        "questions": questions,
        "world_file": world_file,
    }
    values: dict[Key, Any] = {
        ("task", name): _resolved(path) for name, path in named.items() if path is not None
    }
    places = {key: f"--{key[1].replace('_', '-')}" for key in values}
    layers = trial_layers([Layer(values, places)], task, problem_after)
    found = combined(layers).task
    if found.name is None and (found.domain is None or found.problem is None):
        raise TpvqaError("Name a shipped task, or give both --domain and --problem.")
    return found, about_files(layers)


def trial_config(
    layers: Sequence[Layer], task: str | None = None, problem: Path | None = None
) -> TrialConfig:
    """The configuration that a command line gives; arguments and errors as of `trial_layers`.

    Raises:
        TpvqaError: A value does not fit.
    """
    config = combined(trial_layers(layers, task, problem))
    for name, spec in (
        ("--monitor", config.monitor.spec),
        ("--vlm", config.vlm.spec),
        ("--planner", config.planner.spec),
    ):
        if spec is not None and not spec.strip():
            raise TpvqaError(f"{name} must not be empty.")
    return config


def _layer(typed: Sequence[tuple[Setting, Any]]) -> Layer:
    values: dict[Key, Any] = {}
    for setting, value in typed:
        if value is None or value == []:
            continue
        if setting.key == ("options",):
            value = dict(map(pair, value))
        values[setting.key] = _resolved(value) if setting.file else value
    options = {each.key: each.option for each, _ in typed}
    return Layer(values, {key: options[key] for key in values})


def pair(text: str) -> tuple[str, str]:
    """Name and value of an --option.

    Raises:
        TpvqaError: It is not written so.
    """
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        raise TpvqaError(f"--option {text!r}: write NAME=VALUE")
    return name.strip(), value


def _resolved(path: str | Path) -> str:
    return str(resolved(path))


def _name(setting: Setting) -> str:
    return setting.option.lstrip("-").replace("-", "_")


def _parameter(setting: Setting, defaults: Layer | None) -> inspect.Parameter:
    known = (
        setting.default if defaults is None else defaults.values.get(setting.key, setting.default)
    )
    shown = "" if known in (None, {}) else f" Default: {known}."
    says = setting.says if setting.says.endswith(".") else f"{setting.says}."
    if setting.key in _INSTALLED:
        says = f"{says} Installed: {', '.join(names(_INSTALLED[setting.key]))}."
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
    if setting.text or get_origin(setting.kind) is Literal:
        return str | None
    kind = setting.kind
    return _TYPES.get(str(kind), kind) | None
