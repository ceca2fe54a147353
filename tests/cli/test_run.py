"""`tpvqa run`, `resume`, `show` and `report`, as a user types them."""

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from contextlib import suppress
from html.parser import HTMLParser
from pathlib import Path
from uuid import uuid4

import pytest

from tests.cli.conftest import Run
from tests.moments import moments
from tests.planning.test_processes import eventually
from tpvqa import __version__
from tpvqa.belief import Calibration
from tpvqa.belief.learning.experience import Experience
from tpvqa.episodes import read_episode
from tpvqa.events import Ended
from tpvqa.tasks import find_task

TOYS = Path(__file__).parents[1] / "fixtures" / "toys"


SYMBOLIC = ["--world", "symbolic", "--vlm", "oracle"]


def test_a_trial_prints_its_plan_questions_decisions_and_end(tpvqa: Run) -> None:
    code, out, _ = tpvqa("run", "clean_dishes", *SYMBOLIC, "--seed", 4)
    assert code == 0
    assert "plan find the plate · pick up the plate · find the sink · wash the plate" in out
    assert re.search(r"Is the plate clean\? (\d+ )?yes", out)
    assert "goal reached" in out
    assert Path("episodes/clean_dishes-seed4/episode.jsonl").exists()


def test_json_has_the_promised_fields(tpvqa: Run) -> None:
    code, out, _ = tpvqa("run", "eat_apple", *SYMBOLIC, "--json", "--out", "here")
    result = json.loads(out)
    assert code == 0
    assert result["completed"] is True
    assert result["ended_because"] == "goal"
    assert result["episode"] == "here"
    assert {"actions", "questions", "repeats", "replans"} <= set(result)


def test_exit_code_one_where_the_goal_is_not_reached(tpvqa: Run) -> None:
    code, out, _ = tpvqa("run", "clean_dishes", *SYMBOLIC, "--failure", 1, "--json")
    assert code == 1
    assert json.loads(out)["ended_because"] == "gave up"


def test_ones_own_domain_against_a_scripted_world(tpvqa: Run) -> None:
    code, out, err = tpvqa(
        *("run", "--domain", TOYS / "domain.pddl", "--problem", TOYS / "collect.pddl"),
        *("--questions", TOYS / "questions.yaml", "--world", f"scripted:{TOYS / 'script.yaml'}"),
        *("--vlm", "oracle"),
    )
    assert (code, err) == (0, "")
    assert "find the cyan container" in out


def test_domain_and_problem_can_simply_be_named(tpvqa: Run) -> None:
    files = find_task("clean_dishes")
    words = ["--vlm", "oracle", "--failure", 0, "--json"]
    code, out, _ = tpvqa("run", files.domain, files.problem, *words, "--out", "e1")
    assert code == 0
    assert json.loads(out)["task"] == "clean_dishes"
    code, _, err = tpvqa("run", files.domain, files.problem, "--domain", files.domain)
    assert code == 2
    assert "given twice" in err


def test_the_version_is_said(tpvqa: Run) -> None:
    assert tpvqa("--version") == (0, f"tpvqa {__version__}\n", "")


def test_files_that_a_monitor_cannot_use_are_refused(tpvqa: Run) -> None:
    words = ["--world", "symbolic", "--monitor", "tpvqa", "--experience", "known.json"]
    code, _, err = tpvqa("run", "clean_dishes", *words)
    assert code == 2
    assert "weighs no answers" in err
    Path("broken.json").write_text('{"failure": [1, 2]}')
    code, _, err = tpvqa("run", "clean_dishes", "--experience", "broken.json")
    assert code == 2
    assert "broken.json" in err
    assert not Path("episodes").exists()


def test_what_answers_are_taken_to_be_worth_is_said(tpvqa: Run) -> None:
    words = ["run", "clean_dishes", "--world", "symbolic", "--vlm", "oracle:0.9"]
    assert "there is no calibration of oracle:0.9" in tpvqa(*words)[2]
    Calibration.default("somebody").save(Path("c.json"))
    _, _, err = tpvqa(*words, "--calibration", "c.json")
    assert "learnt of somebody" in err
    code, _, err = tpvqa("run", "build_tower", "--world", "images")
    assert code == 2
    assert "--world symbolic" in err
    assert not Path("episodes/build_tower-seed0").exists()


