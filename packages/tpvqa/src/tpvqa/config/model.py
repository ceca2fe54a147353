"""The configuration of a trial. A setting is written here, and nowhere else.

Every field says in its metadata how the command line calls it; `tpvqa run` makes its options from
that, `tpvqa config` prints it, `started` stores it, and `resume` and the bench rebuild from it.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

LEAST_ACTIONS = 60
"""The limit of actions where none is given, unless `PLANS` times the first plan is more."""
PLANS = 6


def setting(
    option: str, says: str, default: Any = None, *, file: bool = False, **limits: Any
) -> Any:
    """A field of the configuration.

    Args:
        option: What the command line calls it.
        says: What it is, in one line.
        default: Its value where none is given.
        file: Whether it names a file or a folder.
        **limits: Of pydantic's `Field`: ge, le, gt.
    """
    told: dict[str, Any] = {"option": option, "file": file}
    return Field(default, description=says, json_schema_extra=told, **limits)


class _Part(BaseModel):
    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, populate_by_name=True
    )


class TaskConfig(_Part):
    """Which task: a shipped one, or files of one's own."""

    name: str | None = setting("TASK", "A shipped task (see `tpvqa tasks`).")
    domain: str | None = setting("--domain", "Your own domain.", file=True)
    problem: str | None = setting("--problem", "Your own problem.", file=True)
    questions: str | None = setting("--questions", "Questions for your domain.", file=True)
    world_file: str | None = setting(
        "--world-file", "What disturbances undo in your domain.", file=True
    )

    @model_validator(mode="after")
    def _one_task(self) -> Self:
        if self.name is not None and (self.domain is not None or self.problem is not None):
            raise ValueError("give either a shipped task, or a domain and a problem of your own")
        return self


class WorldConfig(_Part):
    """Where the robot acts and looks."""

    spec: str | None = setting(
        "--world",
        "symbolic (the default for your own domain), pictures:FOLDER, scripted:FILE or a plug-in; "
        "the household's tasks: images (their default) or kitchen.",
    )
    pictures: str | None = setting(
        "--pictures", "pictures and images world: folder of a set of your own.", file=True
    )
    simulator: str | None = setting(
        "--simulator", "images world: state (the default), or paper (the paper's to the letter)."
    )


class VLMConfig(_Part):
    """Who answers."""

    spec: str | None = setting(
        "--vlm",
        "embedded (the default where there are pictures), openai:MODEL, or a noise model: "
        "oracle[:ACCURACY[:RHO]] (the default where there are none).",
    )
    base_url: str | None = setting("--base-url", "Address of an OpenAI-like server.")


class MonitorConfig(_Part):
    """Who decides."""

    spec: str | None = setting(
        "--monitor",
        "belief (the default), belief:COST=VALUE (question, look, action, person, failure), tpvqa "
        "(the paper's; the default with --majority), tpvqa:LOOKS, effectvqa, palmevqa, successvqa, "
        "tp or none. With a cost of person you are asked, too.",
        min_length=1,
    )
    majority: str | None = setting(
        "--majority", "tie (at least half deny, the default) or strict (more than half)."
    )
    calibration: str | None = setting(
        "--calibration",
        "belief: what the VLM's answers are worth, see `tpvqa calibrate`.",
        file=True,
    )
    experience: str | None = setting(
        "--experience",
        "belief: file with what was learned in earlier trials; kept up to date.",
        file=True,
    )

    @property
    def named(self) -> str:
        """The specification: where none is given, the paper's monitor with a majority, else
        belief."""
        return self.spec or ("belief" if self.majority is None else "tpvqa")


class PlannerConfig(_Part):
    """Who plans."""

    spec: str = setting(
        "--planner",
        "fast-downward, or with arguments, e.g. fast-downward:optimal.",
        "fast-downward",
    )
    timeout: float = setting(
        "--planning-timeout", "Seconds for one call of the planner.", 30.0, ge=0.001
    )


