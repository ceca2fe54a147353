"""What a user is told when the live kitchen cannot draw."""

import os
import subprocess
import sys

import pytest

from tpvqa.errors import MissingExtraError
from tpvqa_household.kitchen.gl import load_mujoco


def test_a_missing_package_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtraError, match=r"tpvqa-household\[sim\]"):
        load_mujoco()


def test_missing_graphics_say_what_to_install() -> None:
    program = "from tpvqa_household.kitchen.gl import load_mujoco; load_mujoco()"
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


@pytest.mark.rendering
def test_it_draws_also_where_mujoco_was_imported_before() -> None:
    program = (
        "import mujoco\n"
        "from tpvqa_household.kitchen.drawing import Drawing\n"
        'model = mujoco.MjModel.from_xml_string(\'<mujoco><worldbody><geom size="1"/>'
        '<camera name="c" pos="0 -5 0" xyaxes="1 0 0 0 0 1"/></worldbody></mujoco>\')\n'
        "data = mujoco.MjData(model)\n"
        "mujoco.mj_forward(model, data)\n"
        "print(Drawing(model, 32).picture(data, 0).std() > 1)"
    )
    env = {name: value for name, value in os.environ.items() if name != "MUJOCO_GL"}
    done = subprocess.run(
        [sys.executable, "-c", program], env=env, capture_output=True, text=True, check=False
    )
    assert done.stdout.strip() == "True", done.stderr
