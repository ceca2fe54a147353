"""The moving picture of an episode."""

from pathlib import Path

from PIL import Image, ImageSequence

from tools.episode_gif import encode, scenes
from tpvqa import Trial, TrialConfig
from tpvqa.episodes import EpisodeWriter, read_episode


def test_an_episode_becomes_a_gif_that_tells_plan_answers_decisions_and_end(tmp_path: Path) -> None:
    with Trial(TrialConfig(task="clean_dishes", seed=3)) as trial:
        ended = trial.run(EpisodeWriter(tmp_path / "episode"))
    told = list(scenes(read_episode(tmp_path / "episode"), tmp_path / "episode"))
    heads = [scene.head for scene in told]
    assert heads[0] == "plan"
    assert heads.count("act") == ended.actions
    assert {"look and ask", "go on"} <= set(heads)
    assert heads[-1] == ("goal reached" if ended.completed else ended.ending)
    path = tmp_path / "trial.gif"
    path.write_bytes(encode(told))
    with Image.open(path) as gif:
        frames = [frame.copy() for frame in ImageSequence.Iterator(gif)]
        assert gif.info["loop"] == 0
    assert 1 < len(frames) <= len(told)  # equal ones are one


def test_the_front_pages_picture_is_small_enough_to_load() -> None:
    assert (Path(__file__).parents[2] / "docs/images/trial.gif").stat().st_size <= 2_000_000
