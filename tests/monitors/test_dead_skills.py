"""A skill that never works, where the world disturbs and answers err."""

import re
from itertools import chain
from statistics import fmean

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Ended
from tpvqa.events.events import Acting, Asked, Decided

COUNTED = re.compile(
    r"open the fridge failed in about (\d+) of (\d+) tries"
    r"(?:, of which about (\d+) could have worked)?;"
)
"""Of every try is told whether it counts, though not all of them could have worked."""


def test_it_is_tried_some_twenty_times_with_a_look_and_no_more() -> None:
    """Until it is given up, how it came out is seen: that much is in vain says nothing of answers,
    and what is worth more as it has to be done unseen is not worth more such tries."""
    looked = [looked_after_tries(seed) for seed in range(1, 9)]
    assert fmean(map(len, looked)) + 1 <= 25
    assert fmean(chain.from_iterable(looked)) >= 0.9


def looked_after_tries(seed: int) -> list[bool]:
    """Whether anything was asked after each try but the last."""
    config = TrialConfig.model_validate(
        {
            "seed": seed,
            "task": {"name": "eat_apple"},
            "world": {"spec": "symbolic"},
            "simulation": {"dead": "open"},
            "monitor": {"spec": "belief"},
            "vlm": {"spec": "oracle:0.8"},
            "limits": dict.fromkeys(("actions", "repeats", "replans"), 300),
        }
    )
    writer = MemoryWriter()
    with Trial(config) as trial:
        trial.run(writer)
    end = writer.events[-1]
    assert isinstance(end, Ended)
    assert (end.completed, end.believed_goal) == (False, False)
    tried = [e for e in writer.events if isinstance(e, Acting) and e.action.name == "open"]
    assert 8 <= len(tried) <= 30
    last = [e for e in writer.events if isinstance(e, Decided)][-1]
    said = COUNTED.match(last.reason)
    assert said is not None, last.reason
    failed, tries, able = (int(each or said[2]) for each in said.groups())
    assert failed <= able <= tries == len(tried)
    at = [writer.events.index(each) for each in tried[:-1]]
    return [any(isinstance(e, Asked) for e in writer.events[n : n + 8]) for n in at]
