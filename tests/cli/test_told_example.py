"""The page on the belief monitor shows lines of a trial: they are what its command prints."""

import html
import re
import shlex
from pathlib import Path

from tests.cli.conftest import Run

PAGE = Path(__file__).parents[2] / "docs" / "belief.md"
EXAMPLE = re.compile(r"`tpvqa (run [^`]*)`, in the report:\s*```\n(.*?)```", re.DOTALL)


def test_the_lines_on_the_page_are_those_of_the_report(tpvqa: Run, tmp_path: Path) -> None:
    found = EXAMPLE.search(PAGE.read_text())
    assert found is not None
    command, lines = found[1], re.split(r"^(?=\S)", found[2], flags=re.MULTILINE)
    tpvqa(*shlex.split(command), "--out", str(tmp_path / "episode"))
    page = tmp_path / "page.html"
    assert tpvqa("report", str(tmp_path / "episode"), "--out", str(page))[0] == 0
    told = " ".join(html.unescape(re.sub(r"<[^>]+>", " ", page.read_text())).split())
    shown = [" ".join(line.replace(":", "", 1).split()) for line in lines if line.strip()]
    assert shown
    for line in shown:
        assert line in told
