"""The robot's cameras: pictures and depth with the errors of a real one, and what they show."""

import threading
from collections.abc import Callable, Mapping
from dataclasses import astuple, dataclass, replace
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa.chance import chance_array
from tpvqa.errors import WorldError
from tpvqa.observation import Intrinsics
from tpvqa_robots.toys.mujoco import load_mujoco

OVERHEAD, WRIST, ROOM = "overhead", "wrist", "room"
CAMERAS: Mapping[str, str] = {OVERHEAD: "overhead", WRIST: "arm_eye_in_hand"}
"""The robot's own views, and what they are called in the model."""
WIDTH, HEIGHT = 640, 480


@dataclass(frozen=True, slots=True)
class Errors:
    """What is wrong with the cameras.

    Attributes:
        depth: Standard deviation of a distance of one metre, metres; grows with its square.
        missing: The share of pixels without a distance.
        colour: Standard deviation of a colour, of 255.
        shift: Standard deviation of where the camera is taken to be, metres along each axis;
            drawn once a trial.
        turn: The same of how it is taken to be turned, radians.
    """

    depth: float = 0.0015
    missing: float = 0.002
    colour: float = 2.0
    shift: float = 0.002
    turn: float = 0.003

    def times(self, factor: float, calibration: float = 1.0) -> "Errors":
        """All errors larger or smaller by a factor, by another where the camera is taken to be."""
        errors = Errors(*(factor * error for error in astuple(self)))
        shift, turn = calibration * errors.shift, calibration * errors.turn
        return replace(errors, shift=shift, turn=turn)


