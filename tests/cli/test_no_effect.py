"""A setting of a simulated world that changes nothing says so."""

from pathlib import Path

import pytest

from tests.cli.conftest import Run

LAMPS = Path(__file__).parents[1] / "fixtures/lamps"
FILES = ("--domain", LAMPS / "domain.pddl", "--problem", LAMPS / "both.pddl", "--monitor", "tp")
WORLD = """
undo:
  - fact: (wired ?x)
    outcomes: [{say: the wire breaks}]
  - fact: (lit ?x)
    outcomes: [{say: it goes out}]
"""


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--disturbance", 0.5, "--failure", 0), "--disturbance has no effect: only a failed"),
        (("--world", "scripted", "--redo", "risky"), "--redo has no effect: a script says"),
        (("--moved", 0.2), "--moved has no effect: nothing can be put elsewhere"),
        (
            ("--true-start", "start.txt"),
            "--true-start has no effect: the state is that of the problem",
        ),
        (("--spontaneous", 0.1, "--world-file", "none.yaml"), "says that nothing can be undone"),
        (("--spontaneous", 0.1, "--world-file", "wires.yaml"), "the plan achieves can be undone"),
    ],
)
def test_what_has_no_effect_is_told(tpvqa: Run, arguments: tuple[object, ...], said: str) -> None:
    Path("start.txt").write_text("")
    Path("none.yaml").write_text("undo: []\n")
    Path("wires.yaml").write_text(WORLD.split("  - fact: (lit")[0])
    _, _, err = tpvqa("run", *FILES, *arguments)
    assert said in err


def test_a_file_of_defaults_names_nothing(tpvqa: Run) -> None:
    _, printed, _ = tpvqa("config", "eat_apple")
    Path("trial.yaml").write_text(printed)
    _, _, err = tpvqa("run", "--config", "trial.yaml", "--monitor", "tp", "--world", "symbolic")
    assert "true_start" in printed
    assert "--true-start" not in err


def test_what_has_an_effect_is_not_told(tpvqa: Run) -> None:
    Path("world.yaml").write_text(WORLD)
    for arguments in (
        ("--disturbance", 0.5, "--spontaneous", 0.1, "--redo", "risky"),
        ("--disturbance", 0, "--failure", 0),
        ("--disturbance", 0.5, "--world-file", "world.yaml"),
        ("--world", "scripted", "--dead", "switch_on left"),
    ):
        _, _, err = tpvqa("run", *FILES, *arguments)
        assert "no effect" not in err


def test_a_rule_of_a_world_file_that_speaks_of_nothing_is_told(tpvqa: Run) -> None:
    text = (LAMPS / "domain.pddl").read_text().replace("(bright)", "(bright) (odd ?x - lamp)", 1)
    Path("domain.pddl").write_text(text)
    Path("world.yaml").write_text("""
undo: [{fact: (odd left), outcomes: [{say: it is even}]}]
rebind:
  - action: switch_on
    argument: ?x
    to: (odd ?x)
""")
    _, _, err = tpvqa("run", "domain.pddl", LAMPS / "both.pddl", "--monitor", "tp")
    assert "(odd left) can never be true here, so it is never undone" in err
    assert "(odd ?x) can never be true here, so ?x of switch_on is as planned" in err
