"""The notebook in examples/, run as it lies there."""

import re
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

read: Any = nbformat.read
NOTEBOOK = Path(__file__).parents[1] / "examples/notebook/trial.ipynb"


def test_the_notebook_lies_there_without_outputs() -> None:
    cells = read(NOTEBOOK, as_version=4).cells
    assert not [cell for cell in cells if cell.get("outputs") or cell.get("execution_count")]


def test_the_notebook_runs_and_shows_plan_trial_belief_and_picture() -> None:
    notebook = read(NOTEBOOK, as_version=4)
    client = NotebookClient(
        notebook, timeout=120, resources={"metadata": {"path": str(NOTEBOOK.parent)}}
    )
    client.execute()  # raises where a cell does
    outputs = [out for cell in notebook.cells for out in cell.get("outputs", [])]
    said = "".join(out.get("text", "") for out in outputs)  # one line may come in several
    shown = [out["data"] for out in outputs if "data" in out]
    assert any("put_down red_cube left_tray" in each.get("text/plain", "") for each in shown)
    assert "put the red cube into the left tray" in said
    assert "Is the red cube in the left tray? yes" in said
    beliefs = [float(p) for p in re.findall(r"'\(lies red_cube left_tray\)': ([\d.]+)", said)]
    assert beliefs[0] < 0.1
    assert beliefs[-1] > 0.9
    assert any("image/jpeg" in each for each in shown)
    assert "report.html True" in said
