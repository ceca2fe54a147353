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


class SideBySide:
    """It may be asked from several threads at once, and gains by that."""


class Deterministic:
    """The same question about the same pictures always gets the same answer."""


class SeesBefore:
    """It can be shown the picture before the last action beside that after it, and is where its
    `before_after` is true."""

    before_after = False


@runtime_checkable
class Parametrised(Protocol):
    """Its answers depend on more than its specification says: a prompt, sizes, weights."""

    @property
    def parameters(self) -> Mapping[str, str]:
        """What else they depend on, by name; known without asking anything."""


class StandsIn:
    """It answers in the place of another VLM, and is whatever that one is.

    Attributes:
        stands_for: The class of the other one.
        inner: It; None where it is not asked at all.
    """

    stands_for: type
    inner: object


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


def kind_of(vlm: object) -> type:
    """The class of a VLM, or of the one that it stands for; a class itself."""
    return vlm.stands_for if isinstance(vlm, StandsIn) else class_of(vlm)


def is_noise_model(vlm: object) -> bool:
    """Whether a VLM, or a class of VLMs, is a noise model."""
    return issubclass(kind_of(vlm), NoiseModel)


def needs_pictures(vlm: object) -> bool:
    """Whether a VLM, or a class of VLMs, needs pictures."""
    return issubclass(kind_of(vlm), NeedsPictures)


def answers_facts_only(vlm: object) -> bool:
    """Whether a VLM, or a class of VLMs, answers nothing about whole actions."""
    return issubclass(kind_of(vlm), FactsOnly)


def may_be_asked_side_by_side(vlm: object) -> bool:
    """Whether a VLM, or a class of VLMs, may be asked from several threads at once."""
    return issubclass(kind_of(vlm), SideBySide)


def is_deterministic(vlm: object) -> bool:
    """Whether a VLM, or a class of VLMs, never answers the same otherwise."""
    return issubclass(kind_of(vlm), Deterministic)


def sees_before(vlm: object) -> bool:
    """Whether a VLM, or a class of VLMs, can be shown the picture before the last action."""
    return issubclass(kind_of(vlm), SeesBefore)


def metered(vlm: object) -> Metered | None:
    """Whoever counts what asking a VLM costs: it, or the one that it stands for."""
    asked = vlm.inner if isinstance(vlm, StandsIn) else vlm
    return asked if isinstance(asked, Metered) else None


def parameters_of(vlm: object) -> dict[str, str]:
    """What the answers of a VLM depend on besides its specification; nothing where it says none."""
    if not isinstance(vlm, Parametrised):
        return {}
    return {str(name): str(value) for name, value in vlm.parameters.items()}
