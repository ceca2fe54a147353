"""Who answers in a trial: a VLM that is made or given, with its recorded answers or without."""

import json
from collections.abc import Mapping
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tpvqa.config import SimulationConfig, TrialConfig
from tpvqa.errors import TpvqaError
from tpvqa.plugins import Kind, class_of, load_spec, see_taken, takes
from tpvqa.vlm import VLM
from tpvqa.vlm.capabilities import is_noise_model, kind_of
from tpvqa.vlm.making import in_full, make_vlm
from tpvqa.vlm.prompt import load_prompt

if TYPE_CHECKING:
    from tpvqa.assembly import Trial


def answering(
    trial: "Trial", given: VLM | None, context: Mapping[str, Any]
) -> tuple[VLM, set[str]]:
    """Whoever answers in a trial, and what of the context it takes.

    Where answers are replayed, no VLM is made.

    Args:
        trial: Whose files, specifications and world are known.
        given: A VLM to share between trials.
        context: What one that is made may ask for.

    Raises:
        TpvqaError: It cannot be made, or the file of recorded answers cannot be used.
    """
    config = trial.config
    answers = config.vlm.answers
    if answers is None:
        return make_vlm(trial.vlm_spec, context) if given is None else (given, set[str]())
    from tpvqa.vlm.kept import Use, kept

    use, path = Use(answers[0]), answers[1]
    inner, taken = given, _options(trial.vlm_spec, given)
    if given is None and use is not Use.REPLAY:
        inner, taken = make_vlm(trial.vlm_spec, context)
    made = kept(
        trial.vlm_spec,
        path,
        use,
        inner=inner,
        options=_told(config, taken),
        asked_so=_asked_so(config),
        trial=identity(trial),
        owned=given is None,
    )
    return made, set() if given is not None else taken


def _options(spec: str, given: VLM | None) -> set[str]:
    """What a VLM may ask for; of one that was made elsewhere nothing is known."""
    try:
        target = load_spec(Kind.VLM, spec)
    except TpvqaError:
        if given is None:
            raise
        return set()
    return takes(target) if given is None or kind_of(given) is class_of(target) else set()


def vlm_with_answers(
    spec: str,
    config: TrialConfig,
    *,
    trial: bytes | None = None,
    remember: int | None = None,
    every_option: bool = True,
) -> VLM:
    """A VLM that belongs to no trial, with its recorded answers where a file of them is named.

    Args:
        spec: Its specification.
        config: Names the file, and what the VLM is given.
        trial: Tells who asks from others; None where each asking is for itself.
        remember: Pictures that it may keep, where it keeps any.
        every_option: Whether each of the config's options has to be one that it takes.

    Raises:
        TpvqaError: It cannot be made, or the file of recorded answers cannot be used.
    """
    spec, answers, options = in_full(spec), config.vlm.answers, config.plugin_options()
    context = options | ({} if remember is None else {"remember": remember})
    taken = _options(spec, None)
    if every_option and "*" not in taken:
        see_taken(config.options, taken, context)
    if answers is None:
        return make_vlm(spec, context)[0]
    from tpvqa.vlm.kept import Use, kept

    use = Use(answers[0])
    noise = is_noise_model(load_spec(Kind.VLM, spec))  # which `kept` refuses
    made = None if use is Use.REPLAY or noise else make_vlm(spec, context)[0]
    told = _told(config, taken)
    return kept(
        spec,
        answers[1],
        use,
        inner=made,
        options=told,
        asked_so=_asked_so(config),
        trial=trial,
        owned=True,
    )


def _told(config: TrialConfig, taken: set[str]) -> dict[str, str]:
    """The user's options that a VLM is given, as texts."""
    return {
        name: json.dumps(value, sort_keys=True, default=str)
        for name, value in config.options.items()
        if name in taken or "*" in taken
    }


def _asked_so(config: TrialConfig) -> dict[str, str]:
    """What the user says of how a server is asked, as its parameters have it."""
    names = ("together", "samples", "before_after", "picture_size", "picture_quality")
    said = {name: str(getattr(config.vlm, name)) for name in names if getattr(config.vlm, name)}
    if config.vlm.prompt is not None:
        said["prompt"] = load_prompt(Path(config.vlm.prompt)).digest
    return said


def identity(trial: "Trial") -> bytes:
    """Tells a trial from all that could be answered otherwise; the same when it is run again."""
    config, told, known, risk = trial.config, trial.calibration, trial.known, trial.risk
    simulation = config.simulation or SimulationConfig()
    said = [
        trial.task.domain_text,
        trial.task.problem_text,
        trial.vlm_spec,
        trial.world_spec,
        config.monitor.named,
        config.planner.spec,
        config.seed,
        config.episode,
        config.wording,
        config.start.what,
        simulation.model_dump(mode="json"),
        config.limits.model_dump(mode="json"),
        {name: str(value) for name, value in config.options.items()},
        None if told is None else told.fingerprint,
        None if known is None else known.model_dump(mode="json"),
        None if risk is None else risk.model_dump(mode="json"),
    ]
    return blake2b(json.dumps(said, sort_keys=True).encode(), digest_size=16).digest()
