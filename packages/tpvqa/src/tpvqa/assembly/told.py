"""What a trial's monitor is told from files: what answers are worth, what was learned, the risk."""

import json
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tpvqa import DECIDES_AS
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.named_calibration import named_calibration
from tpvqa.belief.calibrating.risk import RiskBound, RiskCalibration
from tpvqa.belief.learning.experience import Experience
from tpvqa.config import TrialConfig
from tpvqa.config.layers import settings
from tpvqa.config.model import MonitorConfig
from tpvqa.errors import CalibrationError, TpvqaError
from tpvqa.events import Started
from tpvqa.monitors.stated_risk import split_risk
from tpvqa.text_files import kept_text
from tpvqa.vlm.capabilities import needs_pictures, parameters_of, sees_before
from tpvqa.worlds import World
from tpvqa.worlds.capabilities import has_pictures

if TYPE_CHECKING:
    from tpvqa.assembly import Trial

DECIDING = ("what decides", "monitor", "VLM", "calibration", "task")
"""Conditions without which what was believed of a goal says nothing here."""
_TOLD_OTHERWISE = ("task", "seed", "episode", "monitor")
_SPECS = (
    *(("vlm", name) for name in ("spec", "base_url", "prompt", "cache", "record", "replay")),
    ("world", "spec"),
    ("start", "priors"),
)


def read_told(
    files: MonitorConfig, calibration: Calibration | None, experience: Experience | None
) -> tuple[Calibration | None, Experience | None]:
    """Read the files that a configuration names, of what is not given.

    Raises:
        CalibrationError: One cannot be read.
    """
    if calibration is None and files.calibration is not None:
        calibration = named_calibration(Path(files.calibration))
    if experience is None and files.experience is not None:
        experience = Experience.load(Path(files.experience))
    return calibration, experience


def stated_bound(trial: "Trial", given: RiskBound | None, *, reading: bool) -> RiskBound | None:
    """Where "done" may be reported; None where no risk is stated, or no file says.

    Args:
        trial: Whose files and specifications are known.
        given: What is given goes before the file.
        reading: Whether to read the file that the configuration names.

    Raises:
        TpvqaError: A file is named and no risk, or nothing could be checked.
        CalibrationError: The file is of another monitor, VLM, calibration or task, or cannot be
            read; or its trials are too few.
    """
    file = trial.config.monitor.risk_file if reading else None
    _, risk = split_risk(trial.config.monitor.named)
    if risk is None:
        if file is not None:
            raise TpvqaError("--risk-file is for a risk: state it with --risk, e.g. --risk .02")
        return None
    if trial.task.goal_holds(trial.task.init) and not trial.task.left_open:
        raise TpvqaError(
            "By what the problem says its goal holds already, so that nothing is looked at: no "
            "risk can be stated of that. Leave out --risk"
        )
    if given is not None or file is None:
        return given
    known = RiskCalibration.load(Path(file))
    changed = differing(known, conditions(trial))
    decisive = [_difference(known, conditions(trial), name) for name in changed if name in DECIDING]
    if decisive:
        raise CalibrationError(
            f"{file}: these trials say nothing of this one: {'; '.join(decisive)}. Run `tpvqa "
            "risk` with the same options as this trial"
        )
    try:
        return known.bound(risk)
    except CalibrationError as error:
        raise CalibrationError(f"{file}: {error}") from None


def see_fitting(trial: "Trial", vlm: object, world: World, begun_as: Started | None) -> None:
    """See that a VLM can do what is asked of it here, and is told what it was told before.

    Raises:
        TpvqaError: It cannot, or the server would be told something else.
    """
    if not has_pictures(world) and needs_pictures(vlm):
        raise TpvqaError(
            f"The VLM {trial.vlm_spec!r} looks at pictures, and the world {trial.world_spec!r} "
            "has none. Choose a noise model, e.g. 'oracle:0.9', or a world with pictures."
        )
    if trial.config.vlm.before_after and not sees_before(vlm):
        raise TpvqaError(
            f"The VLM {trial.vlm_spec!r} is shown one look at a time. Leave out --before-after, "
            "or take one that compares pictures, e.g. openai:MODEL."
        )
    logged = None if begun_as is None else begun_as.parameters
    now = parameters_of(vlm).get("prompt")
    if logged is not None and now is not None and logged.get("prompt") != now:
        raise TpvqaError(
            f"The episode was begun with another prompt (digest {logged.get('prompt')!s:.16}, and "
            f"this one has {now}). Name the same file by --prompt, with the same pictures."
        )


def about_risk(trial: "Trial") -> list[str]:
    """What a user should know of the risk that a trial states."""
    config = trial.config
    if config.monitor.risk_file is None or trial.risk is None:
        return []
    known, here = RiskCalibration.load(Path(config.monitor.risk_file)), conditions(trial)
    said = [_difference(known, here, name) for name in differing(known, here)]
    notices = []
    if said:
        notices.append(
            "the risk was learnt under other conditions, and is not promised under these: "
            + "; ".join(said)
        )
    if config.monitor.experience is not None:
        notices.append(
            "the risk was learnt without --experience; who learns from trial to trial is another "
            "in each, so that it is not promised"
        )
    if config.seed == known.seed and config.episode < known.trials and trial.simulation is not None:
        notices.append(
            "this very trial is one of those that the risk was learnt from; take another --seed"
        )
    return notices


def conditions(trial: "Trial") -> dict[str, str]:
    """Under which conditions a trial is run, by name: what makes trials alike."""
    config, told = trial.config, trial.calibration
    found = {
        "what decides": DECIDES_AS,
        "monitor": split_risk(config.monitor.named)[0],
        "VLM": trial.vlm_spec,
        "calibration": "none" if told is None else told.fingerprint,
        "task": f"{trial.task.name} {_digest(trial.task.domain_text, trial.task.problem_text)}",
        "world": trial.world_spec,
        "questions": _digest(kept_text(trial.questions)),
        "world file": _digest(kept_text(trial.world_file)),
        "priors": _digest(kept_text(config.start.priors)),
    }
    if config.vlm.prompt is not None:
        found["prompt"] = str(parameters_of(trial.vlm).get("prompt"))
    return found | _others(config)


def _others(config: TrialConfig) -> dict[str, str]:
    """Every other setting that is not as it is by default, by its option."""
    found: dict[str, str] = {}
    for each in settings():
        if each.key[0] in _TOLD_OTHERWISE or each.key in _SPECS:
            continue
        value: Any = config
        for name in each.key:
            value = getattr(value, name, None)
        if value != each.default:
            found[each.option] = json.dumps(value, default=str)
    return found


def differing(known: RiskCalibration, here: Mapping[str, str]) -> list[str]:
    """The conditions in which a trial differs from those that a risk was learnt from."""
    names = dict.fromkeys((*here, *known.made_with))
    return [name for name in names if known.made_with.get(name) != here.get(name)]


def _difference(known: RiskCalibration, here: Mapping[str, str], name: str) -> str:
    there = known.made_with.get(name, "the default")
    return f"{name} {there} there, {here.get(name, 'the default')} here"


def _digest(*texts: str | None) -> str:
    if texts == (None,):
        return "none"
    return sha256(repr(texts).encode()).hexdigest()[:12]
