"""Plug-ins by name: a package made and found as pip would leave it, without installing it."""

import shutil
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import Install
from tpvqa import Trial, TrialConfig
from tpvqa.belief.calibrating.shipped import shipped_calibration
from tpvqa.defaults import default_vlm
from tpvqa.errors import MissingExtraError, PluginError, UnknownNameError
from tpvqa.monitors.making import make_monitor
from tpvqa.planning.making import make_planner
from tpvqa.plugins import Kind, load, make, names
from tpvqa.tasks import find_task, shipped_tasks
from tpvqa.vlm.making import make_vlm
from tpvqa.vlm.oracle import Oracle
from tpvqa.worlds.making import make_world

TOYS = Path(__file__).parent / "fixtures" / "toys"

COLOURS = '''
from tpvqa.vlm.capabilities import NoiseModel
from tpvqa.worlds.capabilities import Simulated

class ColourVLM:
    """Says yes to questions about its colour."""

    def __init__(self, colour, seed):
        self.name, self.colour, self.seed = "colour", colour, seed

    @classmethod
    def from_spec(cls, arguments, *, seed=0):
        return cls(arguments or "red", seed)

class Everything:
    """Has what worlds, VLMs and monitors have."""

    name = "everything"

    def views(self):
        return ("front",)

    def observe(self, view=None): ...

    def execute(self, action, *, deadline=None, cancel=None): ...

    def close(self): ...

    def ask(self, observation, questions): ...

    def before(self, step): ...

    def after(self, step): ...

class Curious(Everything):
    """Names the truth, without being a noise model."""

    def __init__(self, truth=None, simulation=None, **rest):
        self.truth, self.simulation, self.rest = truth, simulation, rest

class Noise(Curious, NoiseModel):
    """Declares that it is one."""

class Simulation(Curious, Simulated):
    """Declares that it is simulated."""

class Demanding:
    def __init__(self, camera):
        self.camera = camera

nothing = 3
'''


def test_a_plug_in_of_another_package_is_found_and_made(install: Install) -> None:
    install("colours", COLOURS, "colour = colours:ColourVLM")
    assert {"colour", "oracle", "openai", "embedded"} <= set(names(Kind.VLM))
    assert "colours" not in sys.modules
    vlm = make(Kind.VLM, "colour:light: blue", seed=4, base_url="unused")
    assert (vlm.colour, vlm.seed) == ("light: blue", 4)
    assert make(Kind.VLM, " colour ").colour == "red"


def test_a_misspelt_name_gets_a_suggestion() -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'oracle'"):
        make(Kind.VLM, "orcale:0.8")
    with pytest.raises(UnknownNameError, match="no monitor 'zzz'"):
        make(Kind.MONITOR, "zzz")


def test_the_truth_is_withheld_from_all_that_do_not_declare_what_they_are(
    install: Install,
) -> None:
    install("colours", COLOURS, "curious = colours:Curious", "noise = colours:Noise")
    install("more", COLOURS, "curious = more:Curious", group="tpvqa.monitors")
    points = ("curious = worlds:Curious", "simulated = worlds:Simulation")
    install("worlds", COLOURS, *points, group="tpvqa.worlds")
    context = {"truth": "the truth", "simulation": "too", "seed": 1}
    curious: list[Any] = [
        make_vlm("curious", context)[0],
        make(Kind.MONITOR, "curious", **context),
        make_world("curious", context)[0],
    ]
    for plugin in curious:
        assert (plugin.truth, plugin.simulation, plugin.rest) == (None, None, {"seed": 1})
    simulated: Any = make_world("simulated", context)[0]
    assert (simulated.truth, simulated.simulation) == (None, "too")
    noise: Any = make_vlm("noise", context)[0]
    assert noise.truth == "the truth"
    with pytest.raises(PluginError, match="noise model"):
        make_vlm("noise", {"seed": 1})


def test_arguments_that_a_plug_in_does_not_take_are_an_error(install: Install) -> None:
    install("colours", COLOURS, "curious = colours:Curious", "demanding = colours:Demanding")
    with pytest.raises(PluginError, match="takes no arguments") as raised:
        make(Kind.VLM, "curious:very")
    assert "give Curious a class method from_spec(arguments, …)" in str(raised.value).replace(
        "colours.", ""
    )
    with pytest.raises(PluginError, match="camera"):
        make(Kind.VLM, "demanding", seed=1)
    assert make(Kind.VLM, "demanding", camera="front").camera == "front"


