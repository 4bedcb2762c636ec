import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["field_of_view", "visible_region"]

def field_of_view(
    walls: ArrayLike,
    eye: ArrayLike,
    *,
    radius: float | None = None,
    direction: ArrayLike | None = None,
    half_angle: float | None = None,
    symmetric: bool = False,
) -> NDArray[np.bool_]:
    """The tiles of a map that are seen from a place: those of which a point can be seen.

    walls: (height, width) bool, the tiles that block sight, ``walls[y, x]``; of numbers all but 0 do.
    eye: (2,), x and y in tiles; the middle of a tile is at .5. radius: in tiles. direction,
    half_angle: (2,) and radians. symmetric: from all places inside the tile of the eye, so that of
    two tiles that do not block each sees the other or neither does; radius then is between the
    nearest points of two tiles. Returns (height, width) bool.
    """

def visible_region(walls: ArrayLike, eye: ArrayLike, range: float) -> NDArray[np.float32]:
    """The corners of the region that is seen from a place between walls, around the eye.

    walls: (n, 2, 2), the ends of segments. eye: (2,). range: how far it sees at most. Returns
    (k, 2). Costs a grid with all walls each time.
    """
