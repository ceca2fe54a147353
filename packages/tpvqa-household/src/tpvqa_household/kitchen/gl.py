"""MuJoCo with a renderer that works without a screen."""

import os
import sys
from functools import cache
from importlib import import_module
from typing import Any

from tpvqa.errors import MissingExtraError, WorldError
from tpvqa_household import DISTRIBUTION

_REMEDY = (
    "Software rendering needs the library OSMesa: `apt-get install libosmesa6`, then set the "
    "environment variable MUJOCO_GL=osmesa."
)


def load_mujoco() -> Any:
    """Import MuJoCo, choosing software rendering where nothing else was chosen.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        WorldError: It is, but its graphics library is not there.
    """
    if "mujoco" not in sys.modules and "MUJOCO_GL" not in os.environ and sys.platform == "linux":
        os.environ["MUJOCO_GL"] = _software_or_not()
    os.environ.setdefault("LP_NUM_THREADS", "2")
    try:
        import mujoco
    except ModuleNotFoundError as error:
        if error.name and error.name.split(".")[0] != "mujoco":
            raise WorldError(f"MuJoCo cannot draw ({error}). {_REMEDY}") from error
        raise MissingExtraError(
            "mujoco", "sim", "The live kitchen", distribution=DISTRIBUTION
        ) from error
    except (ImportError, AttributeError, RuntimeError, OSError) as error:
        raise WorldError(f"MuJoCo cannot draw ({error}). {_REMEDY}") from error
    return mujoco


def new_context(size: int) -> Any:
    """A graphics context for pictures of up to size × size, not yet current.

    Raises:
        WorldError: There is no graphics library.
    """
    mujoco = load_mujoco()
    try:
        return _context_class(mujoco)(size, size)
    except Exception as error:
        raise cannot_draw(error) from error


@cache
def _context_class(mujoco: Any) -> Any:
    """MuJoCo's own choice where one was made; else ours, if MuJoCo was imported before it."""
    if "MUJOCO_GL" in os.environ or sys.platform != "linux":
        return mujoco.GLContext
    return import_module(f"mujoco.{_software_or_not()}").GLContext


def _software_or_not() -> str:
    """OSMesa where it is installed: its pictures are the same everywhere. Else a GPU's EGL."""
    from ctypes.util import find_library

    return "osmesa" if find_library("OSMesa") or not find_library("EGL") else "egl"


def cannot_draw(error: BaseException) -> WorldError:
    """The error to raise when a graphics context cannot be made."""
    return WorldError(f"MuJoCo cannot draw: {error or type(error).__name__}. {_REMEDY}")
