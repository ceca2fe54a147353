"""What the bench of scenes writes: its table and targets, its figure, and every scene."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tpvqa.bench.figures import close, saved
from tpvqa.bench.ledger import REMEDY
from tpvqa.files import write_whole
from tpvqa_experiments.scenes.figures import reliability_figure
from tpvqa_experiments.scenes.judged import Judged
from tpvqa_experiments.scenes.tables import lines, markdown, targets
from tpvqa_experiments.scenes.weighing import Weighing


def write_results(
    folder: Path, judged: Sequence[Judged], weighings: Sequence[Weighing], seed: int
) -> None:
    """Write `scenes.md`, `scenes.json`, `targets.json`, `judged.json` and the figure.

    Raises:
        MissingExtraError: matplotlib is not installed.
        WriteError: The folder cannot be written to.
    """
    checks = targets(judged, seed)
    _write(folder / "scenes.md", markdown(judged, weighings, checks).encode())
    _write_json(folder / "scenes.json", [line.flat() for line in lines(judged)])
    _write_json(folder / "targets.json", [check.flat() for check in checks])
    _write_json(folder / "judged.json", [_told(each) for each in judged])
    figure = reliability_figure(judged)
    for kind in ("svg", "png"):
        _write(folder / f"reliability.{kind}", saved(figure, kind))
    close(figure)


def _told(each: Judged) -> Mapping[str, Any]:
    scene = each.scene
    return {
        "split": scene.split,
        "model": scene.model,
        "problem": scene.problem,
        "as_answered": scene.as_answered,
        "naive": each.naive.right,
        "belief": each.belief.right,
        "probability": round(each.belief.sure, 6),
        "states": each.belief.states,
        "within": each.belief.within,
    }


def _write_json(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    _write(path, (json.dumps(rows, indent=1) + "\n").encode())


def _write(path: Path, data: bytes) -> None:
    write_whole(path, data, remedy=REMEDY)
