"""Who answers in a trial: a VLM that is made or given, with its recorded answers or without."""

import json
from collections.abc import Mapping
from hashlib import blake2b
from typing import TYPE_CHECKING, Any

from tpvqa.config import SimulationConfig
from tpvqa.errors import TpvqaError
from tpvqa.plugins import Kind, class_of, load_spec, takes
from tpvqa.vlm import VLM
from tpvqa.vlm.capabilities import kind_of
from tpvqa.vlm.making import make_vlm

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
    told = {
        name: json.dumps(value, sort_keys=True, default=str)
        for name, value in config.options.items()
        if name in taken or "*" in taken
    }
    made = kept(
        trial.vlm_spec,
        path,
        use,
        inner=inner,
        options=told,
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
