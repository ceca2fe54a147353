"""Trials under noise models that are gone on with: the same answers, and old logs as they were."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.doubles import configured
from tpvqa import Trial
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.events import Started
from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.resuming import resume

Said = list[list[tuple[str, float | None]]]


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = FastDownward()
    yield planner
    planner.close()


def run(folder: Path, vlm: str, planner: Planner) -> Said:
    config = configured(
        task="clean_dishes", world="symbolic", monitor="tpvqa:3", vlm=vlm, failure=0.4, seed=4
    ).but(simulation={"moved": 0.2})
    with Trial(config, planner=planner) as trial:
        writer = EpisodeWriter(folder)
        trial.run(writer)
        writer.close()
    return said(folder)


def said(folder: Path) -> Said:
    events = read_episode(folder)
    return [[(a.reply, a.p_yes) for a in e.answers] for e in events if e.kind == "answered"]


def cut(folder: Path, share: float) -> None:
    lines = (folder / LOG).read_bytes().splitlines(keepends=True)
    (folder / LOG).write_bytes(b"".join(lines[: int(len(lines) * share)]))


@pytest.mark.parametrize("share", [0.3, 0.7])
@pytest.mark.parametrize(
    "vlm",
    ["recorded:gemma-3-12b", "oracle:0.7:0.3:0.6", "flawed:misread:0.2:0.9", "flawed:late:0.9"],
)
def test_what_is_answered_after_an_interruption_is_what_would_have_been(
    vlm: str, share: float, tmp_path: Path, planner: Planner
) -> None:
    whole = run(tmp_path, vlm, planner)
    cut(tmp_path, share)
    assert len(said(tmp_path)) < len(whole)
    resume(tmp_path)
    assert said(tmp_path) == whole


def test_an_old_log_goes_on_with_errors_drawn_afresh(tmp_path: Path, planner: Planner) -> None:
    fresh = run(tmp_path, "recorded:gemma-3-12b:fresh", planner)
    lines = (tmp_path / LOG).read_text(encoding="utf-8").splitlines()
    first = json.loads(lines[0])
    first["vlm"] = first["config"]["vlm"]["spec"] = "recorded:gemma-3-12b"
    (tmp_path / LOG).write_text("\n".join([json.dumps(first), *lines[1:], ""]), encoding="utf-8")
    cut(tmp_path, 0.4)
    resume(tmp_path)
    assert said(tmp_path) == fresh
    lasting = run(tmp_path / "lasting", "recorded:gemma-3-12b", planner)
    assert lasting != fresh
    (started,) = (e for e in read_episode(tmp_path / "lasting") if isinstance(e, Started))
    assert started.vlm == "recorded:gemma-3-12b:lasting"
