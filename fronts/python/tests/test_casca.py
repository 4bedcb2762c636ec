"""Scenes, views and queries, judged by exact visibility."""

import copy
import gc
import pickle
import threading

import casca
import numpy as np
import pytest


def room(cell=1.0):
    return casca.Scene(cell)


def town(seed):
    """Solid blocks and small things between them."""
    rng = np.random.default_rng(seed)
    scene = room()
    low = rng.uniform((0, 0, 0), (60, 1, 60), (80, 3)).astype(np.float32)
    blocks = scene.insert_boxes(np.stack([low, low + rng.uniform(1, 8, (80, 3))], 1), occludes=True)
    centers = rng.uniform((0, 0, 0), (64, 8, 64), (400, 3))
    balls = scene.insert_spheres(np.hstack([centers, rng.uniform(0.1, 0.5, (400, 1))]))
    return scene, blocks, balls, rng


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("method", ["point", "cell"])
def test_nothing_visible_is_missing(seed, method):
    scene, _, _, rng = town(seed)
    query = casca.Query(method)
    hidden = 0
    for _ in range(4):
        eye, target = rng.uniform((2, 9, 2), (62, 12, 62), (2, 3)).astype(np.float32)
        view = casca.View.look_at(eye, target)
        seen = query.run(scene, view)
        assert seen.dtype == np.uint64 and len(set(seen)) == len(seen)
        exact = casca.exact_visible(scene, view, width=640, height=360)
        assert len(exact) > 0
        assert set(exact) <= set(seen)
        frustum = casca.Query("frustum").run(scene, view)
        assert set(seen) <= set(frustum)
        hidden += len(frustum) - len(seen)
    assert hidden > 0


def test_a_mesh_hides_by_its_triangles():
    scene = room()
    square = casca.Mesh([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2), (0, 2, 3)])
    assert len(square) == 2 and not square.is_closed
    wall = np.eye(4, dtype=np.float32)
    wall[:3, :3] *= 20
    wall[:3, 3] = (32, 16, 30)
    (wall_id,) = scene.insert_meshes(square, wall[None])
    (ball,) = scene.insert_spheres([(32, 16, 40, 1)])
    query, view = casca.Query(), casca.View.look_at((32, 16, 10), (32, 16, 40))
    assert set(query.run(scene, view)) == {wall_id}
    assert set(casca.exact_visible(scene, view)) == {wall_id}
    # From the other side it is drawn only if it has two.
    one = casca.Mesh([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2), (0, 2, 3)], two_sided=False)
    other = room()
    other.insert_meshes(one, wall[None])
    ball_before = other.insert_spheres([(32, 16, 40, 1)])
    assert ball_before[0] in query.run(other, view)
    # The wall goes aside.
    wall[0, 3] = 200
    scene.set_transforms([wall_id], wall[None])
    assert ball in query.run(scene, view)


def test_objects_move_come_and_go():
    scene = room()
    scene.insert_boxes([[(1, 1, 30), (63, 31, 32)]], occludes=True)
    balls = scene.insert_spheres([(32, 16, 40 + i, 0.4) for i in range(10)], moves=True, max_speed=5)
    query, view = casca.Query(), casca.View.look_at((32, 16, 2), (32, 16, 40))
    for frame in range(20):
        expired = scene.begin_frame(frame / 60)
        assert expired.dtype == np.uint64
        spheres = np.array([(32, 16, 40 + i, 0.4) for i in range(10)])
        if frame >= 10:
            spheres[3] = (32, 16, 10, 0.4)
        scene.update_spheres(balls, spheres)
        seen = query.run(scene, view)
        assert set(seen) & set(balls) == ({balls[3]} if frame >= 10 else set())
        scene.end_frame([query])
    assert balls[4] in scene and len(scene) == 11
    scene.remove(balls[4:])
    assert balls[4] not in scene and len(scene) == 5
    with pytest.raises(casca.Error, match="object"):
        scene.remove(balls[4:5])


def test_boxes_ids_and_layers():
    scene = room()
    boxes = np.array([[(1, 1, 1), (2, 2, 2)], [(3, 3, 3), (5, 6, 7)]], np.float32)
    first = scene.insert_boxes(boxes, occludes=True, layers=1)
    second = scene.insert_spheres([(10, 10, 10, 1)], layers=2)
    assert (scene.boxes(first) == boxes).all() and scene.boxes().shape == (3, 2, 3)
    assert list(scene.ids) == [*first, *second]
    assert list(scene.occluders()) == [True, True, False]
    scene.update_boxes(first[1:], boxes[:1])
    assert (scene.boxes(first[1:]) == boxes[:1]).all()
    view = casca.View.omnidirectional((20, 20, 20))
    query = casca.Query("frustum")
    assert set(query.run(scene, view.with_layers(2))) == set(second)
    assert set(query.run(scene, view.with_layers(3))) == {*first, *second}


