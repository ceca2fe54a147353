"""What things cost: from these the prices in all decisions follow."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

DEAREST = 1e6
"""What anything costs at most: no trial has as many actions, and products of far larger costs are
no numbers."""

Price = Annotated[float, Field(ge=0, le=DEAREST)]
Dear = Annotated[float, Field(gt=0, le=DEAREST)]


class Costs(BaseModel):
    """Costs in units of one action, `DEAREST` at most.

    Attributes:
        action: One action of the robot.
        question: One question to the VLM.
        look: One more picture.
        replan: One change of plan.
        person: One question to a person; None where nobody is there.
        failure: A trial that ends without its goal.
        misreport: That a trial says of its end what is not so: that the goal is reached, or is not.
        questions_per_step: Most questions between two actions.
        questions_per_trial: Most questions in a trial; then it goes on unseen, and ends.
        looks_per_step: Most looks between two actions.
        looks_per_trial: Most looks in a trial.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    action: Dear = 1.0
    question: Price = 0.05
    look: Price = 0.005
    replan: Price = 0.3
    person: Price | None = None
    failure: Dear = 50.0
    misreport: Price = 2.0
    questions_per_step: int = Field(default=1000, ge=0)
    questions_per_trial: int = Field(default=5000, ge=0)
    looks_per_step: int = Field(default=1000, ge=0)
    looks_per_trial: int = Field(default=10000, ge=0)
