"""One clear exception for each wrong call, and nothing half done."""

import pickle

import casca
import numpy as np
import pytest


@pytest.fixture
def scene():
    return casca.Scene(1.0)


@pytest.mark.parametrize(
    ("boxes", "why"),
    [
        (np.zeros((4, 3, 2)), r"boxes must have shape \(n, 2, 3\): .*; got shape \(4, 3, 2\) of float64"),
        ([[(1, 1, 1), (0, 0, 0)]], "entry 0: .*inverted"),
        ([[(0, 0, 0), (1, 1, 1)], [(0, 0, 0), (1, np.nan, 1)]], r"boxes\[1, 1, 1\] is NaN, .*finite"),
        ([[(0, 0, 0), (1, np.inf, 1)]], r"boxes\[0, 1, 1\] is inf, .*finite"),
    ],
)
def test_boxes(scene, boxes, why):
    with pytest.raises(casca.Error, match=why):
        scene.insert_boxes(boxes)
    assert len(scene) == 0


def test_arrays_that_are_none(scene):
    for wrong in ("boxes", None, [[[1, 2], [3, 4]], [[1, 2]]], np.zeros(3), object()):
        with pytest.raises((TypeError, ValueError)):
            scene.insert_boxes(wrong)
    with pytest.raises(casca.Error, match=r"\(n, 4\)"):
        scene.insert_spheres(np.zeros((2, 3)))
    with pytest.raises(casca.Error, match="negative"):
        scene.insert_spheres([(0, 0, 0, -1)])
    assert len(scene) == 0
    assert len(scene.insert_boxes(np.zeros((0, 2, 3)))) == 0


def test_ids(scene):
    (one,) = scene.insert_boxes([[(1, 1, 1), (2, 2, 2)]])
    other = casca.Scene(1.0)
    for wrong in ([one + 1], [2**64 - 1], [0, one, 12345]):
        with pytest.raises(casca.Error):
            scene.remove(wrong)
    with pytest.raises(casca.Error):
        other.boxes([one + 7])
    with pytest.raises(casca.Error, match="1 ids do not fit 2 shapes"):
        scene.update_boxes([one], np.zeros((2, 2, 3)))
    with pytest.raises((TypeError, ValueError, OverflowError)):
        scene.remove([-1])
    assert one in scene and len(scene) == 1


def test_meshes(scene):
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    for positions, triangles in (
        ([], []),
        (corners, [(0, 1, 3)]),
        ([(0, 0, 0), (1, 0, np.nan), (0, 1, 0)], [(0, 1, 2)]),
        (np.zeros((3, 2)), [(0, 1, 2)]),
        (corners, [(0, 1)]),
    ):
        with pytest.raises((ValueError, TypeError)):
            casca.Mesh(positions, triangles)
    mesh = casca.Mesh(corners, [(0, 1, 2)])
    wrong = np.eye(4)
    wrong[3, 0] = 1
    with pytest.raises(casca.Error, match="last row"):
        scene.insert_meshes(mesh, wrong[None])
    with pytest.raises(casca.Error):
        scene.insert_meshes(mesh, np.stack([np.eye(4), np.full((4, 4), np.nan)]))
    with pytest.raises(casca.Error):
        scene.insert_meshes(mesh, np.zeros((1, 3, 4)))
    assert len(scene) == 0
    (ball,) = scene.insert_spheres([(1, 1, 1, 1)])
    with pytest.raises(casca.Error):
        scene.set_transforms([ball], np.eye(4)[None])


def test_views():
    look = casca.View.look_at
    for wrong in (
        lambda: look((0, 0, 0), (0, 0, 0)),
        lambda: look((0, 0, np.nan), (0, 0, 1)),
        lambda: look((0, 0), (0, 0, 1)),
        lambda: look((0, 0, 0), (0, 0, 1), fov_y=180),
        lambda: look((0, 0, 0), (0, 0, 1), aspect=0),
        lambda: look((0, 0, 0), (0, 0, 1), near=0),
        lambda: look((0, 0, 0), (0, 0, 1), near=2, far=1),
        lambda: casca.View.perspective((0, 0, 0), np.zeros((4, 4))),
        lambda: casca.View.perspective((0, 0, 0), np.eye(3)),
        lambda: casca.View.omnidirectional((np.inf, 0, 0)),
        lambda: look((0, 0, 0), (0, 0, 1)).with_reach(-1),
        lambda: look((0, 0, 0), (0, 0, 1)).with_turn(np.nan),
    ):
        with pytest.raises(casca.Error):
            wrong()