def test_the_origin_moves_and_the_world_stays():
    scene, _, _, rng = town(5)
    far = np.array([4_194_304.0, 0.0, -1024.0])
    scene.origin = far
    assert list(scene.origin) == list(far)
    eye, target = rng.uniform((2, 9, 2), (62, 12, 62), (2, 3)).astype(np.float32)
    relative = casca.View.look_at((0, 0, 0), target - eye)
    query = casca.Query()
    # The town was made about the origin of the world: it is 4,194 km away now.
    low = scene.boxes()[:, 0]
    assert low[:, 0].max() < -4_194_200
    seen = set(query.run(scene, scene.view(eye, relative)))
    assert seen >= set(casca.exact_visible(scene, scene.view(eye, relative), width=320, height=180))
    scene.origin = (0, 0, 0)
    view = scene.view(eye, relative)
    assert np.allclose(view.eye, eye)
    exact = set(casca.exact_visible(scene, view, width=320, height=180))
    assert len(exact) > 5 and exact <= set(query.run(scene, view)) and exact <= seen
    # At the new place it is drawn as here.
    scene.origin = (512, 0, 0)
    assert set(casca.exact_visible(scene, scene.view(eye, relative), width=320, height=180)) == exact
    with pytest.raises(casca.Error, match="origin"):
        scene.origin = (np.nan, 0, 0)
    with pytest.raises(casca.Error, match="view"):
        scene.view((1e300, 0, 0), relative)
    generated = casca.Scene.generate("city", scale=0.2)
    before = generated.path_view(0).eye
    generated.origin = (64, 0, 0)
    assert np.allclose(generated.path_view(0).eye, np.subtract(before, (64, 0, 0)))


