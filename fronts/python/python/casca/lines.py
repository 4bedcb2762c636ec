"""Ambient occlusion of dense sets of lines, such as tractograms and streamlines, and which of them can be seen."""

from typing import NamedTuple

import numpy as np

from ._casca import Error, line_occlusion, line_picture

__all__ = ["Picture", "ambient_occlusion", "picture", "visible_lines"]

_SIDES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))


def _box(points):
    """The corners of the box around points; of what is no such array, any box: it is refused later."""
    try:
        points = np.asarray(points, float).reshape(-1, 3)
    except (TypeError, ValueError):
        return np.zeros(3), np.ones(3)
    return (points.min(0), points.max(0)) if len(points) else (np.zeros(3), np.ones(3))


def _how(points, radius, line_radius, rays, solid):
    """The radius as a share of the extent, as in the thesis that the library follows."""
    low, high = _box(points)
    extent = max((high - low).max(), 1e-30)
    return (0.13 * extent if radius is None else radius, line_radius, rays, solid), extent


class Picture(NamedTuple):
    line: np.ndarray
    occlusion: np.ndarray


def _shown(points, offsets, look, fov_y, size, how):
    """What each pixel shows, and its occlusion if ``how`` asks for it, row by row."""
    # Depths that hold all lines before the eye.
    low, high = _box(points)
    away = np.linalg.norm(_box(look[0])[0] - (low + high) / 2)
    reach = max(np.linalg.norm(high - low) / 2, away * 1e-3, 1e-30)
    lens = (fov_y, (max(away - reach, reach * 1e-3), away + reach), size)
    return line_picture(points, offsets, look, lens, how)


def picture(
    points,
    offsets,
    eye,
    target,
    *,
    up=(0, 1, 0),
    fov_y=60.0,
    width=1280,
    height=720,
    radius=None,
    line_radius=None,
    rays=24,
    solid=False,
):
    how, _ = _how(points, radius, line_radius, rays, solid)
    found = _shown(points, offsets, (eye, target, up), fov_y, (width, height), how)
    return Picture(*(values.reshape(height, width) for values in found))


def visible_lines(points, offsets, eye, target, *, up=(0, 1, 0), fov_y=60.0, width=1280, height=720):
    line, _ = _shown(points, offsets, (eye, target, up), fov_y, (width, height), None)
    seen = np.zeros(len(offsets) - 1, bool)
    seen[line[line >= 0]] = True
    return seen


def ambient_occlusion(points, offsets, *, directions=_SIDES, radius=None, line_radius=None, rays=24, solid=False):
    how, extent = _how(points, radius, line_radius, rays, solid)
    if line_radius is None:
        how = (how[0], extent / 400, rays, solid)
    values = [line_occlusion(points, offsets, direction, how) for direction in directions]
    if not values:
        raise Error("directions must have shape (k, 3): one or more; got none")
    return np.mean(values, axis=0, dtype=np.float32)
