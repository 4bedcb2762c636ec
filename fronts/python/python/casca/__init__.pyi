from collections.abc import Callable, Sequence
from os import PathLike
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import bake as bake, lines as lines, plane as plane, points as points

_Ids = NDArray[np.uint64]
_Method = Literal["point", "cell", "frustum"]
_Preset = Literal["fast", "balanced", "tight"]
_Progress = Callable[[float], object]

__all__ = [
    "SCENES",
    "Error",
    "Mesh",
    "Query",
    "Scene",
    "View",
    "__version__",
    "exact_visible",
    "bake",
    "lines",
    "plane",
    "points",
    "run_many",
]

__version__: str

SCENES: list[str]
"""The names of the generated scenes: see ``Scene.generate``."""

class Error(ValueError):
    """A call that casca refused: the message names the argument and the reason.

    Unless a method says otherwise, nothing was changed.
    """

@final
class Mesh:
    """Triangles that were prepared once, for any number of objects.

    positions: (n, 3) float32, in the space of the mesh. triangles: (m, 3) uint32, indices of them,
    counter-clockwise seen from the front. occludes: whether it may hide others. two_sided: whether
    it is drawn from both sides; else it hides from its front only. progress: is told the share of
    the work that is done, from 0 to 1; what it raises ends the work.

    Costs about a second for a million triangles.
    """

    def __new__(
        cls,
        positions: ArrayLike,
        triangles: ArrayLike,
        *,
        occludes: bool = True,
        two_sided: bool = True,
        progress: _Progress | None = None,
    ) -> Mesh: ...
    @property
    def is_closed(self) -> bool:
        """Whether every edge has two triangles."""
    def __len__(self) -> int:
        """The number of triangles."""

@final
class View:
    """What can be looked at, and from where. Views do not change. They travel to other processes
    (pickle), and are equal if they show the same from the same eyes."""

    @staticmethod
    def look_at(
        eye: ArrayLike,
        target: ArrayLike,
        *,
        fov_y: float = 60.0,
        aspect: float = 16 / 9,
        near: float = 0.1,
        far: float = 1000.0,
    ) -> View:
        """A camera at a place that looks at another one, y up.

        eye, target: (3,), in world units. fov_y: the whole height of the picture in degrees.
        aspect: width by height. near, far: distances along the line of sight, in world units.
        """
    @staticmethod
    def perspective(eye: ArrayLike, matrix: ArrayLike) -> View:
        """A perspective camera.

        eye: (3,). matrix: (4, 4), world to clip space, as ``matrix @ [x, y, z, 1]``; y up, depth
        from 0 to 1 or reversed.
        """
    @staticmethod
    def orthographic(forward: ArrayLike, matrix: ArrayLike) -> View:
        """An orthographic camera. forward: (3,), where it looks. matrix: as for ``perspective``."""
    @staticmethod
    def omnidirectional(eye: ArrayLike) -> View:
        """All directions from a place, (3,)."""
    def with_reach(self, reach: float) -> View:
        """The same for all eyes that are no farther than this, in world units."""
    def with_turn(self, angle: float) -> View:
        """The same for cameras that are turned by no more than this, in radians."""
    def with_layers(self, mask: int) -> View:
        """The same for objects that have a layer of this mask of 64 bits."""
    @property
    def eye(self) -> list[float] | None:
        """Where the eye is; None for an orthographic camera."""

