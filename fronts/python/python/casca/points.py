"""The points of a cloud that can be seen. Estimates: points are samples of an unknown surface."""

from . import _casca
from ._casca import hidden_point_removal

__all__ = ["hidden_point_removal", "splat_visible"]


def splat_visible(
    points, eye, target, *, radius=None, bias=0.05, fov_y=60.0, width=1280, height=720, near=0.1, far=1000.0
):
    return _casca.splat_visible(points, eye, target, (radius, bias), (fov_y, (width, height), near, far))
