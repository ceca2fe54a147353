"""One configuration: from Python, a file or the command line, it is the same."""

import inspect
import re
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from tests.cli.conftest import Run
from tpvqa import TrialConfig
from tpvqa.cli import run as commands
from tpvqa.cli.options import trial_config
from tpvqa.config import Limits, MonitorConfig, SimulationConfig
from tpvqa.config.layers import Layer, as_yaml, combined, file_layer, settings
from tpvqa.errors import ConfigError
from tpvqa.plugins import Kind, names

CONFIGS = st.builds(
    lambda task, vlm, monitor, limits, simulation, seed: TrialConfig(
        task=task, vlm=vlm, monitor=monitor, limits=limits, simulation=simulation, seed=seed
    ),
    st.sampled_from(["eat_apple", "build_tower"]),
    st.sampled_from(["oracle", "oracle:0.8:0.5"]),
    st.sampled_from(["belief:question=0.05", "tpvqa", MonitorConfig(majority="strict")]),
    st.builds(
        Limits,
        repeats=st.integers(0, 99),
        actions=st.none() | st.integers(1, 999),
        seconds=st.none() | st.floats(0.5, 1e6),
    ),
    st.builds(SimulationConfig, failure=st.floats(0, 1), spontaneous=st.floats(0, 1)),
    st.integers(0, 2**63 - 1),
)


@given(CONFIGS)
def test_what_is_printed_is_what_is_read(config: TrialConfig) -> None:
    text = as_yaml(config, [])
    assert TrialConfig.model_validate(yaml.safe_load(text)) == config
    assert TrialConfig.model_validate_json(config.model_dump_json(by_alias=True)) == config


@given(CONFIGS)
def test_changing_nothing_changes_nothing(config: TrialConfig) -> None:
    assert config.but() == config
    assert config.but(seed=3).but(seed=config.seed) == config


def test_every_setting_has_an_option_and_every_option_a_setting() -> None:
    offered = set(inspect.signature(commands.run).parameters)
    wanted = {
        each.option.lstrip("-").replace("-", "_") for each in settings() if each.option[0] == "-"
    }
    own = {"task", "problem_file", "optimal", "out", "as_json", "config_file", "verbose"}
    assert offered == wanted | own
    assert all(each.says for each in settings())
    assert len({each.option for each in settings()}) == len(list(settings()))


def test_the_librarys_defaults_are_the_commands(tpvqa: Run) -> None:
    code, out, _ = tpvqa("config", "eat_apple", "--json")
    assert code == 0
    assert TrialConfig.model_validate_json(out) == TrialConfig(task="eat_apple")
    assert TrialConfig().monitor.named == "belief"


def test_each_setting_says_where_it_came_from(tpvqa: Run, tmp_path: Path) -> None:
    file = tmp_path / "trial.yaml"
    file.write_text("task: eat_apple\nmonitor: tpvqa\nlimits:\n  actions: 40\n  repeats: 3\n")
    code, out, err = tpvqa("config", "--config", file, "--max-repeats", 5, "--seed", 7)
    assert code == 0, err
    said = dict(line.strip().split(": ", 1) for line in out.splitlines() if ": " in line)
    assert said["actions"] == f"40  # {file}:4"
    assert said["repeats"] == "5  # --max-repeats"
    assert said["seed"] == "7  # --seed"
    assert said["failure"] == "0.25  # default"
    again = tmp_path / "again.yaml"
    again.write_text(out)
    assert combined([file_layer(again)]) == combined(
        [file_layer(file), Layer({("limits", "repeats"): 5, ("seed",): 7})]
    )


def test_a_file_is_run(tpvqa: Run, tmp_path: Path) -> None:
    file = tmp_path / "trial.yaml"
    file.write_text("task: build_tower\nworld: symbolic\nvlm: oracle\nmonitor: tp\nseed: 3\n")
    code, out, err = tpvqa("run", "--config", file, "--json", "--out", "e", "--failure", 0)
    assert code == 0, err
    assert '"monitor": "tp"' in out


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("limits:\n  action: 4\n", r"trial\.yaml:2: limits: 'action' is not known here.*actions"),
        ("mointor: tpvqa\n", r"trial\.yaml:1: 'mointor'.*Did you mean 'monitor'"),
        (
            "simulation:\n  failure: 2\n",
            r"trial\.yaml:2: simulation\.failure: must be at most 1, got 2",
        ),
        ("seed: many\n", r"trial\.yaml:1: seed: "),
        ("schema: 9\n", r"trial\.yaml:1: schema: "),
        ("limits:\n  replans: true\n", r"trial\.yaml:2: limits\.replans: .*auto or none, not true"),
        ("limits: [1]\n", r"trial\.yaml:1: limits: expected 'name: value' entries"),
        ("seed: 1\nseed: 2\n", r"trial\.yaml:2: .*given twice"),
        (": :\n", r"trial\.yaml"),
        ("options: [1, 2]\n", r"trial\.yaml:1: options"),
        ("options: 3\n", r"trial\.yaml:1: options"),
        ("options: {1: 2}\n", r"trial\.yaml:1: options"),
        ("seed: 2024-99-99\n", r"trial\.yaml:1: seed: cannot be read"),
        ("seed: !!int foo\n", r"trial\.yaml:1: the tag .*is not read here"),
        ("task:\n  name: a\n  domain: b\n", r"trial\.yaml:2: task: .*either a shipped task"),
    ],
)
def test_what_is_wrong_in_a_file_is_said_with_its_line(
    text: str, says: str, tmp_path: Path
) -> None:
    file = tmp_path / "trial.yaml"
    file.write_text(text)
    with pytest.raises(ConfigError, match=says):
        trial_config([file_layer(file)])


