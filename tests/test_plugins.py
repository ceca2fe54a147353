"""Plug-ins by name: a package made and found as pip would leave it, without installing it."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tpvqa.errors import MissingExtraError, PluginError, UnknownNameError
from tpvqa.plugins import Kind, load, make, names
from tpvqa.vlm.making import make_vlm
from tpvqa.vlm.oracle import Oracle
from tpvqa.worlds.making import make_world

Install = Callable[..., None]

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

class Curious:
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


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Install:
    """Put a package with entry points where Python finds it."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def put(package: str, source: str, *points: str, group: str = "tpvqa.vlms") -> None:
        (tmp_path / f"{package}.py").write_text(source)
        metadata = tmp_path / f"{package}-1.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text(
            f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n"
        )
        (metadata / "entry_points.txt").write_text(f"[{group}]\n" + "\n".join(points) + "\n")
        monkeypatch.delitem(sys.modules, package, raising=False)

    return put


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
    with pytest.raises(PluginError, match="takes no arguments"):
        make(Kind.VLM, "curious:very")
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


def test_a_missing_package_of_an_extra_names_the_extra(
    install: Install, monkeypatch: pytest.MonkeyPatch
) -> None:
    install("colours", "import mujoco", "needy = colours:X")
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'tpvqa\[sim\]'"):
        load(Kind.VLM, "needy")


def test_a_name_that_two_packages_offer_is_an_error(install: Install) -> None:
    install("colours", COLOURS, "colour = colours:ColourVLM")
    install("paints", COLOURS, "colour = paints:ColourVLM")
    with pytest.raises(PluginError, match="colours and paints"):
        make(Kind.VLM, "colour")


def test_the_shipped_oracle_is_a_noise_model() -> None:
    assert load(Kind.VLM, "oracle") is Oracle
