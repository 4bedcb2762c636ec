"""Lines, judged by rays at tubes that are traced here, and by shapes that are known."""

import casca
import numpy as np
import pytest
from casca import lines


def fence(gap, count, z, half=3.0):
    """Parallel lines along x in a plane across z, one after the other."""
    y = (np.arange(count) - (count - 1) / 2) * gap
    ends = np.zeros((count, 2, 3))
    ends[:, :, 1], ends[:, :, 2], ends[:, 0, 0], ends[:, 1, 0] = y[:, None], z, -half, half
    return ends.reshape(-1, 3), np.arange(count + 1) * 2


def stopped(points, offsets, start, pole, length, tube, own, solid, count=4000):
    """The share of cosine-weighted rays that tubes stop, by small steps along each ray."""
    rng = np.random.default_rng(3)
    flat = rng.normal(size=(count, 2))
    flat *= np.sqrt(rng.random((count, 1))) / np.linalg.norm(flat, axis=1)[:, None]
    side = np.cross(pole, (0.3, 0.8, 0.52))
    side /= np.linalg.norm(side)
    up = np.sqrt(1 - (flat**2).sum(1))
    ways = flat[:, :1] * side + flat[:, 1:] * np.cross(pole, side) + up[:, None] * pole
    start = start + pole * tube * 1.01
    hit = np.zeros(count, bool)
    for line, (first, last) in enumerate(zip(offsets[:-1], offsets[1:])):
        for a, b in zip(points[first : last - 1], points[first + 1 : last]):

            def near(at):
                share = np.clip((at - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
                return np.linalg.norm(at - a - share[..., None] * (b - a), axis=-1) <= tube

            if near(start):
                hit |= solid and line != own
                continue
            for t in np.arange(0, length, tube / 4):
                hit |= near(start + ways * t)
    return hit.mean()


def test_half_of_the_sky_behind_a_fence_is_hidden():
    # An endless wall half a radius above a line hides sin(60 degrees)^2 of its hemisphere.
    points, offsets = fence(0.01, 600, 0.51)
    points = np.concatenate([[(-1, 0, 0), (0, 0, 0), (1, 0, 0)], points])
    offsets = np.concatenate([[0], offsets + 3])
    how = {"radius": 1.0, "line_radius": 0.01, "rays": 400}
    towards = lines.ambient_occlusion(points, offsets, directions=[(0, 0, 1)], **how)
    away = lines.ambient_occlusion(points, offsets, directions=[(0, 0, -1)], **how)
    assert towards.shape == (len(points),) and towards.dtype == np.float32
    assert towards[1] == pytest.approx(0.75, abs=0.06) and away[1] == 0
    both = lines.ambient_occlusion(points, offsets, directions=[(0, 0, 5), (0, 0, -1)], **how)
    assert np.allclose(both, (towards + away) / 2, atol=1e-6)


def test_rays_and_bundles_agree():
    rng = np.random.default_rng(7)
    ends = rng.normal(scale=0.03, size=(40, 1, 3)) + np.array([(-1, 0, 0), (0, 0, 0), (1, 0, 0)])
    points, offsets = ends.reshape(-1, 3), np.arange(41) * 3
    pole = np.array((0, 0, 1.0))
    how = {"radius": 0.3, "line_radius": 0.02, "rays": 64, "directions": [pole]}
    means = []
    for solid in (False, True):
        found = lines.ambient_occlusion(points, offsets, solid=solid, **how)[1::3]
        wanted = [stopped(points, offsets, ends[i, 1], pole, 0.3, 0.02, i, solid, count=200) for i in range(40)]
        assert np.corrcoef(found, wanted)[0, 1] > 0.95, (found, wanted)
        assert abs(np.mean(found) - np.mean(wanted)) < 0.08
        means.append(np.mean(wanted))
    # Some strands are buried in others.
    assert means[1] > means[0] + 0.1


def test_a_picture_shows_the_nearest_lines():
    far, near = fence(0.1, 9, 0.0), fence(0.02, 200, 1.0)
    points, offsets = np.concatenate([far[0], near[0]]), np.concatenate([far[1], near[1][1:] + len(far[0])])
    look = {"width": 160, "height": 90, "up": (0, 1, 0)}
    front = lines.picture(points, offsets, (0, 0, 4), (0, 0, 0), **look)
    assert front.line.shape == front.occlusion.shape == (90, 160) and front.line.dtype == np.int64
    assert front.line[45, 80] >= 9 and (front.occlusion[front.line < 0] == 0).all() and front.line.min() >= -1
    # From behind, before the other lines.
    back = lines.picture(points, offsets, (0, 0, -4), (0, 0, 0), **look)
    shown = np.unique(back.line[back.line >= 0])
    assert set(range(9)) <= set(shown) and back.occlusion.max() <= 1
    seen = lines.visible_lines(points, offsets, (0, 0, -4), (0, 0, 0), **look)
    assert seen.dtype == bool and np.array_equal(np.nonzero(seen)[0], shown)
    assert not lines.visible_lines(points, offsets, (0, 0, 4), (0, 0, 0), **look)[4]


def test_lines_of_any_number_of_points():
    empty = lines.ambient_occlusion(np.zeros((0, 3)), [0])
    assert empty.shape == (0,)
    assert (lines.picture(np.zeros((0, 3)), [0], (0, 0, 4), (0, 0, 0), width=8, height=4).line == -1).all()
    # A dot, a line without points, and one of two points.
    assert lines.ambient_occlusion([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [0, 1, 1, 3]).tolist() == [0, 0, 0]
    assert lines.visible_lines([(0, 0, 0)], [0, 1], (0, 0, 4), (0, 0, 0)).tolist() == [True]


@pytest.mark.parametrize(
    ("points", "offsets", "why"),
    [
        (np.zeros((4, 2)), [0, 4], r"points must have shape \(n, 3\): .*; got shape \(4, 2\) of float64"),
        ([[0, 0, np.nan]], [0, 1], r"points\[0, 2\] is NaN, .*finite"),
        (np.zeros((4, 3)), [0, 5], r"offsets\[1\] is 5, but must lie between 0 and 4"),
        (np.zeros((4, 3)), [0, 3, 2, 4], "offsets must not fall: 3 is before 2"),
        (np.zeros((4, 3)), [0, 2], "begin with 0 and end with 4"),
        (np.zeros((4, 3)), [1, 4], "begin with 0 and end with 4"),
        (np.zeros((4, 3)), [], "begin with 0 and end with 4"),
        (np.zeros((4, 3)), [[0, 4]], r"offsets must have shape \(n,\): .*as integers; got"),
    ],
)
def test_bad_lines(points, offsets, why):
    for call in (
        lambda: lines.ambient_occlusion(points, offsets),
        lambda: lines.picture(points, offsets, (0, 0, 4), (0, 0, 0)),
        lambda: lines.visible_lines(points, offsets, (0, 0, 4), (0, 0, 0)),
    ):
        with pytest.raises(casca.Error, match=why):
            call()


def test_bad_options():
    two = ([(0, 0, 0), (1, 0, 0)], [0, 2])
    for wrong, why in (
        (lambda: lines.ambient_occlusion(*two, radius=-1), "radius of -1"),
        (lambda: lines.ambient_occlusion(*two, line_radius=np.nan), "radius NaN"),
        (lambda: lines.ambient_occlusion(*two, rays=0), "rays must lie between 1 and 4096, not 0"),
        (lambda: lines.ambient_occlusion(*two, directions=[]), "directions .*one or more"),
        (lambda: lines.ambient_occlusion(*two, directions=[(0, 0)]), r"direction must have shape \(3,\)"),
        (lambda: lines.ambient_occlusion(*two, directions=[(0, 0, 0)]), "direction"),
        (lambda: lines.picture(*two, (0, 0, 0), (0, 0, 0)), "give no view"),
        (lambda: lines.picture(*two, (0, 0, 4), (0, 0, 0), up=(0, 0, 1)), "give no view"),
        (lambda: lines.picture(*two, (0, 0, np.nan), (0, 0, 0)), "eye"),
        (lambda: lines.picture(*two, (0, 0, 4), (0, 0, 0), width=0), "width must lie between 1 and 16384, not 0"),
        (lambda: lines.picture(*two, (0, 0, 4), (0, 0, 0), fov_y=180), "angles lie between"),
    ):
        with pytest.raises(casca.Error, match=why):
            wrong()
    with pytest.raises(TypeError, match="offsets must have .* as integers"):
        lines.ambient_occlusion([(0, 0, 0)], [0.0, 1.0])
