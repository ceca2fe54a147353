"""The distributions: one version, and wheels that work as a user installs them."""

import json
import os
import re
import subprocess
import sys
import tomllib
import venv
import zipfile
from importlib.metadata import Distribution, PathDistribution, distribution
from pathlib import Path
from shutil import copy2
from typing import Any

import pytest
import typer
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from typer.core import TyperGroup

import tpvqa
from tests.lamps import make_set
from tpvqa.cli.app import app
from tpvqa.distributions import EXPERIMENTS, HOUSEHOLD, ROBOTS, brought, remedy
from tpvqa.plugins import Kind
from tpvqa_household import DISTRIBUTION
from tpvqa_household.tasks import task_files

ROOT = Path(__file__).parents[1]
TOYS = ROOT / "tests" / "fixtures" / "toys"
FOLDERS = {
    "tpvqa": ROOT / "packages" / "tpvqa",
    "tpvqa-household": ROOT / "packages" / "tpvqa-household",
    "tpvqa-robots": ROOT / "packages" / "tpvqa-robots",
    "tpvqa-experiments": ROOT / "experiments",
}
PUBLISHED = ("tpvqa", "tpvqa-household", "tpvqa-robots")
NEEDS = {"tpvqa": 0, "tpvqa-household": 1, "tpvqa-robots": 1, "tpvqa-experiments": 2}
"""How many of the others each needs."""
CORE_BYTES = 1_500_000
IMPORTS = 3.0
"""How many times the processor time of other libraries `from tpvqa import Trial` takes, each in
fresh processes, the best of five: seconds would measure the machine."""
BESIDE = "import pydantic.main, rich.console, typer"
NOT_YET = ("numpy", "PIL", "asyncio")
"""What an import of the core leaves for when it is needed."""
PICTURES_AND_MESHES = re.compile(r"\.(png|jpe?g|webp|obj|stl|msh|onnx|zip)$")


def project(name: str) -> dict[str, Any]:
    text = (FOLDERS[name] / "pyproject.toml").read_text(encoding="utf-8")
    found: dict[str, Any] = tomllib.loads(text)["project"]
    return found


def test_all_have_one_version_and_need_each_other_in_it() -> None:
    for name in FOLDERS:
        found = project(name)
        assert (found["name"], found["version"]) == (name, tpvqa.__version__)
        own = [need for need in found["dependencies"] if need.startswith("tpvqa")]
        assert all(need.endswith(f"=={tpvqa.__version__}") for need in own)
        assert len(own) == NEEDS[name]
    assert tuple(FOLDERS)[1:] == (HOUSEHOLD, ROBOTS, EXPERIMENTS)
    assert DISTRIBUTION == HOUSEHOLD


def test_each_ships_the_licence_of_the_repository() -> None:
    for name in PUBLISHED:
        folder = FOLDERS[name]
        assert (folder / "LICENSE").read_bytes() == (ROOT / "LICENSE").read_bytes()
        assert (folder / "NOTICE").read_text().startswith(f"{name}\n")


@pytest.mark.parametrize("name", [HOUSEHOLD, ROBOTS, EXPERIMENTS])
def test_all_that_a_distribution_plugs_in_is_named_where_it_is_missing(name: str) -> None:
    points = project(name)["entry-points"]
    for kind in (Kind.VLM, Kind.WORLD, Kind.MONITOR, Kind.TRAINER):
        assert set(points.get(kind.group, ())) == set(brought(name).get(kind.value, ()))
        assert all(remedy(kind.value, each) for each in points.get(kind.group, ()))
    assert remedy("world", "no-such") == ""


def test_so_are_its_commands_and_tasks() -> None:
    commands = typer.main.get_command(app)
    assert isinstance(commands, TyperGroup)
    context = typer.Context(commands)
    assert {*brought(HOUSEHOLD)["command"]} <= {*commands.list_commands(context)}
    bench = commands.get_command(context, "bench")
    assert isinstance(bench, TyperGroup)
    told = {f"bench {each}" for each in bench.commands}
    assert told == {*brought(EXPERIMENTS)["command"], "bench run"}
    assert {*brought(HOUSEHOLD)["task"]} == {each.name for each in task_files()}