def test_paths_in_a_file_are_relative_to_it(tmp_path: Path) -> None:
    file = tmp_path / "trial.yaml"
    file.write_text("task:\n  domain: d.pddl\n  problem: p.pddl\n")
    assert trial_config([file_layer(file)]).task.domain == str(tmp_path / "d.pddl")


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--action-deadline", 0), "--action-deadline must be more than 0, got 0"),
        (("--max-actions", "xx"), "--max-actions does not fit: write a whole number, or 50x for"),
        (("--max-replans", "xx"), "--max-replans does not fit: write a whole number, auto or none"),
        (("--max-replans", -1), "--max-replans must be at least 0, got -1"),
        (("--max-actions", 0), "--max-actions must be at least 1, got 0"),
        (("--max-repeats", "xx"), "--max-repeats does not fit: write a whole number, or none"),
        (("--monitor", ""), "--monitor must not be empty\n"),
        (("--max-seconds", "nan"), "--max-seconds must be a number, got nan"),
    ],
)
def test_what_an_option_takes_is_said(tpvqa: Run, words: tuple[object, ...], says: str) -> None:
    code, _, err = tpvqa("config", "eat_apple", *words)
    assert code == 2
    assert says in err


def test_what_cannot_be_is_refused(tpvqa: Run) -> None:
    code, _, err = tpvqa("run", "eat_apple", "--failure", 2)
    assert code == 2
    assert "--failure must be at most 1, got 2\n" in err
    code, _, err = tpvqa("run", "eat_apple", "--failure", 1.0000001)
    assert (code, err) == (2, "error: --failure must be at most 1, got 1.0000001\n")
    with pytest.raises(ValidationError):
        TrialConfig(limits=Limits(repeats=-1))
    with pytest.raises(ValidationError):
        TrialConfig.model_validate({"limit": {}})


def test_a_printed_configuration_can_be_changed_to_a_majority(tpvqa: Run, tmp_path: Path) -> None:
    file = tmp_path / "trial.yaml"
    file.write_text(tpvqa("config", "build_tower")[1])
    code, out, _ = tpvqa("config", "--config", file, "--majority", "strict", "--json")
    assert code == 0
    assert TrialConfig.model_validate_json(out).monitor.named == "tpvqa"
    assert TrialConfig().but(monitor={"majority": "strict"}).monitor.named == "tpvqa"


def test_a_robots_configuration_is_printed_and_read(tmp_path: Path) -> None:
    config = TrialConfig(task="eat_apple", simulation=None)
    file = tmp_path / "trial.yaml"
    file.write_text(as_yaml(config, []))
    assert combined([file_layer(file)]) == config


@pytest.mark.parametrize("name", ["seed", "truth", "arguments", "task"])
def test_an_option_does_not_say_what_plug_ins_are_given(tpvqa: Run, name: str) -> None:
    words = ("--world", "symbolic", "--vlm", "oracle", "--option", f"{name}=1")
    code, _, err = tpvqa("run", "build_tower", *words)
    assert code == 2
    assert f"--option {name}" in err


def test_help_names_every_monitor_that_is_installed(tpvqa: Run) -> None:
    code, out, _ = tpvqa("run", "--help")
    assert code == 0
    said = set(re.findall(r"[\w-]+", out))
    assert set(names(Kind.MONITOR)) <= said
    assert "survey" in said


TOYS = Path(__file__).parents[1] / "fixtures" / "toys"


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "there is no such"),
        (b"", "empty"),
        (b"\x00\x01\xff", "domain.pddl"),
        (b"(define (domain toys)\n (:predicates (p", "domain.pddl"),
        (b"task: eat_apple\n", "domain.pddl"),
    ],
)
def test_files_are_refused_as_run_refuses_them(
    tpvqa: Run, tmp_path: Path, content: bytes | None, says: str
) -> None:
    if content is not None:
        (tmp_path / "domain.pddl").write_bytes(content)
    words = ("--domain", "domain.pddl", "--problem", TOYS / "collect.pddl")
    code, out, err = tpvqa("config", *words)
    assert (code, out) == (2, "")
    assert says in err
    assert tpvqa("run", *words)[::2] == (2, err)


@pytest.mark.parametrize("option", ["--questions", "--world-file", "--priors", "--true-start"])
def test_other_files_are_read_too(tpvqa: Run, option: str) -> None:
    code, _, err = tpvqa("config", "eat_apple", option, "none.yaml")
    assert code == 2
    assert "none.yaml" in err