@pytest.mark.parametrize(
    ("source", "point", "says"),
    [
        (COLOURS, "broken = colours:Missing", "Missing"),
        (COLOURS, "broken = colours:nothing", "neither a class nor a function"),
        ("import not_there_at_all", "broken = colours:X", "not_there_at_all"),
        ("raise RuntimeError('no camera')", "broken = colours:X", "no camera"),
        ("def", "broken = colours:X", "colours"),
    ],
)
def test_a_broken_plug_in_is_a_clear_error(
    install: Install, source: str, point: str, says: str
) -> None:
    install("colours", source, point)
    with pytest.raises(PluginError, match=says) as caught:
        load(Kind.VLM, "broken")
    assert "colours" in str(caught.value)


@pytest.mark.parametrize(
    ("module", "extras", "says"),
    [
        ("scipy", {}, r"pip install -e 'packages/tpvqa\[bench\]'"),
        ("scipy", {"fast": "scipy>=1"}, r"pip install 'colours\[fast\]'"),
        ("lidar", {"laser": "lidar", "all": "radar"}, r"pip install 'colours\[laser\]'"),
    ],
)
def test_a_missing_package_of_an_extra_names_the_extra(
    install: Install,
    monkeypatch: pytest.MonkeyPatch,
    module: str,
    extras: dict[str, str],
    says: str,
) -> None:
    install("colours", f"import {module}", "needy = colours:X", extras=extras)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match=says):
        load(Kind.VLM, "needy")


def test_a_name_that_two_packages_offer_is_an_error(install: Install) -> None:
    install("colours", COLOURS, "colour = colours:ColourVLM")
    install("paints", COLOURS, "colour = paints:ColourVLM")
    with pytest.raises(PluginError, match="colours and paints"):
        make(Kind.VLM, "colour")


def test_the_shipped_oracle_is_a_noise_model() -> None:
    assert load(Kind.VLM, "oracle") is Oracle


TASKS = """
from pathlib import Path
from tpvqa.tasks import tasks_in

def task_files():
    return tasks_in(Path(__file__).parent / "box", default_world="scripted")

def broken():
    raise RuntimeError("no such shelf")

def odd():
    return ["box"]
"""


def test_a_family_of_tasks_of_another_package_is_among_the_shipped(
    install: Install, tmp_path: Path
) -> None:
    install("box", TASKS, "box = box:task_files", group="tpvqa.tasks")
    shutil.copytree(TOYS, tmp_path / "box")
    files = find_task("collect")
    assert files.questions == tmp_path / "box" / "questions.yaml"
    assert {"collect", "build_tower"} <= {each.name for each in shipped_tasks()}
    with Trial(TrialConfig(task="collect", vlm="oracle")) as trial:
        assert trial.started().world == "scripted"


def test_a_broken_family_leaves_the_others_and_is_named(
    install: Install, caplog: pytest.LogCaptureFixture
) -> None:
    install("box", TASKS, "box = box:broken", "odd = box:odd", group="tpvqa.tasks")
    assert find_task("build_tower").name == "build_tower"
    assert "build_tower" in {each.name for each in shipped_tasks()}
    assert "'box' broke" in caplog.text
    assert "'odd' has to give TaskFiles" in caplog.text
    with pytest.raises(PluginError, match="no such shelf"):
        find_task("collect")


def test_a_task_that_two_packages_bring_is_an_error(install: Install, tmp_path: Path) -> None:
    install("box", TASKS, "box = box:task_files", group="tpvqa.tasks")
    shutil.copytree(TOYS, tmp_path / "box")
    (tmp_path / "box" / "collect.pddl").rename(tmp_path / "box" / "build_tower.pddl")
    with pytest.raises(PluginError, match="several tasks 'build_tower'"):
        find_task("build_tower")


CALIBRATIONS = """
from tpvqa.belief import Calibration

def colour():
    return Calibration.default("colour:red")

def odd():
    return {}
"""


