"""The configuration of a trial. A setting is written here, and nowhere else.

Every field says in its metadata how the command line calls it; `tpvqa run` makes its options from
that, `tpvqa config` prints it, `started` stores it, and `resume` and the bench rebuild from it.
"""

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from tpvqa.config.parts import Part, VLMConfig, setting
from tpvqa.errors import shown

MOST = 2**63 - 1
"""Of a seed and of an episode: what readers of logs and of tables take for a whole number."""

LEAST_ACTIONS = 60
"""The limit of actions where none is given, unless `PLANS` times the first plan is more."""
LEAST_REPLANS = 10
"""The limit of replans where none is given, unless the first plan has more steps."""
PLANS = 6


class TaskConfig(Part):
    """Which task: a shipped one, or files of one's own."""

    name: str | None = setting("TASK", "A shipped task (see `tpvqa tasks`).")
    domain: str | None = setting(
        "--domain", "Your own domain, or a logic program (.lp).", file=True
    )
    problem: str | None = setting("--problem", "Your own problem.", file=True)
    questions: str | None = setting(
        "--questions",
        "Questions for your domain. Default: the questions.yaml beside it, if there is one.",
        file=True,
    )
    world_file: str | None = setting(
        "--world-file",
        "What disturbances undo in your domain, and what is sensed. Default: the world.yaml "
        "beside it.",
        file=True,
    )

    @model_validator(mode="after")
    def _one_task(self) -> Self:
        if self.name is not None and (self.domain is not None or self.problem is not None):
            raise ValueError("give either a shipped task, or a domain and a problem of your own")
        return self


class StartConfig(Part):
    """What is known before anything was done."""

    what: Literal["known", "unknown"] = setting(
        "--start",
        "known: the problem says how the world is at first (the default); unknown: nothing is "
        "known but the objects and what no action changes, so a monitor that can looks first.",
        "known",
    )
    priors: str | None = setting(
        "--priors", "How probable facts are at first, where that is not sure.", file=True
    )


class WorldConfig(Part):
    """Where the robot acts and looks."""

    spec: str | None = setting(
        "--world",
        "symbolic (the default for your own domain), pictures:FOLDER, scripted:FILE (collect_toys "
        "brings its own script) or a plug-in; the household's tasks: images (their default) or "
        "kitchen.",
    )
    pictures: str | None = setting(
        "--pictures", "pictures and images world: folder of a set of your own.", file=True
    )
    simulator: str | None = setting(
        "--simulator", "images world: state (the default), or paper (the paper's to the letter)."
    )