class Limits(_Part):
    """When a trial is ended without success."""

    repeats: int = setting("--max-repeats", "Repeats of an action in a row.", 10, ge=0)
    replans: int = setting("--max-replans", "Replans in the trial.", 10, ge=0)
    actions: int | None = setting(
        "--max-actions",
        f"Actions in the trial, repeats included. Default: the larger of {LEAST_ACTIONS} and "
        f"{PLANS} times the first plan.",
        ge=1,
    )
    seconds: float | None = setting("--max-seconds", "Wall-clock time of the trial.", gt=0)
    action_seconds: float | None = setting("--action-deadline", "Seconds for one action.", ge=0)

    def actions_of(self, first_plan: int) -> int:
        """The limit of actions in a trial whose first plan has so many."""
        return max(LEAST_ACTIONS, PLANS * first_plan) if self.actions is None else self.actions


class SimulationConfig(_Part):
    """What goes wrong in a simulated world."""

    failure: float = setting("--failure", "P(an action fails).", 0.25, ge=0, le=1)
    disturbance: float = setting(
        "--disturbance", "P(a failure undoes something achieved).", 0.25, ge=0, le=1
    )
    spontaneous: float = setting(
        "--spontaneous", "P(something is undone after a success).", 0.0, ge=0, le=1
    )


def _named(value: Any, key: str = "spec") -> Any:
    """A name alone stands for the part of that name."""
    return {key: value} if isinstance(value, str) else value


def _named_task(value: Any) -> Any:
    return _named(value, "name")


Named = BeforeValidator(_named)


class TrialConfig(_Part):
    """What a trial is. A name alone stands for a part: `TrialConfig(monitor="tpvqa")`.

    Raises:
        pydantic.ValidationError: A setting is unknown or out of its range.

    Example:
        >>> TrialConfig(task="eat_apple", vlm="oracle:0.8").vlm.spec
        'oracle:0.8'
    """

    schema_number: Literal[1] = Field(
        default=1, validation_alias="schema", serialization_alias="schema"
    )
    task: Annotated[TaskConfig, BeforeValidator(_named_task)] = TaskConfig()
    world: Annotated[WorldConfig, Named] = WorldConfig()
    vlm: Annotated[VLMConfig, Named] = VLMConfig()
    monitor: Annotated[MonitorConfig, Named] = MonitorConfig()
    planner: Annotated[PlannerConfig, Named] = PlannerConfig()
    limits: Limits = Limits()
    simulation: SimulationConfig | None = SimulationConfig()
    seed: int = setting("--seed", "Decides, with --episode, every random number.", 0)
    episode: int = setting("--episode", "Number of the episode under the seed.", 0, ge=0)
    options: dict[str, Any] = setting(
        "--option", "NAME=VALUE for plug-ins of your own; may be given several times.", {}
    )

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            task: TaskConfig | str = ...,
            world: WorldConfig | str = ...,
            vlm: VLMConfig | str = ...,
            monitor: MonitorConfig | Mapping[str, Any] | str = ...,
            planner: PlannerConfig | str = ...,
            limits: Limits = ...,
            simulation: SimulationConfig | None = ...,
            seed: int = ...,
            episode: int = ...,
            options: dict[str, Any] = ...,
        ) -> None: ...

    def but(self, **changes: Any) -> Self:
        """The same with some parts or settings changed.

        Args:
            **changes: By their names here; a name alone stands for a part, a mapping changes only
                what it names of one.
        """
        values = self.model_dump(by_alias=True)
        for name, value in changes.items():
            if isinstance(value, Mapping) and name != "options":
                value = {**(values[name] or {}), **value}
            values[name] = value
        return type(self).model_validate(values)

    def plugin_options(self) -> dict[str, Any]:
        """What plug-ins may ask for by name, as far as it is given."""
        named = {
            "majority": self.monitor.majority,
            "simulator": self.world.simulator,
            "pictures": self.world.pictures,
            "base_url": self.vlm.base_url,
        }
        return self.options | {key: value for key, value in named.items() if value is not None}
