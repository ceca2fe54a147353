"""Builds the packages of this folder into the environment, with CMake and ROS 2's wheels."""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from tpvqa.errors import TpvqaError
from tpvqa_robots import DISTRIBUTION

HERE = Path(__file__).parent
PACKAGES = ("tpvqa_interfaces", "plansys2_msgs")
STAMP = "built-by-tpvqa"
"""A file beside a package's that says what it was built from."""
_TOOLS = ("cmake", "make", "cc", "c++")
_MODULES = ("ament_package", "catkin_pkg", "rosidl_generator_py", "ros_wheels_bootstrapper")


def build(package: str, prefix: Path | None = None, *, whole: bool = False) -> str:
    """Build a package of messages and install it.

    Args:
        package: Of `PACKAGES`.
        prefix: Where to; the environment that this runs in by default.
        whole: Build it for C++, too, which takes twice as long.

    Returns:
        What was done: `built`, `up to date`, or `another's`, where the environment has a package of
        that name that was not built here.

    Raises:
        TpvqaError: A tool is missing, or it cannot be built; says what to do.
    """
    into = Path(sys.prefix) if prefix is None else prefix
    stamp, now = into / "share" / package / STAMP, _digest(package, whole=whole)
    if stamp.is_file() and stamp.read_text() in (now, _digest(package, whole=True)):
        return "up to date"
    if not stamp.is_file() and find_spec(package) is not None:
        return "another's"
    _see_tools()
    with tempfile.TemporaryDirectory(prefix=f"{package}-") as folder:
        made = Path(folder)
        _run(package, made, _configuring(HERE / package, made, into, whole=whole))
        _run(package, made, ["cmake", "--build", folder, "--parallel", str(os.cpu_count() or 1)])
        _run(package, made, ["cmake", "--install", folder])
    stamp.write_text(now)
    return "built"


def _digest(package: str, *, whole: bool) -> str:
    """Tells apart what a package is built from."""
    found = hashlib.sha256(f"{sys.version_info[:2]} {whole}".encode())
    for file in (HERE / "own_includes.cmake", *sorted((HERE / package).rglob("*"))):
        if file.is_file():
            found.update(file.name.encode() + file.read_bytes())
    return found.hexdigest()


def _see_tools() -> None:
    """See that all is there that it takes.

    Raises:
        TpvqaError: Something is missing.
    """
    missing = [tool for tool in _TOOLS if shutil.which(tool) is None]
    if missing:
        raise TpvqaError(
            f"Building messages of ROS 2 needs {', '.join(missing)}, not found here. "
            "Install them: sudo apt-get install cmake make g++"
        )
    lacking = [name for name in _MODULES if find_spec(name) is None]
    if lacking:
        raise TpvqaError(
            f"Building messages of ROS 2 needs its wheels ({', '.join(lacking)} missing). "
            f"Install them: pip install '{DISTRIBUTION}[ros2,interfaces]', or build with colcon "
            f"where ROS 2 is installed: the packages lie in {HERE}"
        )


def _configuring(source: Path, made: Path, into: Path, *, whole: bool) -> Sequence[str]:
    return [
        *("cmake", "-S", str(source), "-B", str(made), "-G", "Unix Makefiles"),
        f"-DCMAKE_INSTALL_PREFIX={into}",
        f"-DPython3_EXECUTABLE={sys.executable}",
        f"-DCMAKE_PROJECT_INCLUDE={HERE / 'own_includes.cmake'}",
        f"-DFOR_PYTHON_ALONE={'OFF' if whole else 'ON'}",
        "-DBUILD_TESTING=OFF",
    ]


def _run(package: str, made: Path, command: Sequence[str]) -> None:
    """Run a command.

    Raises:
        TpvqaError: It fails; what it said is kept.
    """
    paths = dict.fromkeys(("CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH"), sys.prefix)
    done = subprocess.run(
        command,
        env={**os.environ, **paths},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        log = Path(tempfile.gettempdir()) / f"{package}-build.log"
        log.write_text(done.stdout)
        last = "\n".join(done.stdout.strip().splitlines()[-12:])
        raise TpvqaError(
            f"{package} could not be built: '{' '.join(command[:2])}' ended with "
            f"{done.returncode}. All that it said stands in {log}; its end:\n{last}"
        )