Draw = Callable[[Any, str], NDArray[Any]]
NO_ERRORS = Errors(0.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Shot:
    """A picture with its distances, of the moment it was taken; drawn when it is looked at.

    Attributes:
        draw: Gives the picture, height × width × 3, 0 to 255.
        measure: Gives the distances along the camera's axis, metres, height × width; NaN where
            nothing was measured.
        place: Gives where the robot takes pixels at such distances to be.
        intrinsics: Of the camera.
    """

    draw: Callable[[], NDArray[np.uint8]]
    measure: Callable[[], NDArray[np.float64]]
    place: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    intrinsics: Intrinsics

    @cached_property
    def rgb(self) -> NDArray[np.uint8]:
        """Height × width × 3, 0 to 255."""
        return self.draw()

    @cached_property
    def depth(self) -> NDArray[np.float32]:
        """Metres along the camera's axis, height × width; NaN where nothing was measured."""
        return self._measured.astype(np.float32)

    @cached_property
    def points(self) -> NDArray[np.float64]:
        """Where the robot takes each pixel to be: height × width × 3, metres from the arm's foot, x
        ahead and y to the left, z above the floor; NaN likewise."""
        return self.place(self._measured)

    @cached_property
    def _measured(self) -> NDArray[np.float64]:
        return self.measure()


class Cameras:
    """Draws what the robot's cameras see. One canvas for all: a second one garbles the first.

    Args:
        model: The compiled scene.
        errors: What is wrong with them.
        seed: Of their errors; with `episode`, see `tpvqa.chance`.
        episode: The same.
    """

    def __init__(self, model: Any, errors: Errors, *, seed: int, episode: int = 0):
        self._mj = mj = load_mujoco()
        self._model, self._errors = model, errors
        self._lock = threading.Lock()
        self._latest: dict[tuple[str, str], tuple[NDArray[np.float64], NDArray[Any]]] = {}
        try:
            self._canvas = mj.Renderer(model, HEIGHT, WIDTH)
        except Exception as error:
            raise WorldError(
                f"MuJoCo cannot draw: {error!r}. Software rendering needs the library OSMesa: "
                "`apt-get install libosmesa6`, then set the environment variable MUJOCO_GL=osmesa."
            ) from error
        self._option = mj.MjvOption()
        self._option.geomgroup[:] = [0, 1, 0, 0, 0, 0]
        self._option.sitegroup[:] = 0
        self.draw(seed, episode)

    def draw(self, seed: int, episode: int) -> None:
        """Draw where the cameras are taken to be: the errors of another trial."""
        self._seed = seed, episode
        drawn = chance_array(seed, episode, "camera")
        self._shift = drawn.normal(0, self._errors.shift, 3)
        self._turn = drawn.normal(0, self._errors.turn, 3)

    def close(self) -> None:
        """Free the canvas. Can be called twice."""
        self._canvas.close()

    def picture(self, data: Any, camera: str) -> NDArray[np.uint8]:
        """What a camera of the model sees, without errors; the room's too."""
        with self._lock:
            self._canvas.update_scene(data, camera, self._option)
            # The camera above looks down: it never sees the sky, whose drawing takes a while.
            self._canvas.scene.flags[self._mj.mjtRndFlag.mjRND_SKYBOX] = camera != OVERHEAD
            return np.array(self._canvas.render())

    def shot(self, data: Any, view: str, number: int) -> Shot:
        """A picture with depth, of now, though it may be drawn later.

        Args:
            data: The state.
            view: One of `CAMERAS`.
            number: Tells one draw of the errors from another.
        """
        camera, here = CAMERAS[view], self.intrinsics(view)
        at, key = np.array(data.qpos), (*self._seed, "shot", number)
        foot = data.body("support").xmat.reshape(3, 3)
        turned = _rotation(self._turn) @ foot.T @ data.camera(camera).xmat.reshape(3, 3)
        place = foot.T @ (data.camera(camera).xpos - data.body("support").xpos) + self._shift
        errors, shape = self._errors, (HEIGHT, WIDTH)

        def draw() -> NDArray[np.uint8]:
            rgb = self._of(at, camera, self.picture).astype(np.float64)
            rgb += chance_array(*key).normal(0, 1, rgb.shape) * errors.colour
            return np.clip(np.rint(rgb), 0, 255).astype(np.uint8)

        def measure() -> NDArray[np.float64]:
            depth = self._of(at, camera, self._distances).copy()
            drawn = chance_array(*key)
            drawn.normal(0, 1, (*shape, 3))  # those of the colours
            depth += drawn.normal(0, 1, shape) * errors.depth * depth**2
            depth[drawn.random(shape) < errors.missing] = np.nan
            return depth

        return Shot(draw, measure, lambda depth: self._points(depth, here, turned, place), here)

    def _of(self, qpos: NDArray[np.float64], camera: str, draw: Draw) -> NDArray[Any]:
        """What is drawn of a camera's view with the joints so, without errors.

        Pictures are mostly asked for while nothing moves: the latest of each kind is drawn once.
        """
        key = camera, draw.__name__
        known = self._latest.get(key)
        if known is None or not np.array_equal(known[0], qpos):
            known = self._latest[key] = qpos, draw(self._then(qpos), camera)
        return known[1]

    def _then(self, qpos: NDArray[np.float64]) -> Any:
        """The bodies, cameras and lights as they were with the joints so."""
        mj, model, then = self._mj, self._model, self._mj.MjData(self._model)
        then.qpos[:] = qpos
        mj.mj_kinematics(model, then)
        mj.mj_comPos(model, then)
        mj.mj_camlight(model, then)
        return then

    def _distances(self, data: Any, camera: str) -> NDArray[np.float64]:
        with self._lock:
            self._canvas.enable_depth_rendering()
            self._canvas.update_scene(data, camera, self._option)
            depth = np.array(self._canvas.render(), np.float64)
            self._canvas.disable_depth_rendering()
        return depth

    def intrinsics(self, view: str) -> Intrinsics:
        """A view's pinhole camera."""
        angle = np.radians(self._model.camera(CAMERAS[view]).fovy[0])
        f = HEIGHT / 2 / np.tan(angle / 2)
        return Intrinsics(f, f, (WIDTH - 1) / 2, (HEIGHT - 1) / 2, WIDTH, HEIGHT)

    def pixels_of(self, data: Any, view: str) -> Mapping[str, int]:
        """How many pixels truly show each body; for the truth alone."""
        geoms = self._geoms(data, view)
        found: dict[str, int] = {}
        for geom, count in zip(*np.unique(geoms[geoms >= 0], return_counts=True), strict=True):
            body = self._model.body(self._model.geom_bodyid[geom]).name
            name = "goal_area" if self._model.geom(geom).name == "goal_area" else body
            found[name] = found.get(name, 0) + int(count)
        return found

    def mask_of(self, data: Any, view: str, name: str) -> NDArray[np.bool_]:
        """Which pixels truly show a body, or else a geom: a recogniser without errors, where one
        stands in."""
        bodies = [self._model.body(i).name for i in range(self._model.nbody)]
        if name in bodies:
            own = np.nonzero(self._model.geom_bodyid == bodies.index(name))[0]
        else:
            own = np.array([self._model.geom(name).id])
        found: NDArray[np.bool_] = np.isin(self._geoms(data, view), own)
        return found

    def _geoms(self, data: Any, view: str) -> NDArray[np.int64]:
        """The geom that each pixel shows; -1 for none."""
        with self._lock:
            self._canvas.enable_segmentation_rendering()
            self._canvas.update_scene(data, CAMERAS[view], self._option)
            drawn = np.array(self._canvas.render(), np.int64)
            self._canvas.disable_segmentation_rendering()
        return np.where(drawn[..., 1] == int(self._mj.mjtObj.mjOBJ_GEOM), drawn[..., 0], -1)

    def _points(
        self,
        depth: NDArray[np.float64],
        of: Intrinsics,
        turned: NDArray[np.float64],
        at: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        points: NDArray[np.float64] = _rays(of) * depth[..., None] @ turned.T + at
        points[..., 2] += float(self._model.body("support").pos[2]) + _BASE_HEIGHT
        return points


@cache
def _rays(of: Intrinsics) -> NDArray[np.float64]:
    """Of each pixel, where it is at one metre of distance from the camera."""
    rows, columns = np.indices((of.height, of.width))
    across, up = (columns - of.cx) / of.fx, -(rows - of.cy) / of.fy
    return np.stack([across, up, -np.ones_like(across)], -1)


_BASE_HEIGHT = 0.5
"""Of what the arm's foot is fixed to in robosuite's model of the base, metres."""


def _rotation(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y, z = vector
    turned: NDArray[np.float64] = np.eye(3) + np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return turned
