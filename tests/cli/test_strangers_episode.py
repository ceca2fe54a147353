"""What a stranger's episode can make `resume` do: nothing that its user did not say."""

import json
import shlex
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Run
from tests.conftest import Install
from tests.doubles import configured
from tpvqa.assembly import Trial
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.errors import EpisodeError, NotNamedError, TpvqaError
from tpvqa.events import Ended, Started
from tpvqa.plugins import Kind, is_plain
from tpvqa.resuming import config_of, resume, trial_of

Forge = Callable[..., Path]


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The first events of an episode that asks for nothing."""
    folder = tmp_path_factory.mktemp("episode")
    config = configured(task="build_tower", world="symbolic", vlm="oracle:0.9", monitor="tpvqa")
    with Trial(config) as trial:
        writer = EpisodeWriter(folder, durable=False)
        trial.run(writer)
        writer.close()
    return b"".join((folder / LOG).read_bytes().splitlines(keepends=True)[:9])


@pytest.fixture
def forged(log: bytes, tmp_path: Path) -> Forge:
    """An episode whose first event was changed: by dotted names of its settings."""

    def forge(**changes: Any) -> Path:
        folder = tmp_path / "theirs"
        folder.mkdir()
        first, rest = log.split(b"\n", 1)
        started = json.loads(first)
        for name, value in changes.items():
            holder, *keys = started, *name.split("__")
            for key in keys[:-1]:
                holder = holder[key]
            holder[keys[-1]] = value
        (folder / LOG).write_bytes(json.dumps(started).encode() + b"\n" + rest)
        return folder

    return forge


def test_ones_own_episode_asks_for_nothing(forged: Forge) -> None:
    assert resume(forged()).because == "goal"


def test_nobody_goes_on_with_another_vlm_than_the_log_tells(forged: Forge) -> None:
    folder = forged()
    before = (folder / LOG).read_bytes()
    with pytest.raises(EpisodeError, match=r"begun with oracle:0\.9, .* leave --vlm out"):
        resume(folder, named={"vlm": "oracle:0.5"})
    assert (folder / LOG).read_bytes() == before
    assert resume(folder, named={"vlm": "oracle:0.9"}).because == "goal"


def test_what_a_log_of_before_called_otherwise_is_no_other_vlm(forged: Forge) -> None:
    started = read_episode(forged(vlm="recorded:gpt-4.1-nano:1"))[0]
    assert isinstance(started, Started)
    for named in ("recorded:gpt-4.1-nano:1", "recorded:gpt-4.1-nano:1:fresh"):
        assert config_of(started, {"vlm": named}).vlm.spec == "recorded:gpt-4.1-nano:1:fresh"


def test_the_key_is_not_sent_where_the_log_says(
    forged: Forge, tpvqa: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "sk-secret")
    monkeypatch.delenv("OPENAI_BASE_URL", raising=False)
    with socket.create_server(("127.0.0.1", 0)) as theirs:
        theirs.setblocking(False)
        address = f"http://127.0.0.1:{theirs.getsockname()[1]}/v1"
        folder = forged(vlm="openai:x", world="images", config__vlm__base_url=address)
        before = (folder / LOG).read_bytes()
        code, out, err = tpvqa("resume", folder)
        assert (code, out) == (2, "")
        assert shlex.split(err.splitlines()[-1]) == [
            *("tpvqa", "resume", str(folder), "--base-url", address)
        ]
        with pytest.raises(BlockingIOError):
            theirs.accept()
    assert (folder / LOG).read_bytes() == before
    started = read_episode(folder)[0]
    assert isinstance(started, Started)
    monkeypatch.setenv("OPENAI_BASE_URL", "http://localhost:9/v1")
    assert config_of(started).vlm.base_url is None  # so that the user's own is taken


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"config__monitor__experience": "/etc/x"}, ["--experience", "/etc/x"]),
        ({"world": "scripted:/etc/passwd"}, ["--world", "scripted:/etc/passwd"]),
        ({"world": "pictures:/tmp/a b"}, ["--world", "pictures:/tmp/a b"]),
        ({"config__world__pictures": "/tmp"}, ["--pictures", "/tmp"]),
        ({"config__world__simulator": "a/b"}, ["--simulator", "a/b"]),
        ({"vlm": "embedded:/tmp/weights"}, ["--vlm", "embedded:/tmp/weights"]),
        ({"vlm": "recorded:/etc/x.csv:m"}, ["--vlm", "recorded:/etc/x.csv:m"]),
        ({"config__options": {"x": "$(id)"}}, ["--option", "x=$(id)"]),
        ({"config__options": {"x": ["a", 1]}}, ["--option", 'x=["a", 1]']),
        ({"config__options": {"n": 3221225985}}, ["--option", "n=3221225985"]),
        ({"config__monitor__spec": "successvqa:evil.example"}, None),
    ],
)
def test_what_only_the_user_may_name_is_asked_for(
    forged: Forge, tpvqa: Run, changes: dict[str, Any], words: list[str] | None
) -> None:
    folder = forged(**changes)
    before = (folder / LOG).read_bytes()
    code, out, err = tpvqa("resume", folder)
    assert (code, out) == (2, "")
    if words is not None:
        assert shlex.split(err.splitlines()[-1]) == ["tpvqa", "resume", str(folder), *words]
    assert (folder / LOG).read_bytes() == before
    started = read_episode(folder)[0]
    assert isinstance(started, Started)
    for start in (config_of, trial_of):
        with pytest.raises(NotNamedError):
            start(started)
    with pytest.raises(NotNamedError):
        resume(folder)


def test_files_that_the_log_names_are_not_opened(forged: Forge) -> None:
    zero = "/dev/zero"
    task = {"name": None, "domain": zero, "problem": zero, "questions": zero, "world_file": zero}
    files = dict.fromkeys(("domain_file", "problem_file", "questions_file", "world_file"), zero)
    folder = forged(config__task=task, config__monitor__calibration=zero, **files)
    assert resume(folder).because == "goal"


def test_what_is_named_is_used_and_the_trial_goes_on(forged: Forge, tmp_path: Path) -> None:
    script = tmp_path / "script.yaml"
    script.write_text("script: []\n")
    known = tmp_path / "known.json"
    folder = forged(
        world="scripted:/gone/script.yaml",
        config__monitor__experience="/gone/known.json",
        config__options={"n": 3},
    )
    named = {"world": f"scripted:{script}", "monitor": {"experience": str(known)}}
    started = read_episode(folder)[0]
    assert isinstance(started, Started)
    config = config_of(started, named)
    assert (config.world.spec, config.monitor.experience) == (f"scripted:{script}", str(known))
    assert (config.options, config.monitor.spec) == ({"n": 3}, "tpvqa")
    typed = config_of(started, {**named, "options": {"n": "3"}})
    assert typed.options == {"n": 3}


def test_another_plug_in_cannot_be_named(forged: Forge) -> None:
    started = read_episode(forged())[0]
    assert isinstance(started, Started)
    for named in ({"monitor": "none"}, {"limits": {"actions": 3}}, {"seed": {"x": 1}}):
        with pytest.raises(EpisodeError):
            config_of(started, named)


def test_plug_ins_of_others_get_numbers_from_a_log_or_declare_that_words_do_no_harm(
    install: Install,
) -> None:
    source = (
        "from tpvqa.plugins import PlainArguments\n"
        "class Arm:\n"
        "    @classmethod\n"
        "    def from_spec(cls, arguments): return cls()\n"
        "class Harmless(Arm, PlainArguments): ...\n"
    )
    install("arms", source, "arm = arms:Arm", "plain = arms:Harmless", group="tpvqa.worlds")
    assert [is_plain(Kind.WORLD, f"arm{rest}") for rest in ("", ":2", ":a=0.5,b=1")] == [True] * 3
    refused = (":router", ":10.0.0.1", ":/dev/ttyUSB0", ":16843009", ":os:system")
    assert [is_plain(Kind.WORLD, f"arm{rest}") for rest in refused] == [False] * len(refused)
    assert is_plain(Kind.WORLD, "plain:left")


@pytest.mark.parametrize(
    ("event", "change"),
    [
        ("observed", {"snapshot": {}}),
        ("observed", {"snapshot": {"look": "x", "simulation": {}}}),
        ("answered", {"snapshot": {"answers": [1]}}),
        ("started", {"domain": "(define (domain x)"}),
        ("started", {"questions": "predicates: [1]"}),
        ("started", {"calibration": {"x": 1}}),
        ("started", {"experience": {"failure": [1, 2]}}),
        ("plan made", {"plan": [{"name": "fly", "arguments": [], "said": "fly"}]}),
        ("decided", {"decision": "give up"}),
    ],
)
def test_what_cannot_be_gone_on_with_is_said(
    forged: Forge, event: str, change: dict[str, Any]
) -> None:
    folder = forged()
    lines = [json.loads(line) for line in (folder / LOG).read_bytes().splitlines()]
    last = max(at for at, line in enumerate(lines) if line["kind"] == event)
    lines = lines[: last + 1] if last else lines
    lines[last] |= change
    text = "".join(f"{json.dumps(line)}\n" for line in lines)
    (folder / LOG).write_text(text)
    with pytest.raises(TpvqaError):
        resume(folder)
    assert (folder / LOG).read_text() == text


def test_two_that_go_on_with_one_episode_do_not_both_write(forged: Forge) -> None:
    folder = forged()
    refused: list[str] = []

    def again(_: object) -> None:
        if not refused:
            with pytest.raises(EpisodeError) as error:
                resume(folder)
            refused.append(str(error.value))

    assert resume(folder, listeners=[again]).because == "goal"
    assert "still being written by another process" in refused[0]
    whole = (folder / LOG).read_bytes()
    with pytest.raises(EpisodeError, match="has ended"):
        resume(folder)
    assert (folder / LOG).read_bytes() == whole
    assert isinstance(read_episode(folder)[-1], Ended)
