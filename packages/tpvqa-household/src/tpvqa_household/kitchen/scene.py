"""One random kitchen that can be put into any state of the household and looked at."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tpvqa.chance import chance_array
from tpvqa.errors import UnknownNameError, WorldError
from tpvqa.pddl import Atom, State
from tpvqa_household.kitchen.cameras import Shot, Wanted, choose, faults, overview
from tpvqa_household.kitchen.drawing import Drawing
from tpvqa_household.kitchen.furniture import furnish
from tpvqa_household.kitchen.gl import load_mujoco
from tpvqa_household.kitchen.grippers import Hand, empty_hand, forearm, holding
from tpvqa_household.kitchen.household import HANDS, ITEMS, Household
from tpvqa_household.kitchen.layout import Split
from tpvqa_household.kitchen.names import Names
from tpvqa_household.kitchen.paintwork import Paintwork
from tpvqa_household.kitchen.rotation import Array, quaternion
from tpvqa_household.kitchen.spots import Pose, Spots, halves
from tpvqa_household.kitchen.truth import Shown, objections, shown
from tpvqa_household.kitchen.viewpoints import approach

ATTEMPTS = 12
"""Arrangements that are tried for one picture."""
VIEWS = ("front", "left", "right", "overview")
HIDDEN = 4
"""The geom group that is not drawn."""
OPAQUE = 0.9
"""Materials of less are seen through."""


class KitchenScene:
    """One random kitchen, compiled by MuJoCo.

    Args:
        seed: Decides the whole kitchen.
        split: Held-out kitchens have meshes, grippers and layouts that training never sees.
        size: Height and width of the pictures, pixels.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        WorldError: There is no graphics library to draw with.
    """

    def __init__(self, *, seed: int, split: Split = "train", size: int = 224):
        self._mujoco = mj = load_mujoco()
        self.seed, self.split, self.size = seed, split, size
        rng = chance_array(seed, 0, "kitchen", split)
        self.furniture = furnish(rng, split, size=size)
        self.model = mj.MjModel.from_xml_string(
            self.furniture.xml, assets=dict(self.furniture.files)
        )
        self.data = mj.MjData(self.model)
        self.spots = Spots(self.furniture, seed)
        self._names = Names(self.model, self.furniture.models)
        self._group = self.model.geom_group.copy()
        self._camera = mj.mj_name2id(self.model, mj.mjtObj.mjOBJ_CAMERA, "robot")
        self._paintwork = Paintwork(self.model, self._names.material, self._names.geom)
        self._drawing = Drawing(self.model, size)
        self._household: Household | None = None
        self._counts: Mapping[str, int] | None = None
        self._shadow = True
        self._where: tuple[object, ...] = ()
        self.wrong = 0.0
        self.view = "front"
        self.repaint(0)

    def repaint(self, number: int) -> None:
        """Give walls, floor and furniture other colours. 0 is how the kitchen was made."""
        rng = chance_array(self.seed, 0, "paint", number)
        self._paintwork.repaint(rng)

    @staticmethod
    def views() -> tuple[str, ...]:
        """The views that `arrange` can take."""
        return VIEWS

    def arrange(
        self,
        state: State,
        *,
        look: int,
        view: str = "front",
        placement: object = None,
        fixed: Mapping[str, Pose] | None = None,
        steady: bool = False,
    ) -> None:
        """Put everything where the state says, and the camera where the robot stands.

        Args:
            state: A state of the household domain.
            look: Varies camera pose, hands and light.
            view: One of `views()`.
            placement: Varies where on their surfaces things lie; as `look` unless given.
            fixed: Poses of items that are already decided, e.g. by how they fell.
            steady: Never move things to get a better picture of them.

        Raises:
            UnknownNameError: There is no such view.
            WorldError: The state is not one of the household.
        """
        if view not in VIEWS:
            raise UnknownNameError("view", view, VIEWS)
        household = Household.read(state)
        self._household, self.view = household, view
        key = look if placement is None else placement
        wrong: dict[int, float] = {}
        for attempt in range(ATTEMPTS):
            wrong[attempt] = self._attempt(household, attempt, look, key, fixed, steady=steady)
            if wrong[attempt] <= 0:
                break
        best = min(wrong, key=lambda attempt: wrong[attempt])
        if best != attempt:
            self._attempt(household, best, look, key, fixed, steady=steady)
        self.wrong = wrong[best]

    def _attempt(
        self,
        household: Household,
        attempt: int,
        look: int,
        key: object,
        fixed: Mapping[str, Pose] | None,
        *,
        steady: bool,
    ) -> float:
        """Arrange everything once; gives how much is wrong with the picture."""
        together = None if steady else household.near
        self._where = where = (key, 0 if steady else attempt)
        poses = self.spots.place(household, where, together=together, fixed=fixed)
        rng = chance_array(self.seed, 0, "look", look, self.view, attempt)
        if self.view == "overview":
            shot, wrong = overview(self.furniture.layout, rng), 0.0
        else:
            shot, wrong = self._shoot(household, poses, rng)
        self._set_scene(household, poses | self.spots.loose(where), shot, rng)
        if self.view == "overview":
            return wrong
        return 0.2 * wrong + objections(household, self.pixels(), size=self.size)

    def _shoot(
        self, household: Household, poses: Mapping[str, Pose], rng: np.random.Generator
    ) -> tuple[Shot, float]:
        found, wanted = approach(
            household, self.spots, poses, rng, door=self._door_angle(household)
        )
        side = {"left": -1.0, "right": 1.0}.get(self.view, 0.0)
        aside = 0.0
        if len(household.held) == 1:
            aside = 0.2 if "left" in household.held else -0.2
        layout = self.furniture.layout
        shot, wrong = choose(found, wanted, layout, rng, side=side, aside=aside)
        if wrong > 0:  # what must stay out is counted by its pixels: walls may hide it
            wrong = faults(shot, Wanted(inside=wanted.inside), layout)
        return shot, wrong

    def _set_scene(
        self,
        household: Household,
        poses: Mapping[str, Pose],
        shot: Shot,
        rng: np.random.Generator,
    ) -> None:
        model, data, mj = self.model, self.data, self._mujoco
        model.cam_pos[self._camera] = shot.position
        model.cam_quat[self._camera] = quaternion(shot.axes)
        model.cam_fovy[self._camera] = shot.fovy
        self._paintwork.light(rng)
        self._shadow = bool(rng.random() < 0.6)
        drawn = set(self._names.geoms_of) - set(ITEMS) - {"half_a", "half_b", "dirt", *HANDS}
        drawn -= {name for name in self.furniture.loose if name not in poses}
        placed = dict(poses)
        if self.view != "overview":
            drawn |= set(HANDS)
        for hand in HANDS:
            gripper = empty_hand(hand, shot.axes, shot.position, rng)
            item = household.held.get(hand)
            if item is not None:
                position, rotation, gripper = holding(
                    self.furniture.models[item],
                    gripper,
                    rng,
                    level=0.6 if household.upon(item) else 0.0,
                )
                placed[item] = Pose(position, rotation)
            self._set_hand(hand, gripper, shot)
        if self.view == "overview":
            for item in household.hand_of:
                placed.pop(item)
        placed |= self.spots.upon(household, placed, ("held",))
        for item in ITEMS:
            if item not in placed:
                continue
            if item == "apple" and household.halved:
                held = item in household.hand_of
                pair = halves(
                    placed[item],
                    self.furniture.models["apple"],
                    rng,
                    robot=shot.position,
                    held=held,
                )
                for name, pose in zip(("half_a", "half_b"), pair, strict=True):
                    data.mocap_pos[self._names.mocap[name]] = pose.position
                    data.mocap_quat[self._names.mocap[name]] = quaternion(pose.axes)
                drawn |= {"half_a", "half_b"}
                continue
            drawn.add(item)
            self._put(item, placed[item])
        if not household.clean:
            drawn.add("dirt")
        for name in self.furniture.loose:
            if name in poses:
                model.body_pos[self._names.body[name]] = poses[name].position
                model.body_quat[self._names.body[name]] = quaternion(poses[name].axes)
        data.qpos[self._names.joint["fridge/door_joint"]] = self._door_angle(household)
        self._switch_tv(household.turned_on)
        mj.mj_kinematics(model, data)
        mj.mj_comPos(model, data)
        mj.mj_camlight(model, data)
        self._draw_only(drawn, shot)
        self._counts = None

    def _door_angle(self, household: Household) -> float:
        if not household.opened:
            return 0.0
        turn = chance_array(self.seed, 0, "door", *self._where).uniform(80, 115)
        return math.radians(min(float(turn), self.furniture.models["fridge"].joints[0].range[1]))

    def _draw_only(self, drawn: set[str], shot: Shot) -> None:
        """Hide what is not there, and spare the renderer what the camera cannot see."""
        model, data = self.model, self.data
        hidden = np.full(model.ngeom, HIDDEN)
        for name in drawn:
            geoms = self._names.geoms_of[name]
            hidden[geoms] = self._group[geoms]
        bounded = model.geom_rbound > 0
        in_view = shot.sees(data.geom_xpos, model.geom_rbound + 0.15)
        hidden[bounded & np.logical_not(in_view)] = HIDDEN
        model.geom_group[:] = hidden

    def _switch_tv(self, on: bool) -> None:
        tv = self.furniture.models["tv"]
        material = self._names.material[tv.material("screen_on" if on else "screen_off")]
        for part in tv.parts_with("screen"):
            self.model.geom_matid[self._names.geom[f"tv/{part.name}"]] = material

    def _put(self, body: str, pose: Pose) -> None:
        joint = self.model.body_jntadr[self._names.body[body]]
        address = self.model.jnt_qposadr[joint]
        self.data.qpos[address : address + 3] = pose.position
        self.data.qpos[address + 3 : address + 7] = quaternion(pose.axes)

    def _set_hand(self, side: str, hand: Hand, shot: Shot) -> None:
        self.data.mocap_pos[self._names.mocap[side]] = hand.tip
        self.data.mocap_quat[self._names.mocap[side]] = quaternion(hand.axes)
        for joint in self.furniture.models["gripper"].joints:
            address = self._names.joint[f"{side}/{joint.body}_joint"]
            if joint.kind == "ball":
                wrist = np.array(joint.pos)
                axes = forearm(side, hand, wrist, shot.axes, shot.position)
                self.data.qpos[address : address + 4] = quaternion(axes)
            else:
                self.data.qpos[address] = hand.width / 2

    def render(self) -> NDArray[np.uint8]:
        """The picture of the last arrangement, size × size × 3.

        Raises:
            WorldError: Nothing was arranged yet.
        """
        self._arranged()
        return self._drawing.picture(self.data, self._camera, shadow=self._shadow)

    def pixels(self) -> Mapping[str, int]:
        """How many pixels of a picture of the last arrangement show each thing."""
        if self._counts is None:
            geoms = self._geoms().ravel()
            self._counts = self._names.by_thing(np.bincount(geoms, minlength=self.model.ngeom + 1))
        return self._counts

    def mask(self, thing: str) -> NDArray[np.bool_]:
        """Which pixels of a picture of the last arrangement show a thing, size × size."""
        return self._names.mask(thing, self._geoms())

    def _geoms(self) -> NDArray[np.int64]:
        self._arranged()
        # Segmentation takes glass for opaque, so it is left out.
        glass = self.model.mat_rgba[self.model.geom_matid, 3] < OPAQUE
        drawn = self.model.geom_group[glass].copy()
        self.model.geom_group[glass] = HIDDEN
        geoms = self._drawing.geoms(self.data, self._camera, self.size)
        self.model.geom_group[glass] = drawn
        return geoms

    def shown(self) -> Mapping[Atom, Shown]:
        """Every fact of the household: whether it is true, and whether the picture shows it."""
        return shown(
            self._arranged(), self.pixels(), size=self.size, first_person=self.view != "overview"
        )

    def _arranged(self) -> Household:
        if self._household is None:
            raise WorldError("Nothing was arranged yet: call arrange(state, look=…) first.")
        return self._household

    def drop(self, item: str, *, at: Array, key: tuple[object, ...]) -> Pose:
        """Let an item fall to the floor beside a point, by physics.

        Args:
            item: Which.
            at: Where the robot stands.
            key: Decides how it falls.
        """
        rng = chance_array(self.seed, 0, "drop", item, *key)
        return self.spots.dropped(item, self.spots.floor_beside(at, 0.45, rng), rng)

    @property
    def robot(self) -> Array:
        """Where the robot's camera is."""
        return np.asarray(self.model.cam_pos[self._camera].copy())

    def close(self) -> None:
        """Free the canvas. Can be called twice."""
        self._drawing.close()
