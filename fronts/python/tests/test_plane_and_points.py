"""The plane and points, judged by rays and by shapes that are known."""

import casca
import numpy as np
import pytest
from casca import plane, points


def sees(walls, eye, target):
    """Whether a ray between two places meets no tile of a wall on its way, by small steps."""
    steps = np.linspace(0, 1, 2000)[1:-1, None]
    way = np.floor(eye + steps * (target - eye)).astype(int)
    goal = tuple(np.floor(target).astype(int))
    return all(not walls[y, x] for x, y in set(map(tuple, way)) if (x, y) != goal)


@pytest.mark.parametrize("seed", range(4))
def test_tiles_that_rays_reach_are_seen(seed):
    rng = np.random.default_rng(seed)
    walls = rng.random((24, 40)) < 0.2
    walls[10:13, 18:21] = False
    eye = np.array((19.5, 11.5))
    seen = plane.field_of_view(walls, tuple(eye))
    assert seen.shape == walls.shape and seen.dtype == bool and not seen.all()
    for _ in range(400):
        target = rng.uniform((0, 0), (40, 24))
        if sees(walls, eye, target):
            assert seen[int(target[1]), int(target[0])]
    near = plane.field_of_view(walls, tuple(eye), radius=5)
    ys, xs = np.nonzero(near)
    assert (near <= seen).all() and near.sum() < seen.sum() and np.hypot(xs + 0.5 - 19.5, ys + 0.5 - 11.5).max() < 6
    right = plane.field_of_view(walls, tuple(eye), direction=(1, 0), half_angle=0.5)
    assert (right <= seen).all() and not right[:, :18].any() and right[11, 20]


@pytest.mark.parametrize("radius", [None, 6])
def test_a_symmetric_field_of_view(radius):
    rng = np.random.default_rng(5)
    walls = rng.random((11, 13)) < 0.3
    free = np.argwhere(~walls)
    tile = lambda y, x, **how: plane.field_of_view(walls, (x + 0.5, y + 0.5), radius=radius, **how)
    seen = {(y, x): tile(y, x, symmetric=True) for y, x in free}
    lone = {(y, x): tile(y, x) for y, x in free}
    ways = lambda fields: [fields[tuple(a)][tuple(b)] for a in free for b in free]
    back = lambda fields: [fields[tuple(b)][tuple(a)] for a in free for b in free]
    assert ways(seen) == back(seen) and ways(lone) != back(lone)
    for (y, x), field in seen.items():
        assert (lone[y, x] <= field).all()
        eye = (x + rng.random(), y + rng.random())
        assert (plane.field_of_view(walls, eye, radius=radius) <= field).all()
        assert np.array_equal(plane.field_of_view(walls, eye, radius=radius, symmetric=True), field)
    for wrong in ((-0.1, 3), (3, -0.1), (13, 3), (3, 11)):
        with pytest.raises(casca.Error, match="eye must lie on the map of 13 x 11 tiles"):
            plane.field_of_view(walls, wrong, symmetric=True)
    with pytest.raises(casca.Error, match="has no direction"):
        plane.field_of_view(walls, (3, 3), symmetric=True, direction=(1, 0), half_angle=1)


def test_a_wall_cuts_the_region():
    walls = [[(2, 4), (6, 4)], [(0, 0), (8, 0)]]
    region = plane.visible_region(walls, (4, 2), 100)
    assert region.ndim == 2 and region.shape[1] == 2

    def area(at):
        x, y = at.astype(float).T
        return 0.5 * abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1)))

    # A room: exactly its area.
    room = [[(0, 0), (8, 0)], [(8, 0), (8, 5)], [(8, 5), (0, 5)], [(0, 5), (0, 0)]]
    assert area(plane.visible_region(room, (3, 2), 100)) == pytest.approx(40, rel=1e-4)
    # Behind a wall from (2, 4) to (6, 4) a trapezoid up to y = 5 is missing.
    hidden = (4 + 6) / 2
    assert area(plane.visible_region([*room, [(2, 4), (6, 4)]], (4, 2), 100)) == pytest.approx(40 - hidden, rel=1e-4)


def test_half_of_a_sphere_is_seen():
    rng = np.random.default_rng(1)
    ball = rng.normal(size=(20_000, 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    eye = (0.0, 0.0, 6.0)
    truth = ball[:, 2] > 1 / 6
    splats = points.splat_visible(ball, eye, (0, 0, 0), width=480, height=480, bias=0.01)
    for seen in (points.hidden_point_removal(ball, eye), splats):
        assert seen.dtype == bool and seen.shape == truth.shape
        assert (seen != truth).mean() < 0.06
    tight = points.hidden_point_removal(ball, eye, log10_radius=2.0)
    assert tight.sum() < points.hidden_point_removal(ball, eye, log10_radius=3.5).sum()


def test_bad_input():
    walls = np.zeros((4, 4), bool)
    for wrong in (
        lambda: plane.field_of_view(walls, (np.nan, 0)),
        lambda: plane.field_of_view(walls, (1, 1), radius=-1),
        lambda: plane.field_of_view(walls, (1, 1), direction=(1, 0)),
        lambda: plane.field_of_view(walls, (1, 1), direction=(0, 0), half_angle=1),
        lambda: plane.visible_region(np.zeros((1, 3, 2)), (0, 0), 1),
        lambda: plane.visible_region([[(0, 0), (np.nan, 1)]], (0, 0), 1),
        lambda: plane.visible_region([[(0, 0), (1, 1)]], (0, np.inf), 1),
        lambda: plane.visible_region([[(0, 0), (1, 1)]], (0, 2), -1),
        lambda: plane.visible_region([[(0, 0), (1, 1)]], (0, 2), np.nan),
        lambda: points.hidden_point_removal(np.zeros((4, 2)), (0, 0, 1)),
        lambda: points.hidden_point_removal([[0, 0, np.nan]], (0, 0, 1)),
        lambda: points.hidden_point_removal(np.zeros((4, 3)), (0, 0, 1), log10_radius=-1),
        lambda: points.splat_visible(np.zeros((4, 3)), (0, 0, 0), (0, 0, 0)),
        lambda: points.splat_visible(np.zeros((4, 3)), (0, 0, 1), (0, 0, 0), radius=-1),
        lambda: points.splat_visible(np.zeros((4, 3)), (0, 0, 1), (0, 0, 0), width=0),
    ):
        with pytest.raises(casca.Error):
            wrong()
    assert plane.visible_region(np.zeros((0, 2, 2)), (0, 0), 1).shape[1] == 2
    assert len(points.hidden_point_removal(np.zeros((0, 3)), (0, 0, 1))) == 0
