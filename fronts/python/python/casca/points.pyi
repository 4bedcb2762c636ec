import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["hidden_point_removal", "splat_visible"]

def hidden_point_removal(
    points: ArrayLike, eye: ArrayLike, *, log10_radius: float = 3.0
) -> NDArray[np.bool_]:
    """The points on the convex hull of the cloud turned inside out around the eye.

    points: (n, 3) float64. eye: (3,). log10_radius: the decimal logarithm of the radius, as a multiple of the
    largest distance from the eye; 2 to 3.5 are usual, and greater ones show more. Returns (n,) bool.
    """

def splat_visible(
    points: ArrayLike,
    eye: ArrayLike,
    target: ArrayLike,
    *,
    radius: float | None = None,
    bias: float = 0.05,
    fov_y: float = 60.0,
    width: int = 1280,
    height: int = 720,
    near: float = 0.1,
    far: float = 1000.0,
) -> NDArray[np.bool_]:
    """The points in a picture that are not behind squares around others, y up.

    points: (n, 3) float32. radius: half the edge of the squares, in world units; by the distances of
    neighbours if None. bias: how far behind a square a point may be, as a part of the way to the far
    plane in depths of a graphics processor. fov_y: degrees. Returns (n,) bool.
    """