def test_without_standard_input(tmp_path: Path) -> None:
    command = f"{shlex.quote(sys.executable)} -m tpvqa run clean_dishes --world symbolic <&-"
    done = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_experience_is_kept_for_one_vlm_and_by_whoever_goes_on(tpvqa: Run) -> None:
    words = ["--world", "symbolic", "--experience", "known.json", "--seed", 3]
    assert tpvqa("run", "clean_dishes", *words, "--vlm", "oracle:0.7", "--out", "one")[0] == 0
    one = Experience.load(Path("known.json"))
    assert one is not None
    assert (one.vlm, one.trials) == ("oracle:0.7", 1)

    log = Path("one/episode.jsonl")
    log.write_bytes(b"".join(log.read_bytes().splitlines(keepends=True)[:40]))
    Path("known.json").unlink()
    code, _, err = tpvqa("resume", "one")
    assert code == 2
    pasted = shlex.split(err.splitlines()[-1])
    assert pasted == ["tpvqa", "resume", "one", "--experience", str(Path("known.json").resolve())]
    assert tpvqa(*pasted[1:])[0] == 0
    assert Experience.load(Path("known.json")) == one

    log.write_bytes(b"".join(log.read_bytes().splitlines(keepends=True)[:40]))
    code, _, err = tpvqa(*pasted[1:])
    assert code == 0
    assert "was written by other trials" in err
    assert Experience.load(Path("known.json")) == one

    code, _, err = tpvqa("run", "clean_dishes", *words, "--vlm", "oracle:0.9", "--out", "two")
    assert code == 0
    assert "how far to trust oracle:0.7" in err
    two = Experience.load(Path("known.json"))
    assert two is not None
    assert (two.vlm, two.trials) == ("oracle:0.9", 2)
    assert sum(two.failure) > sum(one.failure)
    assert "another domain" not in err
    code, _, err = tpvqa("run", "build_tower", *words, "--vlm", "oracle:0.9", "--out", "three")
    assert code == 0
    assert f"learned in another domain, {two.domain};" in err


def test_without_a_questions_file_the_fallbacks_are_reported_once(tpvqa: Run) -> None:
    code, _, err = tpvqa(
        *("run", "--domain", TOYS / "domain.pddl", "--problem", TOYS / "collect.pddl"),
        *("--failure", 0),
    )
    assert code == 0
    notes = err.splitlines()
    assert notes
    assert len(notes) == len(set(notes))


def test_domains_in_other_encodings_are_run_and_resumed(tpvqa: Run) -> None:
    for name in ("domain.pddl", "collect.pddl"):
        Path(name).write_bytes("; Küche\r\n".encode("latin-1") + (TOYS / name).read_bytes())
    files = ("--domain", "domain.pddl", "--problem", "collect.pddl", "--failure", 0)
    code, _, err = tpvqa("run", *files, "--out", "here")
    assert (code, "Traceback" in err) == (0, False)
    log = Path("here/episode.jsonl")
    log.write_bytes(b"".join(log.read_bytes().splitlines(keepends=True)[:5]))
    assert tpvqa("resume", "here")[0] == 0


@pytest.mark.parametrize(
    "option", ["--questions", "--world-file", "--world"], ids=lambda option: str(option)[2:]
)
def test_other_files_have_to_be_utf8(tpvqa: Run, tmp_path: Path, option: str) -> None:
    file = tmp_path / "file.yaml"
    file.write_bytes("# fine\n# Küche\n".encode("latin-1"))
    value = f"scripted:{file}" if option == "--world" else file
    files = ("--domain", TOYS / "domain.pddl", "--problem", TOYS / "collect.pddl")
    code, out, err = tpvqa("run", *files, option, value)
    assert code == 2
    assert f"{file}:2: the byte 0xfc is not UTF-8" in err
    assert "Traceback" not in out + err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["run", "serve_breakfst"], "Did you mean 'serve_breakfast'?"),
        (["run"], "Name a shipped task"),
        (["run", "eat_apple", "--vlm", "orcle"], "Did you mean 'oracle'?"),
        (["run", "eat_apple", "--monitor", "tpvka", *SYMBOLIC], "Did you mean 'tpvqa'?"),
        (["run", "eat_apple", "--world", "kitchn"], "Did you mean 'kitchen'?"),
        (["run", "eat_apple", "--world", "scripted:none.yaml"], "none.yaml: cannot be read"),
        (["run", "eat_apple", "--majority", "foo", *SYMBOLIC], "Write 'tie'"),
        (["run", "--domain", "no.pddl", "--problem", "no.pddl"], "no.pddl"),
        (["show", "nowhere"], "holds no episode"),
        (["resume", "nowhere"], "holds no episode"),
        (["report", "nowhere"], "holds no episode"),
    ],
)
def test_bad_input_gets_one_clear_line_and_leaves_nothing(
    tpvqa: Run, words: list[str], says: str
) -> None:
    code, out, err = tpvqa(*words)
    assert code == 2
    assert says in err
    assert "Traceback" not in out + err
    assert list(Path().iterdir()) == []


def test_show_prints_the_same_trial_again(tpvqa: Run) -> None:
    _, ran, _ = tpvqa("run", "eat_apple", *SYMBOLIC, "--seed", 2, "--out", "here")
    code, shown, _ = tpvqa("show", "here")
    assert code == 0
    assert shown.splitlines() == ran.splitlines()[:-1]