@final
class Scene:
    """Objects on a grid of cubes.

    cell: the edge of a cube, in world units; about the size of a room's parts. The grid has no border.

    Ids are (n,) integers of any width, as this scene gave them; those of removed objects are refused.
    In another scene the same id may name another object.

    A scene that a query reads in another thread cannot be changed meanwhile: that raises
    RuntimeError.
    """

    def __new__(cls, cell: float) -> Scene: ...
    @staticmethod
    def from_gltf(
        path: str | PathLike[str], *, cell: float | None = None, progress: _Progress | None = None
    ) -> Scene:
        """A scene from a glTF 2.0 file (.glb or .gltf): each node with a mesh is an object.

        Only what is drawn opaque hides, from the side from which it is drawn: panes (BLEND, MASK,
        transmission), skins and morph targets hide nothing, single-sided sheets hide from their
        front only. What is left out or taken otherwise is a UserWarning.

        cell: the edge of a cube of the grid; chosen by size if None. progress: as for ``Mesh``.
        Raises OSError if the file cannot be read, and Error if it cannot be taken whole.
        """
    @staticmethod
    def generate(
        name: str,
        *,
        seed: int = 1,
        scale: float = 1.0,
        cell: float | None = None,
        progress: _Progress | None = None,
    ) -> Scene:
        """A test scene of ``SCENES``, the same for the same seed. scale: the share of its objects."""
    def insert_boxes(
        self,
        boxes: ArrayLike,
        *,
        occludes: bool = False,
        moves: bool = False,
        max_speed: float | None = None,
        layers: int = 1,
    ) -> _Ids:
        """Inserts boxes, all or none. Returns their ids.

        boxes: (n, 2, 3), the least and the greatest corner of each. occludes: whether they are solid
        and hide others. moves: whether they will move; those that nobody sees then cost nothing.
        max_speed: in world units a second, for objects that move. layers: a mask of 64 bits.
        """
    def insert_spheres(
        self,
        spheres: ArrayLike,
        *,
        occludes: bool = False,
        moves: bool = False,
        max_speed: float | None = None,
        layers: int = 1,
    ) -> _Ids:
        """As ``insert_boxes``. spheres: (n, 4), center and radius of each."""
    def insert_meshes(
        self,
        mesh: Mesh,
        transforms: ArrayLike,
        *,
        moves: bool = False,
        max_speed: float | None = None,
        layers: int = 1,
    ) -> _Ids:
        """As ``insert_boxes``: the mesh under each transform, hiding others if the mesh may.

        transforms: (n, 4, 4), mesh to world space, as ``matrix @ [x, y, z, 1]``.
        """
    def update_boxes(self, ids: ArrayLike, boxes: ArrayLike) -> None:
        """Moves objects to other boxes, (n, 2, 3). What hid by a box or sphere hides by the new box; a
        mesh hides no more, since a box covers what it does not.

        If an entry is refused, the entries before it have been moved.
        """
    def update_spheres(self, ids: ArrayLike, spheres: ArrayLike) -> None:
        """As ``update_boxes``. spheres: (n, 4)."""
    def set_transforms(self, ids: ArrayLike, transforms: ArrayLike) -> None:
        """Gives meshes other transforms, (n, 4, 4). Entries that are not refused are moved."""
    def remove(self, ids: ArrayLike) -> None:
        """Removes objects, all or none; no id may come twice. Ids are never used again."""
    def begin_frame(self, now: float) -> _Ids:
        """Begins a frame at a time in seconds, which must not go back."""
    def end_frame(self, queries: Sequence[Query]) -> None:
        """Ends a frame with the queries that ran in it: objects that move and that none of them
        sees cost nothing until they may come into sight."""
    @property
    def ids(self) -> _Ids:
        """The ids of all objects, in the order of ``boxes``."""
    def boxes(self, ids: ArrayLike | None = None) -> NDArray[np.float32]:
        """The boxes around objects, (n, 2, 3); around all if there are no ids."""
    def occluders(self, ids: ArrayLike | None = None) -> NDArray[np.bool_]:
        """Which objects hide others, (n,)."""
    @property
    def path_length(self) -> int:
        """The frames of the camera's path that came with the scene; 0 without one."""
    def path_view(self, frame: int, *, aspect: float = 16 / 9) -> View:
        """The camera of a frame of that path."""
    @property
    def origin(self) -> list[float]:
        """What is added to all coordinates of this scene, its boxes, views and grid, for those of the
        file or world that it shows: a file whose contents lie far from its origin, such as in UTM, gets
        an origin near them, since single precision is too coarse there. Else zeros. Subtract it, in
        double precision, from coordinates that you pass in.

        Set it for levels far from a world's origin, and from time to time in worlds so large that it
        follows the eye. Objects stay where they are in the world; their coordinates change. Views of
        before do not fit any more. Costs as inserting all objects again, up to a microsecond for each.
        """
    @origin.setter
    def origin(self, at: ArrayLike, /) -> None: ...
    def view(self, at: ArrayLike, view: View) -> View:
        """A view in coordinates relative to a place of the file or world, such as the eye, for this
        scene until its origin is set. The place is not rounded to single precision."""
    @property
    def bounds(self) -> list[list[float]] | None:
        """The corners of a box around all objects, in world units; None without objects."""
    def __len__(self) -> int: ...
    def __contains__(self, id: int, /) -> bool: ...

@final
class Query:
    """Finds what views can see of a scene. Keep one for each camera.

    method: "point", at the precision of pixels; "cell", for results that hold for a cell of the
    grid; "frustum", which hides nothing. preset: "fast", "balanced" or "tight", for "point".
    pixel_degrees: the size of a pixel of its buffers, in degrees. parallel: whether one run is
    shared by all threads.

    No object that can be seen is ever missing. Sets are larger than that by what stays in doubt.
    """

    def __new__(
        cls,
        method: _Method = "point",
        *,
        preset: _Preset | None = None,
        pixel_degrees: float | None = None,
        parallel: bool = False,
    ) -> Query: ...
    def run(self, scene: Scene, view: View) -> _Ids:
        """Finds the objects that a view can see, roughly front to back."""
    def may_see_boxes(self, scene: Scene, boxes: ArrayLike) -> NDArray[np.bool_]:
        """Whether the view of the last run may see each of some boxes, (n, 2, 3), which need not be
        objects. "No" is certain; of numbers that are not finite the answer is true."""
    def may_see_points(self, scene: Scene, points: ArrayLike) -> NDArray[np.bool_]:
        """The same for points, (n, 3)."""
    def shadow_casters(
        self,
        scene: Scene,
        *,
        direction: ArrayLike | None = None,
        position: ArrayLike | None = None,
        reach: float = ...,
    ) -> _Ids:
        """The objects whose shadows may fall on what the last run found.

        direction: (3,), where a sun shines. position: (3,), where a lamp is, with its reach in
        world units. One of the two.
        """

def run_many(
    scene: Scene,
    views: Sequence[View],
    *,
    method: _Method = "point",
    preset: _Preset | None = None,
    pixel_degrees: float | None = None,
    threads: int | None = None,
) -> list[_Ids]:
    """Finds what each of some views sees, by several threads: all cores if None.

    The sets are those of single runs. Costs a query's memory for each thread.
    """

def exact_visible(scene: Scene, view: View, *, width: int = 1280, height: int = 720) -> _Ids:
    """The objects that a camera sees in at least one pixel, in ascending order of the scene.

    By rays against the shapes, by code that shares nothing with ``Query``: what sets are judged by.
    view: of ``View.look_at`` or ``Scene.path_view``. Costs a tree over all triangles of the scene,
    and a ray for each pixel.
    """
