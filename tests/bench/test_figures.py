"""Figures of a bench: every curve in its interval, every monitor told apart without colour."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.collections import PolyCollection

from tests.bench.test_statistics import row
from tpvqa.bench import figures
from tpvqa.bench.cell import Cell
from tpvqa.bench.curve import ACCURACIES, curve_cells, curves
from tpvqa.bench.report import Results, write_bench_report
from tpvqa.bench.statistics import wilson
from tpvqa.bench.style import styles
from tpvqa.bench.summary import summaries
from tpvqa.cli.bench_tables import print_results
from tpvqa.errors import WriteError

MONITORS = ("tpvqa", "tpvqa:strict", "effectvqa", "palmevqa", "successvqa", "belief", "tp")
EPISODES = 20


@pytest.fixture(scope="module")
def drawn() -> Any:
    rows = {
        cell: [row(episode=k, completed=k < 20 * float(cell.vlm[7:]) - 5) for k in range(EPISODES)]
        for cell in curve_cells(["eat"], MONITORS)
    }
    figure = figures.accuracy_curves(curves(rows, ["eat"], MONITORS))
    yield figure
    figures.close(figure)


def test_every_curve_lies_in_a_band_that_is_its_interval(drawn: Any) -> None:
    (axes,) = drawn.axes
    bands = [each for each in axes.collections if isinstance(each, PolyCollection)]
    assert len(bands) == len(MONITORS)
    found = wilson(15, EPISODES)  # all of them at an accuracy of 1
    corners = np.concatenate([band.get_paths()[0].vertices for band in bands])
    ends = set(np.round(corners[corners[:, 0] == 1, 1], 6))
    assert ends == {round(found.low, 6), round(found.high, 6)}


def test_the_legend_names_every_monitor_in_order(drawn: Any) -> None:
    (legend,) = drawn.legends
    assert [text.get_text() for text in legend.get_texts()] == list(MONITORS)


def test_what_never_asks_is_measured_once() -> None:
    cells = curve_cells(["eat"], ["tp", "none", "tpvqa"])
    assert [cell for cell in cells if cell.monitor != "tpvqa"] == [
        Cell("eat", monitor, "oracle:1", "symbolic") for monitor in ("tp", "none")
    ]
    assert len(cells) == 2 + len(ACCURACIES)


def test_no_two_monitors_are_drawn_alike() -> None:
    """Nor printed alike: line, marker and filling differ where the colour does not tell."""
    many = [
        *("tpvqa", "tpvqa:strict", "tpvqa:3", "tpvqa:5:strict", "effectvqa", "effectvqa:strict"),
        *("palmevqa", "successvqa", "tp", "blind:5", "vote:3", "lead:3", "belief", "of-others"),
    ]
    found = styles(many)
    assert len({str(each.plotted) for each in found.values()}) == len(many)
    shapes = [(str(s.line), s.marker, s.filled) for m, s in found.items() if m != "blind:5"]
    assert len(set(shapes)) == len(many) - 1


def test_what_is_wrongly_done_is_counted_and_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cell = Cell("eat", "belief", "oracle:0.8", "symbolic")
    ends = [row(episode=k, believed_goal=True, completed=k > 2) for k in range(4)]
    results = Results({}, {cell: [*ends, row(episode=4, because="gave up")]})
    (found,) = results.summaries
    assert (found.wrongly_done, found.completed) == (3, 1)
    print_results(results)
    head, line = (each.split() for each in capsys.readouterr().out.splitlines()[1:3])
    assert "wrongly done" in " ".join(head)
    assert line[:5] == ["eat", "belief", "0.200", "0.04–0.62", "3"]
    page = write_bench_report(tmp_path, results).read_text(encoding="utf-8")
    assert "<th>wrongly done</th>" in page
    assert "<td>3</td>" in page


def test_no_figure_is_left_open_however_many_tables_there_are(
    tmp_path: Path, recwarn: pytest.WarningsRecorder
) -> None:
    cells = {
        Cell("eat", "tp", "oracle:0.8", "symbolic", f"failure=0.{k}"): [row(completed=True)]
        for k in range(9)
    }
    before = pyplot.get_fignums()
    write_bench_report(tmp_path, Results({}, cells))
    assert pyplot.get_fignums() == before
    assert not [each for each in recwarn if "figures" in str(each.message)]


def test_a_link_in_the_place_of_the_figures_is_not_followed(tmp_path: Path) -> None:
    elsewhere, folder = tmp_path / "elsewhere", tmp_path / "bench"
    elsewhere.mkdir()
    folder.mkdir()
    (folder / "figures").symlink_to(elsewhere)
    cells = {Cell("eat", "tp", "oracle:0.8", "symbolic"): [row(completed=True)]}
    with pytest.raises(WriteError, match=r"figures is a link.*Remove what lies there"):
        write_bench_report(folder, Results({}, cells))
    assert not any(elsewhere.iterdir())


def test_bars_have_intervals_and_figures() -> None:
    cells = {
        Cell("eat", monitor, "oracle:0.8", "symbolic"): [row(episode=0, completed=True), row()]
        for monitor in MONITORS
    }
    figure = figures.completion(summaries(cells))
    (axes,) = figure.axes
    assert [text.get_text() for text in axes.texts] == [".50"] * len(MONITORS)
    assert len(axes.containers) == 2 * len(MONITORS)  # a bar and its interval
    figures.close(figure)