class MonitorConfig(Part):
    """Who decides."""

    spec: str | None = setting(
        "--monitor",
        "belief (the default), tpvqa (the paper's; the default with --majority) or another. Some "
        "take arguments: tpvqa:LOOKS, vote:LOOKS, lead:ANSWERS, blind:TIMES, belief:COST=VALUE "
        "(question, look, action, person, failure; with a cost of person you are asked, too).",
        min_length=1,
    )
    watch: float | None = setting(
        "--watch",
        "While an action lasts, look at what must hold meanwhile each time so much of the domain's "
        "time has passed. Default: a quarter of the action's time.",
        gt=0,
    )
    majority: str | None = setting(
        "--majority",
        "When answers deny an action: tie (at least half of them, the default), strict (more than "
        "half) or any (a single one).",
    )
    no_alternatives: bool = setting(
        "--no-alternatives",
        "tpvqa: do not ask where else a thing is whose place is denied; the paper does not ask.",
        False,
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

    risk: float | None = setting(
        "--risk",
        "belief: at most this share of all trials like those of --risk-file ends in a wrong done; "
        "where the goal is not sure enough for that, the trial stops in doubt.",
        gt=0,
        lt=1,
    )
    risk_file: str | None = setting(
        "--risk-file", "belief: what came of trials without --risk, see `tpvqa risk`.", file=True
    )

    @property
    def named(self) -> str:
        """The specification: where none is given, the paper's monitor with settings of its own,
        else belief."""
        of_paper = self.majority is not None or self.no_alternatives
        named = self.spec or ("tpvqa" if of_paper else "belief")
        return named if self.risk is None else f"{named}:risk={self.risk!r}"

    @model_validator(mode="after")
    def _believing(self) -> Self:
        named = self.named.partition(":")[0]
        if self.risk is not None and named != "belief":
            raise ValueError(f"the monitor {named} states no risk; take --monitor belief")
        return self


class PlannerConfig(Part):
    """Who plans."""

    spec: str = setting(
        "--planner",
        "fast-downward, or with arguments, e.g. fast-downward:optimal; clingo; up:NAME.",
        "fast-downward",
    )
    timeout: float = setting(
        "--planning-timeout",
        "Seconds for one call of the planner; other than 30 for grounding, too.",
        30.0,
        ge=0.001,
    )


TIMES = r"^[1-9][0-9]{0,5}x$"


def _none(value: Any) -> Any:
    if value == "none":
        return None
    return _number_or(value, "write a whole number, or none")


def _none_or_auto(value: Any) -> Any:
    if value == "none":
        return None
    return value if value == "auto" else _number_or(value, "write a whole number, auto or none")


def _times(value: Any) -> Any:
    if isinstance(value, str) and re.fullmatch(TIMES, value):
        return value
    return _number_or(value, "write a whole number, or 50x for fifty times the first plan")


def _number_or(value: Any, wanted: str) -> Any:
    """A value that is no other text than a number, and no truth value."""
    if isinstance(value, bool):
        raise ValueError(f"{wanted}, not {str(value).lower()}")
    if isinstance(value, str) and not re.fullmatch(r"\s*[+-]?[0-9]{1,18}\s*", value):
        raise ValueError(f"{wanted}, not {shown(value)}")
    return value


Limit = Annotated[int | None, BeforeValidator(_none)]
"""A limit; `none` for none."""
Times = Annotated[str, Field(pattern=TIMES)]
"""So many times the length of the first plan: `50x`."""
_Actions = Annotated[int, Field(ge=1)] | Times | None
_Replans = Annotated[int, Field(ge=0)] | Literal["auto"] | None


class Limits(Part):
    """When a trial is ended without success."""

    repeats: Limit = setting(
        "--max-repeats", "Repeats of an action in a row, or none.", 10, text=True, ge=0
    )
    replans: Annotated[_Replans, BeforeValidator(_none_or_auto)] = setting(
        "--max-replans",
        "Replans in the trial, or none (then 300 without an action end it). auto: the larger of "
        f"{LEAST_REPLANS} and the steps of the first plan.",
        "auto",
        text=True,
    )
    actions: Annotated[_Actions, BeforeValidator(_times)] = setting(
        "--max-actions",
        "Actions in the trial, repeats included: a number, or 50x for fifty times the first plan. "
        f"Default: the larger of {LEAST_ACTIONS} and {PLANS}x.",
        text=True,
    )
    seconds: float | None = setting("--max-seconds", "Wall-clock time of the trial.", gt=0)
    action_seconds: float | None = setting("--action-deadline", "Seconds for one action.", gt=0)
    requests: int | None = setting(
        "--max-requests", "openai: requests to the server, retries included.", ge=1
    )
    tokens: int | None = setting(
        "--max-tokens-spent", "openai: tokens, of prompts and completions together.", ge=1
    )
    cost: float | None = setting(
        "--max-cost", "openai: money, by --price-prompt and --price-completion.", gt=0
    )

    def replans_of(self, first_plan: int) -> int | None:
        """The limit of replans in a trial whose first plan has so many steps; None for none."""
        return max(LEAST_REPLANS, first_plan) if self.replans == "auto" else self.replans

    def actions_of(self, first_plan: int) -> int:
        """The limit of actions in a trial whose first plan has so many."""
        if self.actions is None:
            return max(LEAST_ACTIONS, PLANS * first_plan)
        if isinstance(self.actions, str):
            return max(int(self.actions[:-1]) * first_plan, 1)
        return self.actions


class SimulationConfig(Part):
    """What goes wrong in a simulated world."""

    failure: float = setting("--failure", "P(an action fails).", 0.25, ge=0, le=1)
    disturbance: float = setting(
        "--disturbance", "P(a failure undoes something achieved).", 0.25, ge=0, le=1
    )
    spontaneous: float = setting(
        "--spontaneous", "P(something is undone after a success).", 0.0, ge=0, le=1
    )
    moved: float = setting("--moved", "P(somebody moves a thing after an action).", 0.0, ge=0, le=1)
    interruption: float = setting(
        "--interruption",
        "P(what an action that lasts needs meanwhile is undone while it runs).",
        0.25,
        ge=0,
        le=1,
    )
    redo: Literal["free", "risky", "refused"] = setting(
        "--redo",
        "What comes of an action whose effects hold already: free (nothing happens), risky (it "
        "fails as any action, and a failure may undo something) or refused (nothing happens, and "
        "the skill reports that it failed).",
        "free",
    )

    dead: str | None = setting(
        "--dead",
        "Skills that never work: an action's name, with its first objects where it is dead only "
        "for them (_ for any); several with +: 'pick_up apple + wash'.",
        min_length=1,
    )
    true_start: str | None = setting(
        "--true-start",
        "File of the state in which the world truly begins, as `tpvqa plan --from-state` reads it. "
        "The monitor is told what the problem says.",
        file=True,
    )
    elsewhere: int = setting(
        "--elsewhere",
        "So many things, drawn by the seed, are truly elsewhere at first than the problem says.",
        0,
        ge=0,
    )

    @model_validator(mode="after")
    def _one_start(self) -> Self:
        if self.true_start is not None and self.elsewhere:
            raise ValueError("name a state that the world begins in, or how many things to move")
        return self


def _named(value: Any, key: str = "spec") -> Any:
    """A name alone stands for the part of that name."""
    return {key: value} if isinstance(value, str) else value


def _named_task(value: Any) -> Any:
    return _named(value, "name")


def _named_start(value: Any) -> Any:
    return _named(value, "what")


Named = BeforeValidator(_named)


class TrialConfig(Part):
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
    start: Annotated[StartConfig, BeforeValidator(_named_start)] = StartConfig()
    world: Annotated[WorldConfig, Named] = WorldConfig()
    vlm: Annotated[VLMConfig, Named] = VLMConfig()
    monitor: Annotated[MonitorConfig, Named] = MonitorConfig()
    planner: Annotated[PlannerConfig, Named] = PlannerConfig()
    limits: Limits = Limits()
    simulation: SimulationConfig | None = SimulationConfig()
    seed: int = setting(
        "--seed", "Decides, with --episode, every random number.", 0, ge=-MOST, le=MOST
    )
    episode: int = setting("--episode", "Number of the episode under the seed.", 0, ge=0, le=MOST)
    wording: Literal["usual", "paper"] = setting(
        "--wording",
        'How whole actions are asked about: usual ("Was wash the plate successful?"), or paper, '
        'without articles as in the paper ("Was wash plate successful?").',
        "usual",
    )
    options: dict[str, Any] = setting(
        "--option", "NAME=VALUE for plug-ins of your own; may be given several times.", {}
    )

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            task: TaskConfig | str = ...,
            start: StartConfig | str = ...,
            world: WorldConfig | str = ...,
            vlm: VLMConfig | str = ...,
            monitor: MonitorConfig | Mapping[str, Any] | str = ...,
            planner: PlannerConfig | str = ...,
            limits: Limits = ...,
            simulation: SimulationConfig | None = ...,
            seed: int = ...,
            episode: int = ...,
            wording: Literal["usual", "paper"] = ...,
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
            "no_alternatives": self.monitor.no_alternatives or None,
            "simulator": self.world.simulator,
            "pictures": self.world.pictures,
            **{
                name: getattr(self.vlm, name) or None
                for name in VLMConfig.model_fields
                if name not in ("spec", "cache", "record", "replay")
            },
            "max_requests": self.limits.requests,
            "max_tokens_spent": self.limits.tokens,
            "max_cost": self.limits.cost,
        }
        return self.options | {key: value for key, value in named.items() if value is not None}
