"""`tpvqa label`, as a user types it, and its page."""

import json
import os
import pty
import shutil
import signal
import socket
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import StringIO
from pathlib import Path
from threading import Thread
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest

from tests.cli.conftest import Run
from tests.doubles import configured
from tests.labelling.robot import record
from tests.lamps import DOMAIN, PROBLEM, QUESTIONS, make_set
from tpvqa.assembly import Trial
from tpvqa.belief import Calibration
from tpvqa.cli.label_page import LabelPage
from tpvqa.episodes import EpisodeWriter
from tpvqa.episodes.log import LOG
from tpvqa.errors import TpvqaError, WriteError
from tpvqa.labelling import LABELS, Session
from tpvqa.vlm import Reply

Typed = Callable[[str], None]


@pytest.fixture(scope="module")
def ward(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes of a robot."""
    folder = tmp_path_factory.mktemp("ward")
    record(folder, 2)
    return folder


@pytest.fixture
def folders(ward: Path, tpvqa: Run) -> list[str]:
    """The same without labels, from where the command runs."""
    for each in ward.iterdir():
        (each / LABELS).unlink(missing_ok=True)
    Path("e").symlink_to(ward)
    return ["e/0", "e/1"]


@pytest.fixture
def typed(monkeypatch: pytest.MonkeyPatch) -> Typed:
    """Say what comes on standard input."""
    return lambda keys: monkeypatch.setattr(sys, "stdin", StringIO(keys))


def labels(folder: str) -> list[str]:
    path = Path(folder) / LABELS
    return [json.loads(line)["label"] for line in path.read_text().splitlines()]


def test_keys_label_and_what_was_labelled_comes_no_more(
    tpvqa: Run, folders: list[str], typed: Typed
) -> None:
    log = Path(folders[0], LOG).read_bytes()
    typed("y\nN\nc\nx\ns\nb\nq\n")
    code, out, err = tpvqa("label", folders[0])
    assert code == 0, err
    assert labels(folders[0]) == ["yes", "no", "cannot see"]
    assert "2 labels tell how often an answer is right to ±0.1" in out
    assert "not enough yet" in out
    assert "next: go on with tpvqa label e/0" in out
    assert "calibrate" not in out
    assert "x is no key" in err
    first = next(line for line in err.splitlines() if line.startswith("[1]"))
    typed("y\n")
    code, out, err = tpvqa("label", folders[0])
    assert code == 0
    assert "[3] " in err
    assert first[3:] + "\n" not in err
    assert "3 labels tell" in out
    assert Path(folders[0], LOG).read_bytes() == log


def test_two_sessions_do_not_overrule_each_other(
    tpvqa: Run, folders: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Meanwhile(StringIO):
        def readline(self, _size: int | None = -1, /) -> str:  # type: ignore[override]
            if not self.tell():
                with Session([folders[0]]) as other:
                    other.say("cannot see")
                    other.say("no")
            return super().readline()

    monkeypatch.setattr(sys, "stdin", Meanwhile("y\nq\n"))
    code, out, err = tpvqa("label", folders[0])
    assert code == 0
    assert labels(folders[0]) == ["cannot see", "no"]
    assert "note: 2 labels were given in e/0 by another session meanwhile, and count" in err
    assert "this question was labelled 'cannot see' there, and stays so" in err
    assert "1 labels tell" in out


def test_json_and_what_is_learnt(tpvqa: Run, folders: list[str], typed: Typed) -> None:
    typed("y\nn\nn\ns\nc\n")
    code, out, err = tpvqa("label", *folders, "--json")
    found = json.loads(out)
    assert code == 0
    assert (found["labels"], found["cannot_see"], found["skipped"]) == (3, 1, 1)
    assert found["answers"] >= 3
    assert found["vlm"] == "oracle:0.8"
    assert found["after_ten_more"] < found["standard_error"]
    assert not found["enough"]
    assert "look" in err
    code, out, err = tpvqa("calibrate", *folders, "--json")
    assert code == 0, err
    assert json.loads(out)["by_hand"] == 3
    assert Calibration.load(Path("calibration.json")).by_hand == 3


def test_labels_that_were_exchanged_are_told(tpvqa: Run, folders: list[str]) -> None:
    with Session(folders) as session:
        while (now := session.now) is not None:
            session.say("no" if now.of_vlm[0].reply is Reply.YES else "yes")
    code, out, err = tpvqa("calibrate", *folders)
    assert code == 0, err
    assert "note: yes was said more often where no was right" in out
    assert "yes and no were not exchanged" in Calibration.load(Path("calibration.json")).notices[-1]


def test_what_comes_next_is_calibrating_only_where_there_are_enough(
    tpvqa: Run, folders: list[str], typed: Typed
) -> None:
    typed("y\nn\n" * 300)
    code, out, _ = tpvqa("label", *folders)
    assert code == 0
    assert "; enough\nnext: tpvqa calibrate e/0 e/1\n" in out


def test_it_says_when_there_are_enough(tpvqa: Run, folders: list[str], typed: Typed) -> None:
    typed("y\nn\n" * 300)
    code, out, err = tpvqa("label", *folders, "--json")
    assert code == 0
    assert json.loads(out)["enough"]
    assert err.count("enough: ") == 1
    typed("")
    code, out, _ = tpvqa("label", *folders)
    assert code == 0
    assert "; enough" in out


def test_without_labels_calibrate_says_that_it_infers(tpvqa: Run, folders: list[str]) -> None:
    code, out, err = tpvqa("calibrate", *folders, "--out", "c.json")
    assert code == 0, err
    assert "nobody has labelled these answers" in out
    calibration = Calibration.load(Path("c.json"))
    assert calibration.inferred > calibration.rows > 0
    code, _, err = tpvqa("calibrate", *folders, "--experience", "known.json")
    assert code == 2
    assert "No episode says" in err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nowhere"], ["nowhere holds no episode"]),
        (["e/0", "--vlm", "embedded"], ["oracle:0.8 answered in it, not embedded"]),
        ([], ["Missing argument"]),
    ],
)
def test_bad_input_says_what_to_do(
    tpvqa: Run, folders: list[str], words: list[str], said: list[str]
) -> None:
    code, _, err = tpvqa("label", *words)
    assert code == 2
    for word in said:
        assert word in err


def test_an_episode_in_which_nothing_was_asked(tpvqa: Run) -> None:
    run = ["build_tower", "--monitor", "tp", "--vlm", "oracle", "--world", "symbolic"]
    tpvqa("run", *run, "--out", "quiet")
    code, _, err = tpvqa("label", "quiet")
    assert code == 2
    assert "Nothing was asked in quiet" in err


def test_that_there_are_no_pictures_is_said(
    tpvqa: Run, folders: list[str], seen: Path, typed: Typed
) -> None:
    for folder, bare in ((folders[0], True), (str(seen), False)):
        typed("q\n")
        _, _, err = tpvqa("label", folder)
        assert ("nothing here was recorded with a picture" in err) == bare


def test_a_picture_that_is_not_there_is_said(tpvqa: Run, seen: Path, typed: Typed) -> None:
    shutil.copytree(seen, "e")
    for missing in (False, True):
        if missing:
            shutil.rmtree("e/frames")
        typed("q\n")
        _, _, err = tpvqa("label", "e")
        assert "picture: " in err
        assert ("(is not there)" in err) == missing


def test_single_keys_in_a_terminal(
    tpvqa: Run, folders: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    keyboard, terminal = pty.openpty()
    with os.fdopen(terminal) as source:
        monkeypatch.setattr(sys, "stdin", source)

        def press() -> None:
            until = time.monotonic() + 20  # what is typed before it reads keys is no answer
            while termios.tcgetattr(keyboard)[3] & termios.ICANON and time.monotonic() < until:
                time.sleep(0.02)
            for key in "ynq":
                time.sleep(0.05)
                os.write(keyboard, key.encode())

        fingers = Thread(target=press)
        fingers.start()
        code, out, err = tpvqa("label", folders[0])
        fingers.join()
    os.close(keyboard)
    assert code == 0, err
    assert labels(folders[0]) == ["yes", "no"]
    assert "2 labels" in out


def test_an_interrupt_loses_nothing(folders: list[str]) -> None:
    command = [sys.executable, "-m", "tpvqa", "label", folders[0]]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True) as process:
        assert process.stdin is not None
        process.stdin.write("y\n")
        process.stdin.flush()
        path, until = Path(folders[0], LABELS), time.monotonic() + 20
        while time.monotonic() < until and not (path.exists() and path.read_text()):
            time.sleep(0.02)
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
    assert process.returncode == 130, err
    assert "interrupted" in err
    assert "1 labels tell" in out
    assert labels(folders[0]) == ["yes"]


@pytest.fixture(scope="module")
def seen(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An episode with pictures."""
    folder = tmp_path_factory.mktemp("lamps")
    pictures = make_set(folder / "set")
    config = configured(
        domain=str(DOMAIN),
        problem=str(PROBLEM),
        questions=str(QUESTIONS),
        world=f"pictures:{pictures}",
        vlm="oracle:0.9",
        monitor="tpvqa",
    )
    writer = EpisodeWriter(folder / "e", durable=False)
    with Trial(config) as trial:
        trial.run(writer)
    writer.close()
    return folder / "e"


@contextmanager
def served(session: Session) -> Iterator[tuple[LabelPage, list[Exception]]]:
    """A page that is served; what ended it, if that was an error."""
    ended: list[Exception] = []

    def serve(page: LabelPage) -> None:
        try:
            page.serve()
        except TpvqaError as error:
            ended.append(error)

    with LabelPage(session) as page:
        thread = Thread(target=serve, args=(page,))
        thread.start()
        try:
            yield page, ended
        finally:
            page.end()
            thread.join(10)
        assert not thread.is_alive()


def got(address: str, *, key: str | None = None, **headers: str) -> bytes:
    data = None if key is None else key.encode()
    with urlopen(Request(address, data, headers), timeout=10) as reply:
        found: bytes = reply.read()
    return found


def test_the_page_shows_pictures_and_takes_keys(seen: Path) -> None:
    with Session([seen]) as session, served(session) as (page, ended):
        assert b"<html" in got(page.address)
        state = json.loads(got(f"{page.address}state", Origin=f"http://{page.host}"))
        now = session.now
        assert now is not None
        assert (state["question"], state["pictures"]) == (now.text, len(now.pictures))
        assert got(f"{page.address}picture/0?1") == (seen / now.pictures[0]).read_bytes()
        after = json.loads(got(f"{page.address}key/{state['of']}", key="y"))
        assert after["labels"] == 1
        assert after["when"] != state["when"]
        assert not after["ended"]
        # A tab that still shows the question before labels nothing, and shows this one.
        for key in "ynsb":
            stale = json.loads(got(f"{page.address}key/{state['of']}", key=key))
            assert (stale["labels"], stale["of"]) == (1, after["of"])
        back = json.loads(got(f"{page.address}key/{after['of']}", key="b"))
        assert (back["question"], back["when"]) == (now.text, state["when"])
        assert back["label"] == "yes"
        assert json.loads(got(f"{page.address}key", key="q"))["ended"]
    assert not ended
    assert labels(str(seen)) == ["yes"]


@pytest.mark.parametrize(
    ("path", "headers", "key"),
    [
        ("/", {}, None),
        ("/guessed/state", {}, None),
        ("{token}state", {"Host": "somewhere.example"}, None),
        ("{token}key", {"Host": "somewhere.example"}, "y"),
        ("/key", {}, "y"),
        ("{token}picture/99", {}, None),
        ("{token}picture/-1", {}, None),
        ("{token}picture/../../episode.jsonl", {}, None),
        ("{token}key", {}, "y" * 5000),
        ("{token}picture/" + "9" * 5000, {}, None),
        ("{token}key", {"Content-Length": "9" * 5000}, "y"),
        ("{token}key", {"Origin": "http://somewhere.example"}, "y"),
        ("{token}key", {"Origin": "http://127.0.0.1:1"}, "y"),
        ("{token}key", {"Origin": "null"}, "y"),
        ("{token}state", {"Origin": "null"}, None),
    ],
)
def test_who_does_not_know_the_address_sees_nothing(
    seen: Path, path: str, headers: dict[str, str], key: str | None
) -> None:
    with Session([seen]) as session, served(session) as (page, _):
        before = session.progress.labels
        address = f"http://{page.host}{path.format(token=page.path)}"
        with pytest.raises(HTTPError) as refused:
            got(address, key=key, **headers)
        assert refused.value.code in (400, 404)
        assert session.progress.labels == before


def test_what_was_cut_off_is_no_label(seen: Path) -> None:
    with Session([seen]) as session, served(session) as (page, _):
        before, of = session.progress, page.state()["of"]
        host, _, port = page.host.partition(":")
        with socket.create_connection((host, int(port)), 10) as browser:
            head = f"POST {page.path}key/{of} HTTP/1.1\r\nHost: {page.host}\r\n"
            browser.sendall(f"{head}Content-Length: 10\r\n\r\ny".encode())
            browser.shutdown(socket.SHUT_WR)
            assert browser.recv(100).split()[1] == b"400"
        assert session.progress == before


@pytest.mark.parametrize("sent", [b"", b"GET ", b"GET / HTTP/1.1\r\nHo"])
def test_a_browser_that_goes_away_is_not_told_of(
    seen: Path, sent: bytes, capfd: pytest.CaptureFixture[str]
) -> None:
    with Session([seen]) as session, served(session) as (page, _):
        host, _, port = page.host.partition(":")
        with socket.create_connection((host, int(port)), 10) as browser:
            browser.sendall(sent)
            time.sleep(0.2)
            browser.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        time.sleep(0.3)
        assert b"<html" in got(page.address)
    said = capfd.readouterr()
    assert said.out + said.err == ""


def test_a_label_that_cannot_be_written_ends_the_page(
    seen: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_descriptor: int) -> None:
        raise OSError(28, os.strerror(28))

    with Session([seen]) as session, served(session) as (page, ended):
        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", full)
            shown = json.loads(got(f"{page.address}state"))["of"]
            state = json.loads(got(f"{page.address}key/{shown}", key="n"))
        assert state["ended"]
        assert "labels before are kept" in state["broken"]
        for _ in range(100):
            if ended:
                break
            time.sleep(0.05)
    assert isinstance(ended[0], WriteError)


def test_a_port_that_is_taken(seen: Path) -> None:
    with Session([seen]) as session, LabelPage(session) as page:
        port = int(page.host.rpartition(":")[2])
        with pytest.raises(TpvqaError, match=f"port {port}.*--port"):
            LabelPage(session, port=port)
