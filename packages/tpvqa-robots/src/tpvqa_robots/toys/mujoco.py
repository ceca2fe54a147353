"""MuJoCo with a renderer that works without a screen, and where robosuite's models lie."""

import os
import sys
from ctypes.util import find_library
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from tpvqa.errors import MissingExtraError, WorldError
from tpvqa_robots import DISTRIBUTION


def load_mujoco() -> Any:
    """Import MuJoCo, choosing software rendering where nothing else was chosen.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        WorldError: It is, but its graphics library is not there.
    """
    if "mujoco" not in sys.modules and "MUJOCO_GL" not in os.environ and sys.platform == "linux":
        os.environ["MUJOCO_GL"] = "osmesa" if find_library("OSMesa") else "egl"
    if find_spec("mujoco") is None:
        raise MissingExtraError("mujoco", "sim", "The toys' table", distribution=DISTRIBUTION)
    try:
        import mujoco
    except (ImportError, AttributeError, RuntimeError, OSError) as error:
        raise WorldError(
            f"MuJoCo cannot draw ({error}). Software rendering needs the library OSMesa: "
            "`apt-get install libosmesa6`, then set the environment variable MUJOCO_GL=osmesa."
        ) from error
    return mujoco


def robosuite_models() -> Path:
    """The folder of robosuite's robots, grippers and bases. Robosuite itself is not imported.

    Raises:
        MissingExtraError: Robosuite is not installed.
    """
    found = find_spec("robosuite")
    if found is None or found.origin is None:
        raise MissingExtraError("robosuite", "sim", "The toys' robot", distribution=DISTRIBUTION)
    return Path(found.origin).parent / "models" / "assets"
