"""What a VLM declares of itself, by deriving from one of these; and the one place that asks.

A class says it, not an object: that a VLM is a noise model is known before one is made.
"""

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

from tpvqa.plugins import class_of
from tpvqa.vlm.usage import Usage


class NoiseModel:
    """It answers from the truth of a simulated world, for experiments. It is no VLM."""


class NeedsPictures:
    """It looks at pictures, and has nothing to say where there are none."""


class FactsOnly:
    """It answers questions about facts only, never about whole actions."""


class SeesBefore:
    """It can be shown the picture before the last action beside that after it, and is where its
    `before_after` is true."""

    before_after = False


@runtime_checkable
class Parametrised(Protocol):
    """It tells all that an answer depends on besides pictures and question."""

    @property
    def parameters(self) -> Mapping[str, str]:
        """By name: model, prompt's digest, size of pictures, samples, way of asking."""


@runtime_checkable
class Metered(Protocol):
    """It counts what asking it costs."""

    @property
    def usage(self) -> Usage:
        """What was spent so far."""


class SaidInFull:
    """What its arguments leave open means something else than in logs of before.

    So logs and rows of benches hold its specification in full, and what is not in full there is
    meant as it was meant then.
    """

    @classmethod
    def in_full(cls, arguments: str) -> str:
        """The arguments, with what they leave open."""
        raise NotImplementedError

    @classmethod
    def of_before(cls, arguments: str) -> str:
        """The arguments in full, by what they meant when they were not yet written so."""
        raise NotImplementedError


def is_noise_model(vlm: object) -> bool:
    """Whether a VLM, or a class of VLMs, is a noise model."""
    return issubclass(class_of(vlm), NoiseModel)


def needs_pictures(vlm: object) -> bool:
    """Whether a VLM, or a class of VLMs, needs pictures."""
    return issubclass(class_of(vlm), NeedsPictures)


def answers_facts_only(vlm: object) -> bool:
    """Whether a VLM, or a class of VLMs, answers nothing about whole actions."""
    return issubclass(class_of(vlm), FactsOnly)


def sees_before(vlm: object) -> bool:
    """Whether a VLM, or a class of VLMs, can be shown the picture before the last action."""
    return issubclass(class_of(vlm), SeesBefore)


def parameters_of(vlm: object) -> dict[str, str]:
    """All that a VLM's answers depend on besides pictures and question; empty where it does not
    say."""
    if not isinstance(vlm, Parametrised):
        return {}
    return {str(name): str(value) for name, value in vlm.parameters.items()}