def test_a_calibration_of_another_package_is_found_by_the_vlm(install: Install) -> None:
    points = ("colour:red = worth:colour", "odd = worth:odd")
    install("worth", CALIBRATIONS, *points, group="tpvqa.calibrations")
    found = shipped_calibration("colour:red")
    assert found is not None
    assert found.vlm == "colour:red"
    assert shipped_calibration("colour") is None
    with pytest.raises(PluginError, match="has to be a Calibration"):
        shipped_calibration("odd")


def test_what_other_distributions_bring_is_named_where_it_is_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("tpvqa.plugins._points", lambda path: dict.fromkeys(Kind, ()))
    household = r"comes with tpvqa-household\. Install it: .* -e packages/tpvqa-household"
    for kind, name in ((Kind.VLM, "embedded"), (Kind.WORLD, "images"), (Kind.WORLD, "kitchen")):
        with pytest.raises(UnknownNameError, match=household):
            load(kind, name)
    with pytest.raises(UnknownNameError, match=household):
        find_task("eat_apple")
    with pytest.raises(UnknownNameError, match=r"pip install -e experiments"):
        load(Kind.VLM, "paper-table")
    with pytest.raises(PluginError, match=r"--vlm openai:MODEL, or install .*tpvqa-household"):
        default_vlm()
    assert default_vlm(pictures=False) == "oracle"


def test_a_plug_in_for_another_protocol_is_refused(install: Install) -> None:
    source = "class Old:\n    tpvqa_protocol = 1\nclass New:\n    tpvqa_protocol = 2\n"
    install("eyes", source, "old = eyes:Old", "new = eyes:New")
    with pytest.raises(PluginError, match=r"'old' of eyes is written for protocol 1 .*protocol 2"):
        load(Kind.VLM, "old")
    assert load(Kind.VLM, "new").__name__ == "New"


def forms(old: str, new: str) -> str:
    assert old in COLOURS
    return COLOURS.replace(old, new)


@pytest.mark.parametrize(
    ("group", "source", "says"),
    [
        (
            "worlds",
            forms("def execute", "def exceute"),
            r"world 'broken' \(colours.Curious\) has no execute\(action, \*, deadline=None, "
            r"cancel=None\). Did you mean it by 'exceute'\?. A world has views, observe, execute",
        ),
        ("worlds", forms("observe(self, view=None)", "observe(self)"), "observe.*view=None"),
        ("worlds", forms("observe(self, view=None)", "observe(self, view)"), "observe.*missing"),
        ("worlds", forms(", cancel=None)", ")"), "execute.*'cancel'"),
        (
            "worlds",
            forms("def views(self)", "views = 3\n    def other(self)"),
            "'views' that is no",
        ),
        ("vlms", forms('name = "everything"', "name = 3"), "'name' that is 3; expected a text"),
        ("vlms", forms('name = "everything"', 'nam = ""'), "no 'name', a text. Did you mean"),
        (
            "vlms",
            forms('name = "everything"', "@property\n    def name(self): return 1 / 0"),
            "'name' that broke: ZeroDivisionError",
        ),
        ("vlms", forms("def ask", "async def ask"), "'ask' that is a coroutine"),
        ("monitors", forms("def after(self, step)", "def after(self)"), "after"),
        ("planners", forms("def ask", "def plan"), "plan"),
        ("worlds", forms("self.rest = truth", "self.rest = 1 / 0, truth"), "Curious.*ZeroDiv.*py:"),
        ("worlds", forms("self.truth, self", "raise SystemExit(0)\n        self"), "SystemExit"),
        ("worlds", "def Curious(): return None", "NoneType.* has no views"),
    ],
)
def test_a_plug_in_that_lacks_something_is_found_out_when_it_is_made(
    install: Install, group: str, source: str, says: str
) -> None:
    install("colours", source, "broken = colours:Curious", group=f"tpvqa.{group}")
    makers: dict[str, Any] = {
        "worlds": lambda: make_world("broken", {}),
        "vlms": lambda: make_vlm("broken", {}),
        "monitors": lambda: make_monitor("broken", {}),
        "planners": lambda: make_planner("broken"),
    }
    with pytest.raises(PluginError, match=says) as caught:
        makers[group]()
    assert "\n" not in str(caught.value)
