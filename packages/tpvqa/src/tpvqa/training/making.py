"""Trainers, by the name of the VLM that they train."""

from collections.abc import Mapping
from typing import Any

from tpvqa.errors import TrainingError
from tpvqa.plugins import Kind, load_spec, make_from, names, split
from tpvqa.training.protocol import Trainer


def make_trainer(spec: str, context: Mapping[str, Any]) -> Trainer:
    """Make the trainer of the VLM that a specification names.

    Args:
        spec: Of the VLM.
        context: What it may ask for by naming it in its signature.

    Raises:
        UnknownNameError: There is no such VLM.
        TrainingError: It cannot be trained.
        TpvqaError: The trainer cannot be made.
    """
    name, _ = split(spec)
    if name not in names(Kind.TRAINER):
        load_spec(Kind.VLM, spec)  # an unknown name is told as such
        known = ", ".join(names(Kind.TRAINER))
        raise TrainingError(f"The VLM {name!r} cannot be trained here. These can: {known}.")
    made: Trainer = make_from(Kind.TRAINER, spec, context, protocol=Trainer)[0]
    return made
