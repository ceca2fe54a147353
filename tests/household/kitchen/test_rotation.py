import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tpvqa_household.kitchen.rotation import (
    about_x,
    about_y,
    about_z,
    looking,
    matrix,
    quaternion,
)

angles = st.floats(-3.2, 3.2)


@given(angles, angles, angles)
def test_a_quaternion_is_the_same_rotation(a: float, b: float, c: float) -> None:
    rotation = about_x(a) @ about_y(b) @ about_z(c)
    assert np.allclose(matrix(quaternion(rotation)), rotation, atol=1e-5)


@given(angles, st.floats(-1.2, 1.2))
def test_a_camera_looks_where_it_should_and_stands_upright(yaw: float, pitch: float) -> None:
    forward = about_z(yaw) @ about_y(pitch) @ [1.0, 0, 0]
    axes = looking(forward)
    assert np.allclose(axes @ [0, 0, -1], forward, atol=1e-9)
    assert np.allclose(axes.T @ axes, np.eye(3), atol=1e-9)
    assert axes[2, 0] == 0
    assert axes[2, 1] > 0
