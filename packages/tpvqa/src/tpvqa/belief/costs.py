"""What things cost: from these the prices in all decisions follow."""

from pydantic import BaseModel, ConfigDict, Field


class Costs(BaseModel):
    """Costs in units of one action.

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

    action: float = Field(default=1.0, gt=0)
    question: float = Field(default=0.05, ge=0)
    look: float = Field(default=0.005, ge=0)
    replan: float = Field(default=0.3, ge=0)
    person: float | None = Field(default=None, ge=0)
    failure: float = Field(default=50.0, gt=0)
    misreport: float = Field(default=2.0, ge=0)
    questions_per_step: int = Field(default=1000, ge=0)
    questions_per_trial: int = Field(default=5000, ge=0)
    looks_per_step: int = Field(default=1000, ge=0)
    looks_per_trial: int = Field(default=10000, ge=0)