def test_a_scene_takes_a_number():
    for wrong in (lambda: casca.Scene((0, 0, 0), (1, 1, 1), 1), lambda: casca.Scene("1")):
        with pytest.raises(TypeError, match="cell|positional"):
            wrong()


def test_queries_and_scenes(scene):
    for wrong in (
        lambda: casca.Query("rays"),
        lambda: casca.Query(preset="loose"),
        lambda: casca.Query("cell", preset="fast"),
        lambda: casca.Query(pixel_degrees=-1),
        lambda: casca.Scene(0),
        lambda: casca.Scene.generate("atlantis"),
        lambda: casca.Scene.generate("city", scale=0),
        lambda: casca.run_many(scene, [], threads=0),
        lambda: casca.run_many(scene, [], threads=10**6),
        lambda: scene.insert_boxes(np.zeros((1, 2, 3)), max_speed=1),
        lambda: scene.path_view(0),
        lambda: scene.begin_frame(np.nan),
        lambda: casca.exact_visible(scene, casca.View.omnidirectional((0, 0, 0))),
        lambda: casca.exact_visible(scene, casca.View.look_at((0, 0, 0), (0, 0, 1)), width=0),
    ):
        with pytest.raises(casca.Error):
            wrong()
    assert casca.run_many(scene, []) == []


def test_errors_travel_to_other_processes():
    why = pickle.loads(pickle.dumps(casca.Error("no")))
    assert type(why) is casca.Error and str(why) == "no" and repr(casca.Error) == "<class 'casca.Error'>"


def test_files(tmp_path):
    with pytest.raises(OSError, match="missing"):
        casca.Scene.from_gltf(tmp_path / "missing.glb")
    short = tmp_path / "short.glb"
    short.write_bytes(b"glTF\x02\0\0\0")
    with pytest.raises(casca.Error, match="short.glb"):
        casca.Scene.from_gltf(short)


def test_a_scene_in_use_is_not_changed():
    import threading

    scene = casca.Scene.generate("spheres", scale=1.0)
    view = scene.path_view(0)
    stop, refused, wrong = threading.Event(), [], []

    def read():
        query = casca.Query()
        while not stop.is_set():
            try:
                query.run(scene, view)
            except RuntimeError:
                pass
            except BaseException as why:
                wrong.append(why)

    reader = threading.Thread(target=read)
    reader.start()
    for _ in range(300):
        try:
            scene.begin_frame(0.0)
        except RuntimeError as why:
            refused.append(why)
    stop.set()
    reader.join()
    assert not wrong
    assert all("borrowed" in str(why) for why in refused)


def unaligned(array):
    """The same numbers at an odd address, as arrays have them that came over a network."""
    array = np.asarray(array)
    data = np.frombuffer(b"\0" + array.tobytes(), np.uint8)[1:]
    moved = data.view(array.dtype).reshape(array.shape)
    assert not moved.flags.aligned
    return moved


def test_arrays_at_odd_addresses(scene):
    boxes = np.array([[[1, 1, 1], [2, 2, 2]], [[3, 3, 3], [4, 4, 4]]], np.float32)
    ids = scene.insert_boxes(unaligned(boxes))
    assert np.array_equal(scene.boxes(unaligned(ids)), boxes)
    spheres = scene.insert_spheres(unaligned(np.array([[5, 5, 5, 1]], np.float32)))
    assert np.allclose(scene.boxes(spheres), [[[4, 4, 4], [6, 6, 6]]])
    corners = unaligned(np.eye(3, dtype=np.float32))
    mesh = casca.Mesh(corners, unaligned(np.array([[0, 1, 2]], np.uint32)))
    assert len(mesh) == 1
    points = np.random.default_rng(1).normal(size=(50, 3))
    seen = casca.points.hidden_point_removal(points, (9, 0, 0))
    assert np.array_equal(casca.points.hidden_point_removal(unaligned(points), (9, 0, 0)), seen)
