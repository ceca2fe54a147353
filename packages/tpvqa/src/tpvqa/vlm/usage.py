"""What asking a server costs: requests, tokens and money; and a budget that stops in time."""

import json
from collections.abc import Mapping
from dataclasses import asdict, astuple, dataclass
from typing import Any, Self

from tpvqa.errors import AnswerError, BudgetError, EpisodeError

MILLION = 1_000_000


@dataclass(frozen=True, slots=True)
class Usage:
    """What was asked of a server.

    Attributes:
        requests: Sent, retries included.
        prompt_tokens: As the server counted them.
        completion_tokens: The same.
        untold: Replies that did not say how many tokens they took.
    """

    requests: int = 0
    prompt_tokens: int = 0
    completion_tokens: int = 0
    untold: int = 0

    def __add__(self, other: "Usage") -> "Usage":
        return Usage(*(a + b for a, b in zip(astuple(self), astuple(other), strict=True)))

    def __sub__(self, other: "Usage") -> "Usage":
        return Usage(*(a - b for a, b in zip(astuple(self), astuple(other), strict=True)))

    @property
    def tokens(self) -> int:
        """All of them."""
        return self.prompt_tokens + self.completion_tokens

    def cost(self, prompt: float, completion: float) -> float:
        """In money, by prices of a million tokens."""
        return (self.prompt_tokens * prompt + self.completion_tokens * completion) / MILLION

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Self:
        """From plain values.

        Raises:
            ValueError: They are no counts.
        """
        counts = [values.get(name, 0) for name in cls.__slots__]
        if any(type(each) is not int or each < 0 for each in counts):
            raise ValueError("no counts")
        return cls(*counts)


def usage_told(body: bytes | str) -> Usage:
    """The usage of one request, as the reply's body tells it."""
    try:
        told = json.loads(body)["usage"]
        counts = told["prompt_tokens"], told.get("completion_tokens", 0)
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return Usage(1, untold=1)
    if any(type(each) is not int or not 0 <= each < 10**9 for each in counts):
        return Usage(1, untold=1)
    return Usage(1, *counts)


class Budget:
    """Counts what is spent, and says no to a request that would go beyond a limit.

    What a request will take is not known before it: it is taken to be as large as the largest one
    so far, and requests under way count as much.

    Args:
        requests: At most so many.
        tokens: At most so many, of prompts and completions together.
        cost: At most so much money.
        prices: Of a million tokens of prompts and of completions.

    Attributes:
        spent: So far.
        largest: The most that one request took of either kind of tokens.
    """

    def __init__(
        self,
        *,
        requests: int | None = None,
        tokens: int | None = None,
        cost: float | None = None,
        prices: tuple[float, float] | None = None,
    ):
        if cost is not None and prices is None:
            raise AnswerError("--max-cost needs prices: --price-prompt and --price-completion")
        self._requests, self._tokens, self._cost = requests, tokens, cost
        self._prices = prices or (0.0, 0.0)
        self.spent = Usage()
        self.largest, self._under_way = Usage(), 0

    def snapshot(self) -> dict[str, Any]:
        """What was spent, as plain values."""
        return {"spent": asdict(self.spent), "largest": asdict(self.largest)}

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Count what was spent before, too; logs of before say nothing of the largest.

        Raises:
            EpisodeError: It is no such snapshot.
        """
        try:
            self.spent += Usage.of(snapshot["spent"])
            self.largest = Usage.of(snapshot.get("largest", {}))
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise EpisodeError(
                f"What the log keeps of asking a server is damaged ({error}). Show the episode "
                "instead"
            ) from error

    @property
    def blind(self) -> bool:
        """Whether tokens or money are limited, and no request has told yet how many it takes: then
        one at a time is made."""
        limited = self._tokens is not None or self._cost is not None
        return limited and not self.largest.tokens

    def see(self, more: int = 1) -> None:
        """See that so many more requests can be made.

        Raises:
            BudgetError: They would go beyond a limit.
            AnswerError: A limit is of tokens or money, and the server does not count them.
        """
        spent, coming, each = self.spent, self._under_way + more, self.largest
        if (self._tokens is not None or self._cost is not None) and spent.untold:
            raise AnswerError(
                "the server does not tell how many tokens it takes, so that no limit of tokens or "
                "money can be kept. Limit requests instead: --max-requests"
            )
        if self._requests is not None and spent.requests + coming > self._requests:
            raise BudgetError("requests", f"{spent.requests} of {self._requests}", "--max-requests")
        tokens = spent.tokens + coming * each.tokens
        if self._tokens is not None and (tokens > self._tokens or spent.tokens >= self._tokens):
            raise BudgetError(
                "tokens", f"{spent.tokens:,} of {self._tokens:,}", "--max-tokens-spent"
            )
        now, then = spent.cost(*self._prices), each.cost(*self._prices)
        if self._cost is not None and (now + coming * then > self._cost or now >= self._cost > 0):
            raise BudgetError("money", f"{now:.4g} of {self._cost:g}", "--max-cost")

    def begin(self) -> None:
        """A request is about to be sent; raises as `see` does."""
        self.see()
        self._under_way += 1

    def end(self, told: Usage) -> None:
        """A request came to its end."""
        self._under_way -= 1
        self.spent += told
        most = self.largest
        self.largest = Usage(
            prompt_tokens=max(told.prompt_tokens, most.prompt_tokens),
            completion_tokens=max(told.completion_tokens, most.completion_tokens),
        )
