"""What others wrote is shown in a terminal, and never obeyed by it."""

import json
import subprocess
import sys
import unicodedata
from io import StringIO
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from tests.cli.conftest import Run
from tests.episodes.believing import believing
from tests.episodes.test_log import file_size
from tpvqa.cli.saying import cell, marked, rendered
from tpvqa.cli.terminal import EpisodeView
from tpvqa.episodes.log import LOG
from tpvqa.episodes.report import render_report
from tpvqa.events import EVENT
from tpvqa.spelling import LONGEST, plain, plain_row

HOSTILE = "\x1b]0;title\x07\x9b2J\x7f\r\u202eabc\u2066\u2028\u2029[red]:smile:[/]\\[bold]\\"
"""A title, C1, DEL, a carriage return, bidirectional overrides, separators, markup, an emoji."""
texts = st.text(st.one_of(st.characters(), st.sampled_from("[]/\\:a\x1b\u202e \n")), max_size=40)


def obeyed(text: str) -> set[str]:
    """The characters that a terminal would obey, line ends apart."""
    kinds = {"Cc", "Cf", "Cs", "Zl", "Zp"}
    return {c for c in text if unicodedata.category(c) in kinds} - {"\n", "\u200c", "\u200d"}


@given(texts)
def test_text_is_shown_as_it_is_spelled(text: str) -> None:
    assert obeyed(plain(text)) == set()
    assert "\n" not in plain(text)
    shown = rendered(f"[dim]{marked(text)}[/] [bold]x[/]")
    assert shown.plain == f"{plain(text)} x"
    assert {span.style for span in shown.spans} <= {"dim", "bold"}
    assert cell(text).plain == plain(text)


def test_it_is_bounded_and_ordinary_text_is_left_alone() -> None:
    assert len(plain("a" * 10**6)) == LONGEST + 1
    for text in ("Is the café's fridge open? 日本 عربي 😀", "می\u200cخواهم", "C:\\new [x]"):
        assert plain(text) == text


def test_lines_that_are_kept_cannot_pass_for_ones_own() -> None:
    assert plain("a\nerror: b\rc", lines=True) == "a\n  error: b\\rc"


def hostile(value: object) -> object:
    """The same event with hostile text wherever there is text of somebody's own."""
    if isinstance(value, dict):
        free = {"text", "reason", "said", "message", "task", "planner", "undoing", "listener"}
        return {
            key: HOSTILE if key in free and isinstance(each, str) else hostile(each)
            for key, each in value.items()
        }
    return [hostile(each) for each in value] if isinstance(value, list) else value


@pytest.mark.parametrize("terminal", [False, True])
def test_an_episode_is_shown_without_obeying_it(terminal: bool) -> None:
    file = StringIO()
    console = Console(file=file, force_terminal=terminal, color_system=None, width=500)
    view = EpisodeView(console, live=False)
    for event in believing():
        view(EVENT.validate_python(hostile(event.model_dump(mode="json", by_alias=True))))
    console.print(view._plan_panel())
    assert obeyed(file.getvalue()) == set()
    assert "[red]:smile:[/]" in file.getvalue()


def test_a_report_shows_what_would_turn_its_letters_round() -> None:
    events = [
        EVENT.validate_python(hostile(event.model_dump(mode="json", by_alias=True)))
        for event in believing()
    ]
    page = render_report(events, Path("nowhere"))
    assert obeyed(page) == set()
    assert "\\u202eabc" in page


@given(texts, st.sampled_from(["=", "+", "-", "@", " =", ""]))
def test_no_cell_of_a_table_is_a_formula(text: str, start: str) -> None:
    (shown,) = plain_row({"said": f"{start}{text}"}).values()
    assert obeyed(str(shown)) == set()
    assert str(shown).lstrip()[:1] not in set("=+-@")
    assert str(shown).removeprefix("'") == plain(f"{start}{text}").removeprefix("'")


def test_errors_and_questions_show_what_they_quote(tpvqa: Run, tmp_path: Path) -> None:
    (tmp_path / "e").mkdir()
    line = {"number": 0, "kind": HOSTILE, HOSTILE: 1}
    (tmp_path / "e" / LOG).write_text(f"{json.dumps(line)}\n")
    for words in (["show", "e"], ["resume", "e"], ["report", "e"], ["run", HOSTILE]):
        code, out, err = tpvqa(*words)
        assert (code, obeyed(out + err)) == (2, set())
    toys = Path(__file__).parents[1] / "fixtures" / "toys"
    said = json.dumps("Is there a {x} \x1b[31m\u202e[red]in the image?")
    (tmp_path / "q.yaml").write_text(f"predicates:\n  found: {said}\n")
    files = ("--domain", toys / "domain.pddl", "--problem", toys / "collect.pddl")
    code, out, err = tpvqa("questions", *files, "--questions", tmp_path / "q.yaml")
    assert obeyed(out + err) == set()
    assert (code, "\\x1b[31m" in out) == (0, True)


def test_what_cannot_be_written_has_an_exit_code_of_its_own(tpvqa: Run, tmp_path: Path) -> None:
    trial = ["run", "build_tower", "--world", "symbolic", "--vlm", "oracle"]
    with file_size(9000):
        code, _, err = tpvqa(*trial, "--out", "e")
    assert (code, "tpvqa resume e" in err) == (6, True)
    assert tpvqa("resume", "e")[0] == 0
    with file_size(2000):
        code, _, err = tpvqa("report", "e")
    assert (code, "report.html: cannot be written" in err) == (6, True)
    for place in ("/sys/kernel/known.json", "/proc/known.json"):
        code, _, err = tpvqa(*trial, "--experience", place, "--out", "f")
        assert (code, "--experience" in err) == (6, True), err
        assert not Path("f").exists()  # it is told before anything moves
    code, _, err = tpvqa(*trial, "--experience", "new/known.json", "--out", "e")
    assert (code, "holds an episode" in err, Path("new").exists()) == (2, True, False)
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "tpvqa", "show", "e"], stdout=full, stderr=subprocess.PIPE
        )
    assert (done.returncode, b"Traceback" in done.stderr) == (6, False)


def test_where_nobody_reads_what_is_printed_it_ends_as_well(tpvqa: Run) -> None:
    """`>&-`: a program that is begun without standard output."""
    command = ["sh", "-c", 'exec "$0" -m tpvqa plan build_tower >&-', sys.executable]
    done = subprocess.run(command, stderr=subprocess.PIPE)
    assert (done.returncode, done.stderr) == (0, b"")


def test_a_folder_with_a_torn_beginning_is_taken_over(tpvqa: Run) -> None:
    Path("e").mkdir()
    (Path("e") / LOG).write_bytes(b'{"number":0,"time":0.0')
    code, _, err = tpvqa("resume", "e")
    assert (code, "run … --out e" in err) == (2, True)
    trial = ["run", "build_tower", "--world", "symbolic", "--vlm", "oracle", "--out", "e"]
    code, _, err = tpvqa(*trial)
    assert (code, "begun anew" in err) == (0, True)
