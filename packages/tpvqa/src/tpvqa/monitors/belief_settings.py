"""What `belief:KEY=VALUE:…` says: other costs, other beliefs about faults, a part to leave out."""

from dataclasses import dataclass, field
from typing import Self

from pydantic import ValidationError

from tpvqa.belief.ablations import PARTS
from tpvqa.belief.costs import Costs
from tpvqa.belief.faults import Rates
from tpvqa.errors import PluginError, suggestion

_RATES = ("failure_rate", "disturbance_rate", "spontaneous_rate")


@dataclass(frozen=True, slots=True)
class BeliefSettings:
    """How a belief monitor weighs things.

    Attributes:
        costs: What things cost.
        rates: What is believed about faults beforehand.
        without: One of `belief.ablations.PARTS`, to be left out.
    """

    costs: Costs = field(default_factory=Costs)
    rates: Rates = field(default_factory=Rates)
    without: str | None = None

    @classmethod
    def parse(cls, arguments: str) -> Self:
        """Read `question=0.05:failure=200`.

        Also understood: `failure_rate`, `disturbance_rate` and `spontaneous_rate`, believed
        beforehand; `without=PART`.

        Raises:
            PluginError: Something is unknown, or no fitting number.
        """
        given: dict[str, str] = {}
        for part in arguments.split(":") if arguments else []:
            key, _, value = part.partition("=")
            if key.strip() in given:
                raise PluginError(f"'belief:{arguments}': {key.strip()} is given twice")
            given[key.strip()] = value.strip()
        without = given.pop("without", None)
        if without is not None and without not in PARTS:
            raise PluginError(
                f"'belief:{arguments}': what can be left out is {', '.join(PARTS)}, not {without!r}"
            )
        try:
            believed = {
                key.removesuffix("_rate"): float(given.pop(key)) for key in _RATES if key in given
            }
            if not all(0 <= rate <= 1 for rate in believed.values()):
                raise ValueError("a rate lies between 0 and 1")
            costs = Costs.model_validate(given)
        except ValidationError as error:
            first = error.errors()[0]
            where = ".".join(map(str, first["loc"]))
            known = (*Costs.model_fields, *_RATES, "without")
            what = (
                f"there is no cost {where!r}{suggestion(where, known).rstrip('.')}"
                if where not in Costs.model_fields
                else first["msg"]
            )
            raise PluginError(
                f"'belief:{arguments}' is not understood: {where}: {what.rstrip('?')}"
                f"{'?' if what.endswith('?') else '.'} Costs are "
                f"{', '.join(Costs.model_fields)}; write belief:question=0.05:look=0.01, say, "
                f"or without={'|'.join(PARTS)}."
            ) from None
        except ValueError as error:
            raise PluginError(f"'belief:{arguments}' is not understood: {error}") from None
        return cls(costs, Rates(**believed), without)