def camera_matrix(eye, target, fov_y, aspect, near, far):
    """World to clip space, for columns: written anew, by the book."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, (0, 1, 0))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    view = np.eye(4)
    view[:3, :3] = (right, up, -forward)
    view[:3, 3] = -view[:3, :3] @ eye
    f = 1 / np.tan(np.radians(fov_y) / 2)
    projection = np.zeros((4, 4))
    projection[0, 0], projection[1, 1] = f / aspect, f
    projection[2, 2:] = far / (near - far), near * far / (near - far)
    projection[3, 2] = -1
    return projection @ view


def test_matrices_take_columns():
    scene, _, _, rng = town(3)
    for _ in range(5):
        eye, target = rng.uniform((2, 9, 2), (62, 12, 62), (2, 3))
        matrix = camera_matrix(eye, target, 60, 16 / 9, 0.1, 1000)
        view, other = casca.View.perspective(eye, matrix), casca.View.look_at(eye, target)
        assert np.allclose(view.eye, eye)
        exact = set(casca.exact_visible(scene, other, width=320, height=180))
        seen = set(casca.Query().run(scene, view))
        assert exact <= seen
        # The last bits of the matrices differ.
        assert len(seen ^ set(casca.Query().run(scene, other))) <= 3
    with pytest.raises(casca.Error):
        casca.View.perspective(eye, matrix.T)


def test_an_orthographic_camera():
    scene = room()
    (wall,) = scene.insert_boxes([[(1, 1, 30), (63, 31, 32)]], occludes=True)
    behind, before = scene.insert_spheres([(32, 16, 40, 1), (32, 16, 20, 1)])
    # It looks along z from the side z = 0: x to the left.
    matrix = np.diag([-1 / 20, 1 / 10, 1 / 64, 1.0])
    matrix[:2, 3] = 32 / 20, -16 / 10
    view = casca.View.orthographic((0, 0, 1), matrix)
    assert view.eye is None and "orthographic" in repr(view)
    assert set(casca.Query().run(scene, view)) == {wall, before}
    assert behind in casca.Query("frustum").run(scene, view)


def test_reach_and_turn_hold_for_eyes_near_by():
    scene, _, _, rng = town(9)
    eye, target = np.array((30, 10, 30.0)), np.array((40, 9, 36.0))
    wide = casca.View.look_at(eye, target).with_reach(1.0).with_turn(0.2)
    seen = set(casca.Query().run(scene, wide))
    for _ in range(10):
        step = rng.normal(size=3)
        step /= np.linalg.norm(step)
        near = casca.View.look_at(eye + 0.99 * step, target + 0.99 * step)
        assert set(casca.exact_visible(scene, near, width=320, height=180)) <= seen


def test_views_travel_and_compare():
    scene, _, _, rng = town(4)
    eye, target = np.array((30, 10, 30.0)), np.array((40, 9, 36.0))
    camera = casca.View.look_at(eye, target)
    views = [camera, casca.View.perspective(eye, camera_matrix(eye, target, 60, 2, 0.1, 99)), casca.View.omnidirectional(eye)]
    scene.origin = (1024.25, 0, -7)
    changes = [lambda view: view.with_reach(0.7), lambda view: view.with_turn(0.1), lambda view: view.with_layers(2**63 + 1)]
    changes += [lambda view: scene.view((1054.5, 10, 23), view), lambda view: view.with_layers(1).with_reach(0.7)]
    views += [change(view) for view in views for change in changes]
    views += [casca.View.orthographic((0, 0, 1), np.diag([-1 / 20, 1 / 10, 1 / 64, 1.0]))]
    views += [casca.Scene.generate("rooms", scale=0.1).path_view(3)]
    for at, view in enumerate(views):
        again = pickle.loads(pickle.dumps(view))
        assert again == view == copy.deepcopy(view) and hash(again) == hash(view) and view.eye == again.eye
        assert [other == again for other in views] == [at == i for i in range(len(views))]
        assert np.array_equal(casca.Query().run(scene, view), casca.Query().run(scene, again))
        assert len({*views, again}) == len(views)
    sees = lambda view: casca.exact_visible(scene, view, width=160, height=90)
    carried = scene.view((1054.5, 10, 23), camera)
    assert np.array_equal(sees(pickle.loads(pickle.dumps(carried))), sees(carried))
    assert camera.with_layers(9).with_layers(7) == camera.with_layers(7) and camera != camera.with_layers(7)
    assert camera != 3 and camera != camera.eye
    zeros = [casca.View.omnidirectional((zero, 1, zero)) for zero in (0.0, -0.0)]
    assert zeros[0] == zeros[1] and hash(zeros[0]) == hash(zeros[1])
    for wrong in ([], [("camera", [1.0] * 34)], [("reach", [1.0])], [("omnidirectional", [np.nan] * 3)], [("x", [])]):
        with pytest.raises(casca.Error):
            casca.View._made(wrong)


def test_sight_answers_about_anything():
    scene = room()
    scene.insert_boxes([[(1, 1, 30), (63, 31, 32)]], occludes=True)
    query = casca.Query()
    with pytest.raises(casca.Error, match="has not run"):
        query.may_see_points(scene, [(0, 0, 0)])
    query.run(scene, casca.View.look_at((32, 16, 2), (32, 16, 40)))
    boxes = [[(30, 15, 20), (31, 16, 21)], [(30, 15, 40), (31, 16, 41)], [(30, 15, 0), (31, 16, 1)]]
    assert list(query.may_see_boxes(scene, boxes)) == [True, False, False]
    assert list(query.may_see_points(scene, [(32, 16, 20), (32, 16, 40)])) == [True, False]


def test_shadow_casters():
    scene = room()
    (ground,) = scene.insert_boxes([[(0, 0, 0), (64, 1, 64)]], occludes=True)
    (tower,) = scene.insert_boxes([[(28, 1, 58), (36, 30, 60)]], occludes=True)
    query = casca.Query()
    assert tower not in query.run(scene, casca.View.look_at((32, 3, 50), (32, 1, 30)))
    assert tower in query.shadow_casters(scene, direction=(0, -1, -1))
    assert tower not in query.shadow_casters(scene, position=(32, 5, 40), reach=10)
    for wrong in ({}, {"direction": (0, 1, 0), "position": (0, 0, 0)}, {"direction": (0, 0, 0)}):
        with pytest.raises(casca.Error):
            query.shadow_casters(scene, **wrong)


@pytest.mark.parametrize("threads", [1, 2, 5, None])
def test_many_views_are_single_runs(threads):
    scene = casca.Scene.generate("rooms", scale=0.2)
    views = [scene.path_view(frame) for frame in range(0, scene.path_length, 7)]
    sets = casca.run_many(scene, views, threads=threads)
    assert len(sets) == len(views)
    for view, found in zip(views, sets, strict=True):
        assert (casca.Query().run(scene, view) == found).all()


def test_threads_share_a_scene():
    scene = casca.Scene.generate("spheres", scale=0.3)
    view = scene.path_view(0)
    expected = casca.Query().run(scene, view)
    wrong = []

    def work():
        query = casca.Query()
        for _ in range(20):
            if (query.run(scene, view) != expected).any():
                wrong.append(1)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_generated_scenes_and_progress():
    shares = []
    scene = casca.Scene.generate("city", scale=0.2, progress=shares.append)
    assert shares and shares == sorted(shares) and shares[-1] == 1.0
    assert len(scene) == len(shares) and "objects" in repr(scene)
    again = casca.Scene.generate("city", scale=0.2)
    assert (again.boxes() == scene.boxes()).all()

    def stop(share):
        raise KeyError(share)

    with pytest.raises(KeyError):
        casca.Scene.generate("city", scale=0.2, progress=stop)
    with pytest.raises(KeyError):
        casca.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], progress=stop)


def test_results_outlive_what_made_them():
    scene, *_ = town(1)
    query = casca.Query()
    seen = query.run(scene, casca.View.look_at((30, 10, 30), (40, 9, 36)))
    before = seen.copy()
    query.run(scene, casca.View.look_at((2, 10, 2), (40, 9, 36)))
    del scene, query
    gc.collect()
    assert (seen == before).all()


def test_the_documentation_is_true():
    import doctest

    result = doctest.testmod(casca)
    assert result.attempted > 5 and result.failed == 0
