"""A whole bench from recorded answers: the same rows, and no VLM."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import Install
from tpvqa.bench.cell import Cell
from tpvqa.bench.checking import check
from tpvqa.bench.ledger import ROWS, Ledger
from tpvqa.bench.schedule import run_all
from tpvqa.bench.settings import common_settings
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError
from tpvqa.vlm.kept.upkeep import stats

COIN = '''
import os
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.capabilities import NeedsPictures

class Coin(NeedsPictures):
    """Never the same again: its draws are the system's."""
    name = "coin"

    def __init__(self):
        if "NO_VLM" in os.environ:
            raise RuntimeError("a VLM was made")

    def ask(self, observation, questions):
        p = [int.from_bytes(os.urandom(2), "big") / 65535 for _ in questions]
        return [
            Answer(each, Reply.YES if x > 0.3 else Reply.NO, p_yes=x, source="coin")
            for each, x in zip(questions, p)
        ]
'''
CELLS = [
    Cell("eat_apple", "tpvqa:3", "coin", "images"),
    Cell("serve_breakfast", "tpvqa", "embedded", "images"),
    Cell("serve_breakfast", "tpvqa", "oracle:0.8", "images"),
]
EPISODES = 4


def rows(folder: Path) -> dict[tuple[str, int], dict[str, Any]]:
    found = {}
    for line in (folder / ROWS).read_text(encoding="utf-8").splitlines():
        values = json.loads(line)
        assert not values["error"]
        del values["seconds"]
        found[str([values[name] for name in ("monitor", "vlm")]), values["episode"]] = values
    return found


def run(folder: Path, config: TrialConfig, workers: int) -> dict[tuple[str, int], dict[str, Any]]:
    ledger = Ledger(folder, common_settings(config))
    run_all(ledger, dict.fromkeys(CELLS, EPISODES), config, workers=workers)
    ledger.close()
    return rows(folder)


@pytest.mark.slow
def test_a_bench_of_several_processes_replays_to_the_same_rows_without_a_vlm(
    install: Install, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install("coins", COIN, "coin = coins:Coin")
    monkeypatch.setenv(
        "PYTHONPATH", os.pathsep.join((str(tmp_path), str(Path(__file__).parents[2])))
    )
    file = str(tmp_path / "answers.db")
    common = TrialConfig(seed=5).but(limits={"actions": 8})
    recorded = run(tmp_path / "recorded", common.but(vlm={"record": file}), workers=2)
    assert len(recorded) == EPISODES * len(CELLS)
    anew = run(tmp_path / "anew", common.but(vlm={"cache": str(tmp_path / "other.db")}), workers=1)
    assert anew != recorded  # it is no VLM that answers alike by itself
    monkeypatch.setenv("NO_VLM", "1")
    replay = common.but(vlm={"replay": file})
    check(CELLS, replay, {})
    assert run(tmp_path / "replayed", replay, workers=2) == recorded
    other = common.but(vlm={"replay": str(tmp_path / "other.db")})
    assert run(tmp_path / "other", other, workers=1) == anew
    assert {each.name for each in stats(Path(file)).vlms} == {"coin", "embedded"}


def test_a_bench_of_noise_models_alone_has_nothing_to_record(tmp_path: Path) -> None:
    config = TrialConfig(seed=5).but(vlm={"cache": str(tmp_path / "answers.db")})
    with pytest.raises(BenchError, match=r"--cache: all these VLMs are noise models"):
        check(CELLS[2:], config, {})
