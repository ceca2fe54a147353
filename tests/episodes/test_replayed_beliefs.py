"""What a filter would have believed of a recorded episode, beside what is true."""

from pathlib import Path

import pytest

from tools.replayed_beliefs import compared
from tpvqa import Trial, TrialConfig
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.events.events import Decided


@pytest.mark.parametrize("seed", [3, 4])
def test_it_is_what_the_monitor_believed_and_the_truth_is_the_worlds(
    tmp_path: Path, seed: int
) -> None:
    config = TrialConfig(task="clean_dishes", vlm="oracle:0.9", monitor="belief", seed=seed)
    with Trial(config) as trial:
        writer = EpisodeWriter(tmp_path / "e", durable=False)
        trial.run(writer)
        writer.close()
    told = [
        (name, likely)
        for event in read_episode(tmp_path / "e")
        if isinstance(event, Decided)
        for name, likely in event.belief.items()
    ]
    found = list(compared(tmp_path / "e"))
    assert [likely for _, likely in told] == pytest.approx([p for p, _ in found], abs=0.1)
    goal = [true for (name, _), (_, true) in zip(told, found, strict=True) if "clean" in name]
    assert goal[0] is False
    assert goal[-1] is True