def test_the_report_needs_nothing_beside_it(tpvqa: Run) -> None:
    tpvqa("run", "eat_apple", *SYMBOLIC, "--seed", 2, "--out", "here")
    code, out, _ = tpvqa("report", "here")
    assert code == 0
    page = Path(out.strip()).read_text()
    sources: list[str] = []

    class Sources(HTMLParser):
        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            sources.extend(
                value
                for name, value in attrs
                if name in ("src", "href") and value and not value.startswith(("data:", "#"))
            )

    Sources().feed(page)
    assert sources == []
    for question in ("Is the fridge open?", "Is the apple cut in half?"):
        assert question in page


def test_an_episode_is_named_by_its_folder_or_its_log(tpvqa: Run) -> None:
    tpvqa("run", "eat_apple", *SYMBOLIC, "--seed", 2, "--out", "here")
    log = Path("here/episode.jsonl")
    assert tpvqa("report", log)[:2] == (0, "here/report.html\n")
    log.write_bytes(b"".join(log.read_bytes().splitlines(keepends=True)[:9]))
    code, out, _ = tpvqa("resume", log, "--json")
    assert (code, json.loads(out)["episode"]) == (0, "here")
    assert tpvqa("show", log)[:2] == tpvqa("show", "here")[:2]


@pytest.mark.parametrize("out", ["folder", "missing/report.html", "here/episode.jsonl/report.html"])
def test_a_report_that_cannot_be_written_leaves_nothing(tpvqa: Run, out: str) -> None:
    tpvqa("run", "eat_apple", *SYMBOLIC, "--seed", 2, "--out", "here")
    Path("folder").mkdir()
    before = sorted(Path().rglob("*"))
    code, _, err = tpvqa("report", "here", "--out", out)
    assert (code, err.startswith(f"error: {out}")) == (2, True)
    assert sorted(Path().rglob("*")) == before


@pytest.mark.parametrize(
    "out",
    ["here/episode.jsonl", "here/labels.jsonl", "here/frames/new.html", "log", "in/episode.jsonl"],
)
def test_a_report_is_not_written_over_its_episode(tpvqa: Run, out: str) -> None:
    tpvqa("run", "eat_apple", *SYMBOLIC, "--seed", 2, "--out", "here")
    Path("log").symlink_to("here/episode.jsonl")
    Path("in").symlink_to("here")
    log = Path("here/episode.jsonl").read_bytes()
    for force in ([], ["--force"]):
        code, _, err = tpvqa("report", "here", "--out", out, *force)
        assert (code, err.startswith(f"error: {out} is what the episode consists of")) == (2, True)
    assert Path("here/episode.jsonl").read_bytes() == log
    assert Path("log").is_symlink()


@pytest.mark.parametrize("words", [[], ["--out", "notes.html"]])
def test_a_report_takes_the_place_of_reports_alone(tpvqa: Run, words: list[str]) -> None:
    tpvqa("run", "eat_apple", *SYMBOLIC, "--seed", 2, "--out", "here")
    page = Path(words[-1] if words else "here/report.html")
    page.write_text("<!doctype html>\n<html>\n<title>notes</title>")
    code, _, err = tpvqa("report", "here", *words)
    assert (code, f"{page} is there, and is no report" in err, "--force" in err) == (2, True, True)
    assert "notes" in page.read_text()
    assert tpvqa("report", "here", *words, "--force")[0] == 0
    assert tpvqa("report", "here", *words)[0] == 0


def test_a_report_takes_the_place_of_a_link_only_if_told_to(tpvqa: Run) -> None:
    tpvqa("run", "eat_apple", *SYMBOLIC, "--seed", 2, "--out", "here")
    Path("notes.txt").write_text("mine")
    for name, there in (("link", "notes.txt"), ("nowhere", "gone"), ("stdout", "/dev/stdout")):
        Path(name).symlink_to(there)
        code, _, err = tpvqa("report", "here", "--out", name)
        assert (code, f"{name} is there, and is no report" in err) == (2, True), err
        assert Path(name).is_symlink()
    assert tpvqa("report", "here", "--out", "link", "--force")[0] == 0
    assert not Path("link").is_symlink()
    assert Path("notes.txt").read_text() == "mine"


def test_a_report_of_an_unfinished_episode(tpvqa: Run) -> None:
    tpvqa("run", "eat_apple", *SYMBOLIC, "--seed", 2, "--out", "here")
    log = Path("here/episode.jsonl")
    lines = log.read_bytes().splitlines(keepends=True)
    for cut in moments([event.kind for event in read_episode(Path("here"))], spread=4):
        log.write_bytes(b"".join(lines[:cut]))
        assert tpvqa("report", "here")[0] == 0
        assert tpvqa("show", "here")[0] == 0
    assert "unfinished" in Path("here/report.html").read_text()


