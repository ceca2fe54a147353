"""Commands of other packages, and what is said where they are broken or not installed."""

import pytest

from tests.cli.conftest import Run
from tests.conftest import Install

SOURCE = '''
import typer

def register(app):
    @app.command()
    def wave(hand: str) -> None:
        """Wave a hand."""
        print(f"waving the {hand}")

def more(app):
    group = typer.Typer()

    @group.command()
    def mine() -> None:
        """A bench of my own."""
        print("measured")

    app.add_typer(group, name="bench")

def taken(app):
    @app.command()
    def plan() -> None:
        """Not the planner's."""

def breaks(app):
    raise RuntimeError("no arm")
'''
GROUP = "tpvqa.commands"


def test_a_command_of_another_package_is_listed_and_run(install: Install, tpvqa: Run) -> None:
    install("robot", SOURCE, "wave = robot:register", group=GROUP)
    code, out, err = tpvqa("--help")
    assert (code, err) == (0, "")
    assert "Wave a hand." in out
    assert "dataset" in out
    assert tpvqa("wave", "left")[:2] == (0, "waving the left\n")


def test_a_group_gets_commands_of_several_packages(install: Install, tpvqa: Run) -> None:
    install("robot", SOURCE, "my-bench = robot:more", group=GROUP)
    assert tpvqa("bench", "mine")[:2] == (0, "measured\n")
    out = tpvqa("bench", "--help")[1]
    assert all(name in out for name in ("run", "paper", "belief", "mine"))


@pytest.mark.parametrize(
    ("point", "says"),
    [
        ("arm = robot:breaks", "no arm"),
        ("arm = robot:missing", "missing"),
        ("arm = not_there:register", "not_there"),
        ("arm = robot:taken", "hold plan, of which there is one already"),
    ],
)
def test_a_broken_package_leaves_the_other_commands(
    install: Install, tpvqa: Run, point: str, says: str
) -> None:
    install("robot", SOURCE, point, group=GROUP)
    code, out, err = tpvqa("--help")
    assert code == 0
    assert "dataset" in out
    assert says in err
    code, _, err = tpvqa("arm")
    assert code == 2
    assert says in err
    code, _, err = tpvqa("wave", "left")
    assert (code, says in err, "No such command 'wave'" in err) == (2, True, True)
    assert tpvqa("tasks")[2] == ""
    assert "cost 4" in tpvqa("plan", "clean_dishes")[1]


@pytest.mark.parametrize(
    ("command", "where"), [("dataset", "household"), ("bench paper", "experiments")]
)
def test_a_command_that_is_not_installed_says_where_it_is(
    monkeypatch: pytest.MonkeyPatch, tpvqa: Run, command: str, where: str
) -> None:
    monkeypatch.setattr("tpvqa.cli.plugged.names", lambda kind: [])
    code, _, err = tpvqa(*command.split(), "--help")
    assert code == 2
    assert f"{command} comes with tpvqa-{where}. Install it: " in err
