"""`tpvqa dataset compose` as a user gives it, against a real images server."""

import json
import os
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.household.images.sources.images_server import Act, ImagesServer, picture, refusal
from tpvqa.cli import main
from tpvqa.episodes import read_episode
from tpvqa.errors import MissingExtraError, PictureSetError, PluginError, UnknownNameError
from tpvqa.events.events import Observed
from tpvqa_household.cli.dataset import dataset
from tpvqa_household.images.manifest import load_pictures

FEW = ("--task", "clean_dishes", "--per-outcome", "5", "--no-fill")
REMOTE = 8 * 4  # of 5 pictures of each outcome, 3 are variations and 1 comes from a prompt


def arguments(out: Path, server: ImagesServer, *more: str) -> list[str]:
    asked = ("--variations", "openai:some", "--prompts", "openai:some", "--base-url", server.url)
    return ["compose", "--out", str(out), *FEW, *asked, *more]


def test_requests_and_cost_are_said_before_and_after(tmp_path: Path) -> None:
    runner = CliRunner()
    with ImagesServer() as server:
        ask = arguments(tmp_path, server, "--price", "0.05")
        dry = runner.invoke(dataset, [*ask, "--dry-run"])
        assert dry.exit_code == 0, dry.output
        assert f"{REMOTE} requests to openai:some (about $1.60)" in dry.output
        assert "0 photos 1 missing" in dry.output
        refused = runner.invoke(dataset, ask)
        assert isinstance(refused.exception, PictureSetError)
        assert "--yes" in str(refused.exception)
        assert server.requests == []
        assert list(tmp_path.iterdir()) == []
        done = runner.invoke(dataset, [*ask, "--yes"])
        assert done.exit_code == 0, done.output
        assert f"{REMOTE} requests were sent for {REMOTE} pictures" in done.output
        assert "cost $1.60" in done.output
        again = runner.invoke(dataset, [*ask, "--json"])
        assert again.exit_code == 0, "there is nothing left to ask for"
        said = json.loads(again.stdout)
        assert (said["pending"], said["requests"], said["requests_sent"]) == (0, [], 0)
        assert said["percent"] == {"rendered": 20.0, "variation": 60.0, "generated": 20.0}


@pytest.mark.parametrize("price", ["inf", "1e400", "nan", "-1"])
def test_a_price_that_no_file_can_hold_is_refused(tmp_path: Path, price: str) -> None:
    with ImagesServer() as server:
        ask = arguments(tmp_path, server, "--yes", "--price", price)
        refused = CliRunner().invoke(dataset, ask)
    assert (refused.exit_code, server.requests) == (2, [])
    assert "--price" in refused.output


def test_a_refused_picture_fails_the_command(tmp_path: Path) -> None:
    refused = refusal(400, "no knives", code="content_policy_violation")
    with ImagesServer(script=lambda n: refused if n == 0 else None) as server:
        result = CliRunner().invoke(dataset, arguments(tmp_path, server, "--yes"))
    assert result.exit_code == 1
    assert "no knives" in result.output
    assert "1 pictures were refused" in result.output


@pytest.mark.slow
def test_killed_at_any_moment_nothing_is_lost_or_asked_for_twice(tmp_path: Path) -> None:
    with ImagesServer(script=lambda n: Act(wait=0.05)) as server:
        command = [sys.executable, "-m", "tpvqa", "dataset", *arguments(tmp_path, server, "--yes")]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        kills = 0
        for enough in (3, 11, 20):
            running = subprocess.Popen(command, **quiet)  # type: ignore[call-overload]
            until = time.monotonic() + 120
            while len(server.requests) < enough and time.monotonic() < until:
                time.sleep(0.01)
            os.kill(running.pid, signal.SIGKILL)
            running.wait()
            kills += 1
            listed = load_pictures(tmp_path).manifest.pictures
            assert all((tmp_path / one.file).is_file() for one in listed)
        assert subprocess.run(command, **quiet, timeout=120).returncode == 0  # type: ignore[call-overload]
        # What was under way at a kill had no answer yet; nothing else is asked for again.
        assert REMOTE <= len(server.requests) <= REMOTE + kills
    assert len(load_pictures(tmp_path).manifest.pictures) == 8 * 5


