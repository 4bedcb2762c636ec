from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Picture", "ambient_occlusion", "picture", "visible_lines"]

class Picture(NamedTuple):
    """What each pixel shows; row 0 is the uppermost."""

    line: NDArray[np.int64]
    """(height, width), the number of the nearest line; -1 where there is none."""
    occlusion: NDArray[np.float32]
    """(height, width), from 0 in the open to 1 where nothing gets through; 0 where there is no line."""

def picture(
    points: ArrayLike,
    offsets: ArrayLike,
    eye: ArrayLike,
    target: ArrayLike,
    *,
    up: ArrayLike = (0, 1, 0),
    fov_y: float = 60.0,
    width: int = 1280,
    height: int = 720,
    radius: float | None = None,
    line_radius: float | None = None,
    rays: int = 24,
    solid: bool = False,
) -> Picture:
    """The nearest line in each pixel of a camera, and how much the lines around it hide it.

    points: (n, 3) float32, all lines one after the other. offsets: (m + 1,) integers: line i has
    ``points[offsets[i]:offsets[i + 1]]``, as in a TRX file; of nibabel's streamlines
    ``s.get_data()`` and ``np.cumsum([0, *map(len, s)])``. eye, target, up: (3,). fov_y: degrees.
    radius: of the hemisphere of rays, in the units of the points; 0.13 of the longest edge of the box
    around the lines if None. line_radius: of the tubes that lines are taken for; half a pixel in the
    middle of the depths if None. rays: of a pixel, 1 to 4096. solid: whether tubes of other lines also stop rays
    that start in them: bundles whose strands lie within a pixel come out lighter without.

    Estimates, the same for any number of threads. Costs a grid of all segments each time. Releases
    the GIL.
    """

def visible_lines(
    points: ArrayLike,
    offsets: ArrayLike,
    eye: ArrayLike,
    target: ArrayLike,
    *,
    up: ArrayLike = (0, 1, 0),
    fov_y: float = 60.0,
    width: int = 1280,
    height: int = 720,
) -> NDArray[np.bool_]:
    """Which lines are the nearest one in a pixel at least, (m,). As ``picture``."""

def ambient_occlusion(
    points: ArrayLike,
    offsets: ArrayLike,
    *,
    directions: ArrayLike = ...,
    radius: float | None = None,
    line_radius: float | None = None,
    rays: int = 24,
    solid: bool = False,
) -> NDArray[np.float32]:
    """How much lines hide each point from light, (n,): to colour tubes in a program of your own.

    As ``picture``. directions: (k, 3), to the viewer, of any length but 0; the mean over them. The
    default are the six along the axes, for any camera. line_radius: a 400th of the longest edge of
    the box around the lines if None.
    """