def marked(mark: str) -> list[int]:
    """The processes that were started, at whatever remove, with this mark in the environment."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/environ"):
        with suppress(OSError):
            if mark.encode() in entry.read_bytes():
                found.append(int(entry.parent.name))
    return found


def story(folder: Path) -> list[dict[str, object]]:
    """The events of an episode without what differs between two runs of one trial: times."""
    events = read_episode(folder)
    return [event.model_dump(exclude={"time", "seconds", "number"}) for event in events]


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_ends_cleanly_and_can_be_resumed(how: signal.Signals, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tpvqa"]
    # Failing on and on, so that there is time to interrupt it.
    trial = ["run", "eat_apple", *SYMBOLIC, "--failure", "1"]
    trial += ["--max-repeats", "1000", "--max-actions", "120"]
    mark = uuid4().hex
    process = subprocess.Popen(
        [*command, *trial, "--out", "here"],
        cwd=tmp_path,
        env={**os.environ, "TPVQA_TEST_MARK": mark},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    log = tmp_path / "here" / "episode.jsonl"
    while not (log.exists() and log.stat().st_size > 20_000):
        assert process.poll() is None
        time.sleep(0.01)
    assert len(marked(mark)) > 1  # the planner's process has a session of its own
    os.killpg(process.pid, how)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "Traceback" not in out + err
    assert "tpvqa resume here" in out
    assert eventually(lambda: marked(mark) == [], 20)
    last = read_episode(tmp_path / "here")[-1]
    assert isinstance(last, Ended)
    assert last.because == "cancelled"
    resumed = subprocess.run([*command, "resume", "here"], cwd=tmp_path, capture_output=True)
    whole = subprocess.run([*command, *trial, "--out", "whole"], cwd=tmp_path, capture_output=True)
    assert resumed.returncode == whole.returncode == 1
    assert story(tmp_path / "here") == story(tmp_path / "whole")


@pytest.mark.parametrize("out", ["plain", "plain/below"])
def test_where_no_folder_can_be_nothing_is_said_to_be_whole(tpvqa: Run, out: str) -> None:
    Path("plain").touch()
    code, _, err = tpvqa("run", "eat_apple", *SYMBOLIC, "--out", out)
    assert code == 6
    assert f"error: {out}: cannot be written (plain is no folder)" in err
    assert "name another folder with --out" in err
    assert "whole" not in err


def test_a_goal_that_is_only_believed_is_not_told_as_reached(tpvqa: Run) -> None:
    trial = ["run", "serve_breakfast", *SYMBOLIC, "--monitor", "none", "--failure", "0.9"]
    code, out, _ = tpvqa(*trial, "--json", "--out", "here")
    told = json.loads(out)
    assert (code, told["completed"]) == (1, False)
    assert told["ended_because"] == "believed done and was not"


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--vlm", "openai:some"], "needs a key"),
        (["--vlm", "openai:some", "--base-url", "http://localhost:9/v1"], "cannot be reached"),
        (["--pictures", "not/there"], "cannot be read"),
    ],
)
def test_what_is_missing_is_found_before_anything_moves(
    tpvqa: Run, monkeypatch: pytest.MonkeyPatch, options: list[str], says: str
) -> None:
    for name in ("OPENAI_API_KEY", "OPENAI_BASE_URL"):
        monkeypatch.delenv(name, raising=False)
    code, out, err = tpvqa("run", "eat_apple", *options, "--out", "here")
    assert (code, out) == (2, "")
    assert says in err
    assert not Path("here").exists()


def test_a_monitor_that_asks_nothing_needs_no_vlm(
    tpvqa: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    code, out, _ = tpvqa("run", "eat_apple", "--monitor", "tp", "--vlm", "openai:some", "--json")
    assert code in (0, 1)
    assert json.loads(out)["questions"] == 0


def test_the_papers_wording_goes_through_the_log_and_is_resumed(tpvqa: Run) -> None:
    words = ("--monitor", "palmevqa", "--wording", "paper", "--out", "here")
    code, _, _ = tpvqa("run", "clean_dishes", *SYMBOLIC, *words)
    log = Path("here/episode.jsonl")
    whole = log.read_text()
    assert code in (0, 1)
    assert '"text":"Was wash plate successful?"' in whole.replace(" :", ":").replace(": ", ":")
    lines = whole.splitlines(keepends=True)
    log.write_text("".join(lines[:12]))
    assert tpvqa("resume", "here")[0] == code
    texts = [re.findall(r'"text": ?"([^"]+)"', each) for each in (whole, log.read_text())]
    assert texts[0] == texts[1]