def test_a_page_does_not_wait_for_who_reads_a_pipe(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    os.mkfifo(page)
    shown = CliRunner().invoke(dataset, ["show", str(page)])
    assert shown.exit_code == 1
    assert "is no page with pictures" in str(shown.exception)
    assert stat.S_ISFIFO(page.stat().st_mode)


def test_photos_of_other_tasks_do_not_matter(tmp_path: Path) -> None:
    for number, place in enumerate(("eat_apple/open_fridge", "wash_plate_sink")):
        folder = tmp_path / "photos" / place / "success"
        folder.mkdir(parents=True)
        (folder / "one.png").write_bytes(picture(number))
    asked = ["compose", "--out", str(tmp_path / "set"), *FEW, "--photos", str(tmp_path / "photos")]
    result = CliRunner().invoke(dataset, [*asked, "--variations", "none", "--json"])
    assert result.exit_code == 0, result.output
    said = json.loads(result.stdout)
    assert said["of_actions"] == {"rendered": 39, "photo": 1}
    page = tmp_path / "page.html"
    shown = CliRunner().invoke(dataset, ["show", str(page), "--pictures", str(tmp_path / "set")])
    assert shown.exit_code == 0, shown.output
    text = page.read_text()
    assert "1 photo, 4 rendered" in text
    assert '<span class="badge photo">photo</span>' in text
    assert "wash_plate_sink/success/one.png" in text


def test_a_composed_set_is_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "photos" / "wash_plate_sink" / "success"
    folder.mkdir(parents=True)
    for number in range(10):
        (folder / f"{number}.png").write_bytes(picture(number))
    asked = ["compose", "--out", str(tmp_path / "set"), "--photos", str(tmp_path / "photos")]
    asked += ["--task", "clean_dishes", "--shares", "100,0,0", "--variations", "none"]
    assert CliRunner().invoke(dataset, asked).exit_code == 0
    words = ["tpvqa", "run", "clean_dishes", "--pictures", str(tmp_path / "set"), "--failure", "0"]
    words += ["--monitor", "tpvqa", "--vlm", "oracle", "--out", str(tmp_path / "episode")]
    monkeypatch.setattr(sys, "argv", words)
    with suppress(SystemExit):
        main()
    looks = [event for event in read_episode(tmp_path / "episode") if isinstance(event, Observed)]
    assert "-photo-" in looks[-1].frames[0].source


@pytest.mark.parametrize(
    ("choice", "error", "said"),
    [
        (("--variations", "opnai:x"), UnknownNameError, "Did you mean 'openai'"),
        (("--variations", "openai"), PluginError, "openai:MODEL"),
        (("--variations", "rerender:x"), PluginError, "has no models"),
        (("--variations", "none", "--prompts", "rerender"), PluginError, "no pictures from"),
    ],
)
def test_a_generator_that_there_is_not(
    choice: tuple[str, ...], error: type[Exception], said: str, tmp_path: Path
) -> None:
    result = CliRunner().invoke(dataset, ["compose", "--out", str(tmp_path), *FEW, *choice])
    assert isinstance(result.exception, error)
    assert said in str(result.exception)


def test_diffusers_that_is_not_installed_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    find: Callable[[str], object] = lambda name: None  # noqa: E731
    monkeypatch.setattr("importlib.util.find_spec", find)
    asked = ["compose", "--out", str(tmp_path), *FEW, "--variations", "diffusers:tiny"]
    result = CliRunner().invoke(dataset, asked)
    assert isinstance(result.exception, MissingExtraError)
    assert "tpvqa-household[diffusion]" in str(result.exception)
