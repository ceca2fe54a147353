"""What asking a server took, as the log has it."""

from pydantic import ConfigDict, Field

from tpvqa.told import ToldModel


class Record(ToldModel):
    """A part of an event: strict, and never changed."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, populate_by_name=True, allow_inf_nan=False
    )


class UsageRecord(Record):
    """What asking a server took; `untold` replies did not say how many tokens."""

    requests: int = Field(default=0, ge=0)
    prompt_tokens: int = Field(default=0, ge=0)
    completion_tokens: int = Field(default=0, ge=0)
    untold: int = Field(default=0, ge=0)

    def plus(self, other: "UsageRecord | None") -> "UsageRecord":
        """Both together."""
        if other is None:
            return self
        names = type(self).model_fields
        return UsageRecord(**{n: getattr(self, n) + getattr(other, n) for n in names})

    @property
    def said(self) -> str:
        """In words."""
        tokens = f"{self.prompt_tokens:,} + {self.completion_tokens:,} tokens"
        if self.untold:
            tokens += f", {self.untold} replies without a count"
        return f"{self.requests} request{'' if self.requests == 1 else 's'}, {tokens}"