@pytest.fixture(scope="module")
def wheels(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("wheels")
    words = ("wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", str(folder))
    pip(sys.executable, *words, *(str(FOLDERS[name]) for name in PUBLISHED))
    return {name: next(folder.glob(f"{name.replace('-', '_')}-*.whl")) for name in PUBLISHED}


def pip(python: str | Path, *words: str) -> None:
    command = [str(python), "-m", "pip", "--disable-pip-version-check", *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_the_cores_wheel_is_small_and_holds_no_picture_and_no_mesh(
    wheels: dict[str, Path],
) -> None:
    assert wheels["tpvqa"].stat().st_size <= CORE_BYTES
    inside = zipfile.ZipFile(wheels["tpvqa"]).namelist()
    assert [name for name in inside if PICTURES_AND_MESHES.search(name)] == []
    for file in ("tasks/blocksworld/domain.pddl", "vlm/recorded/answers.json.gz", "py.typed"):
        assert f"tpvqa/{file}" in inside
    assert "tpvqa/episodes/report/report.html.j2" in inside


@pytest.mark.slow
@pytest.mark.parametrize("name", PUBLISHED)
def test_a_wheel_holds_all_its_files_its_licence_and_its_notice(
    wheels: dict[str, Path], name: str
) -> None:
    inside = set(zipfile.ZipFile(wheels[name]).namelist())
    source = FOLDERS[name] / "src"
    there = {str(path.relative_to(source)) for path in source.rglob("*") if path.is_file()}
    assert {file for file in there if "__pycache__" not in file} <= inside
    licences = f"{name.replace('-', '_')}-{tpvqa.__version__}.dist-info/licenses"
    assert {f"{licences}/LICENSE", f"{licences}/NOTICE"} <= inside


class Installed:
    """An environment of its own, with commands run in an empty folder.

    What a wheel says that it needs is copied from the environment of the tests, and nothing else;
    `pip check` in the end says whether that is all.
    """

    def __init__(self, folder: Path):
        self._bin, self._here = folder / "venv" / "bin", folder / "here"
        venv.create(folder / "venv", with_pip=False, symlinks=True)
        self._here.mkdir()
        self.python = self._bin / "python"
        site = self.says("import sysconfig; print(sysconfig.get_path('purelib'))")
        self._site = Path(site.strip())

    def install(self, wheel: Path) -> None:
        words = ("install", "--quiet", "--no-compile", "--no-deps", "--no-index")
        pip(sys.executable, "--python", str(self.python), *words, str(wheel))
        (metadata,) = self._site.glob(f"{wheel.name.partition('-')[0]}-*.dist-info")
        self._bring(PathDistribution(metadata))

    def _bring(self, needing: Distribution) -> None:
        """Copy what a distribution needs, and what that needs."""
        for said in map(Requirement, needing.requires or ()):
            if said.marker is not None and not said.marker.evaluate({"extra": ""}):
                continue
            needed = distribution(said.name)
            known = {canonicalize_name(each.name) for each in self.distributions()}
            if canonicalize_name(said.name) not in known:
                for file in needed.files or ():
                    if file.parts[0] != "..":  # a script beside the packages
                        self._copy(Path(str(needed.locate_file(file))), self._site / file)
                self._bring(needed)

    def _copy(self, there: Path, here: Path) -> None:
        if there.suffix != ".pyc":
            here.parent.mkdir(parents=True, exist_ok=True)
            copy2(there, here)

    def distributions(self) -> list[Distribution]:
        """What is installed in it."""
        return list(map(PathDistribution, self._site.glob("*.dist-info")))

    def tpvqa(self, *words: object) -> tuple[int, str, str]:
        return self._run(self._bin / "tpvqa", *words)

    def says(self, source: str) -> str:
        return self._run(self.python, "-c", source)[1]

    def _run(self, *words: object) -> tuple[int, str, str]:
        env = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        command = [str(word) for word in words]
        done = subprocess.run(
            command, cwd=self._here, env=env, capture_output=True, text=True, check=False
        )
        return done.returncode, done.stdout, done.stderr


@pytest.mark.slow
def test_the_core_alone_and_then_the_household(wheels: dict[str, Path], tmp_path: Path) -> None:
    installed = Installed(tmp_path)
    installed.install(wheels["tpvqa"])
    files = (TOYS / "domain.pddl", TOYS / "collect.pddl")
    _the_core_alone(installed, files)
    _what_the_core_says_of_the_household(installed, files, make_set(tmp_path / "lamps"))
    installed.install(wheels["tpvqa-household"])
    pip(sys.executable, "--python", str(installed.python), "check")
    code, out, err = installed.tpvqa("run", "eat_apple", "--seed", 1, "--json")
    assert (code, json.loads(out)["vlm"]) == (0, "embedded"), err
    assert "compose" in installed.tpvqa("dataset", "--help")[1]
    needs = installed.tpvqa("run", "eat_apple", "--world", "kitchen")[2]
    assert "pip install -e 'packages/tpvqa-household[sim]'" in needs


def _the_core_alone(installed: Installed, files: tuple[Path, Path]) -> None:
    imports = ("from tpvqa import Trial", BESIDE)
    sources = [f"import time; {each}; print(time.process_time())" for each in imports]
    took = [[float(installed.says(source)) for source in sources] for _ in range(5)]
    own, others = map(min, zip(*took, strict=True))
    assert own <= IMPORTS * others, took
    loaded = installed.says("import sys; from tpvqa import Trial; print(*sys.modules)").split()
    assert {*NOT_YET}.isdisjoint(loaded)
    code, out, err = installed.tpvqa("--help")
    assert (code, err) == (0, "")
    assert "calibrate" in out
    assert "dataset" not in out
    words = ("--questions", TOYS / "questions.yaml", "--failure", 0, "--out", "own")
    code, out, err = installed.tpvqa("run", *files, *words)
    assert code == 0, err
    assert "goal reached" in out
    assert installed.tpvqa("report", "own")[0] == 0
    assert installed.tpvqa("run", "build_tower", "--seed", 1)[0] == 0
    assert installed.tpvqa("tasks")[1].startswith("build_tower")


def _what_the_core_says_of_the_household(
    installed: Installed, files: tuple[Path, Path], pictures: Path
) -> None:
    install = "pip install -e packages/tpvqa-household"
    for words in (
        ("run", "clean_dishes"),
        ("run", "build_tower", "--world", "images"),
        ("run", "build_tower", "--vlm", "embedded"),
        ("run", *files, "--world", f"pictures:{pictures}"),
        ("calibrate", "--pictures", "shipped", "--vlm", "oracle"),
        ("dataset", "verify"),
    ):
        code, _, err = installed.tpvqa(*words)
        assert code == 2, words
        assert install in err or "packages/tpvqa[calibrate]" in err, err
        assert "Traceback" not in err
