"""What a user is told when the live kitchen cannot draw."""

import os
import subprocess
import sys

import pytest

from tpvqa.errors import MissingExtraError
from tpvqa.worlds.kitchen.gl import load_mujoco


def test_a_missing_package_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtraError, match=r"tpvqa\[sim\]"):
        load_mujoco()


def test_missing_graphics_say_what_to_install() -> None:
    program = "from tpvqa.worlds.kitchen.gl import load_mujoco; load_mujoco()"
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "MUJOCO_GL": "nonsense"},
        capture_output=True,
        text=True,
        check=False,
    )
    last = done.stderr.strip().splitlines()[-1]
    assert "WorldError" in last
    assert "libosmesa6" in last
