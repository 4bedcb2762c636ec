"""What arguments may be: any array or list of the shape; all else is refused by its name."""

import array
import os
import pathlib
import re

import casca
import numpy as np
import pytest
from casca import lines, plane, points
from conftest import floors

BOXES = np.array([[[1, 1, 1], [2, 2, 2]], [[3, 3, 3], [4, 5, 6]]], np.float32)
EYE, TARGET = (0, 0, 9), (0, 0, 0)


@pytest.fixture
def scene():
    return casca.Scene(1.0)


def calls():
    """For each array of the package: its name, a good value, and what comes of another one."""
    scene, other = casca.Scene(1.0), casca.Scene(1.0)
    corners, faces = np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.uint32)
    mesh, unit = casca.Mesh(corners, faces), np.eye(4, dtype=np.float32)[None]
    boxes, balls = scene.insert_boxes(BOXES), scene.insert_spheres([[5, 5, 5, 1]])
    placed = scene.insert_meshes(mesh, unit)
    query, frustum = casca.Query(), casca.Query("frustum")
    query.run(scene, casca.View.look_at(EYE, (1, 1, 1)))
    ball, three = np.array([[5, 5, 5, 1]], np.float32), np.arange(1, 4, dtype=np.float32)
    flat = np.diag([1, 1, -1, 1]).astype(np.float32)
    deep = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, -0.1], [0, 0, -1, 0]], np.float32)
    wall, floor = np.array([[[1, 0], [1, 1]]], np.float32), floors()
    bake = lambda **given: casca.bake.Bake("a.glb", content=floor, **({"cell": 3.0, "height": (0.5, 2), "queries": 4} | given))
    inserted = lambda ids: other.boxes(ids)
    moved = lambda done, ids: scene.boxes(ids)
    seen = lambda view: frustum.run(scene, view)
    return [
        ("boxes", BOXES, lambda x: inserted(other.insert_boxes(x))),
        ("boxes", BOXES, lambda x: moved(scene.update_boxes(boxes, x), boxes)),
        ("boxes", BOXES, lambda x: query.may_see_boxes(scene, x)),
        ("spheres", ball, lambda x: inserted(other.insert_spheres(x))),
        ("spheres", ball, lambda x: moved(scene.update_spheres(balls, x), balls)),
        ("transforms", unit, lambda x: inserted(other.insert_meshes(mesh, x))),
        ("transforms", unit, lambda x: moved(scene.set_transforms(placed, x), placed)),
        ("ids", boxes, lambda x: scene.update_boxes(x, BOXES)),
        ("ids", balls, lambda x: scene.update_spheres(x, ball)),
        ("ids", placed, lambda x: scene.set_transforms(x, unit)),
        ("ids", boxes, scene.boxes),
        ("ids", boxes, scene.occluders),
        ("positions", corners, lambda x: inserted(other.insert_meshes(casca.Mesh(x, faces), unit))),
        ("triangles", faces, lambda x: len(casca.Mesh(corners, x))),
        ("points", corners, lambda x: query.may_see_points(scene, x)),
        ("points", corners, lambda x: points.hidden_point_removal(x, EYE)),
        ("points", corners, lambda x: points.splat_visible(x, EYE, TARGET)),
        ("eye", three, lambda x: seen(casca.View.look_at(x, TARGET))),
        ("target", three, lambda x: seen(casca.View.look_at(EYE, x))),
        ("eye", 0 * three, lambda x: seen(casca.View.perspective(x, deep))),
        ("eye", three, lambda x: casca.View.omnidirectional(x).eye),
        ("forward", -three, lambda x: seen(casca.View.orthographic(x, flat))),
        ("matrix", flat, lambda x: seen(casca.View.orthographic((0, 0, -1), x))),
        ("direction", -three, lambda x: query.shadow_casters(scene, direction=x)),
        ("position", three, lambda x: query.shadow_casters(scene, position=x)),
        ("eye", three, lambda x: points.hidden_point_removal(corners, x)),
        ("eye", three, lambda x: points.splat_visible(corners, x, TARGET)),
        ("target", three, lambda x: points.splat_visible(corners, EYE, x)),
        ("eye", three[:2], lambda x: plane.field_of_view(np.zeros((4, 4), bool), x)),
        ("direction", three[:2], lambda x: plane.field_of_view([[0]], (0.5, 0.5), direction=x, half_angle=1)),
        ("walls", np.eye(4, dtype=bool), lambda x: plane.field_of_view(x, (1, 2))),
        ("walls", wall, lambda x: plane.visible_region(x, (0, 0), 9)),
        ("eye", three[:2], lambda x: plane.visible_region(wall, x, 9)),
        ("within", np.array([[0, 0, 0], [9, 2, 9]], np.float32), lambda x: bake(within=x).cells),
        ("height", np.array([0.5, 2.0], np.float32), lambda x: bake(height=x).cells),
        ("cells", np.arange(2, dtype=np.uint32), bake().find),
    ]


CALLS = calls()
each_call = pytest.mark.parametrize(("name", "good", "call"), CALLS, ids=[name for name, _, _ in CALLS])
OPTIONAL = ("ids", "direction", "position", "within", "height")


@each_call
def test_any_array_or_list_of_the_shape_is_taken(name, good, call):
    wanted = call(good)
    spread = np.zeros((*good.shape, 2), good.dtype)
    spread[..., 0] = good
    locked = good.copy()
    locked.setflags(write=False)
    forms = [good.tolist(), tuple(good.tolist()), list(good), spread[..., 0], locked, np.asfortranarray(good)]
    forms += [good[::-1].copy()[::-1], good.astype(good.dtype.newbyteorder()), good.view(np.recarray)]
    forms += [good.astype(kind) for kind in {"f": "dg", "u": "QqHb", "b": "Bdi"}[good.dtype.kind]]
    for form in forms:
        assert np.array_equal(call(form), wanted), form


@each_call
def test_another_shape_is_refused_by_name(name, good, call):
    for wrong in (good[None], good[..., :-1], np.zeros((4, 3, 7), good.dtype)):
        if name in ("ids", "cells") and wrong.ndim == 1 or name == "walls" and wrong.ndim == good.ndim == 2:
            continue
        with pytest.raises(casca.Error) as raised:
            call(wrong)
        said = str(raised.value)
        assert said.startswith(f"{name} must have shape (") and f"; got shape {wrong.shape} of {wrong.dtype}" in said
    with pytest.raises((casca.Error, TypeError), match=f"^{name} must have shape"):
        call([[1, 2], [3]])


@each_call
def test_another_type_is_refused_by_name(name, good, call):
    wrong = [good.astype(kind) for kind in ("U", "O", "F")]
    wrong += ["abc", b"abc", 7j, 3, object(), {1, 2}, {"a": 1}, (n for n in range(3)), casca]
    wrong += [] if name in OPTIONAL else [None]
    wrong += [good.astype(bool)] if good.dtype != bool else []
    if good.dtype.kind == "u":
        wrong += [good.astype(float), good.astype(float).tolist(), good.astype(bool).tolist()]
    for one in wrong:
        with pytest.raises(TypeError) as raised:
            call(one)
        said = str(raised.value)
        assert said.startswith(f"{name} must have shape (") and "; got " in said, said


@each_call
def test_numbers_that_are_not_finite_are_named(name, good, call):
    if good.dtype.kind != "f":
        return
    last = ", ".join(str(side - 1) for side in good.shape)
    for value, why in ((np.nan, "NaN, but"), (np.inf, "inf, but"), (1e300, "1e300, which is too large for float32")):
        bad = good.astype(np.float64)
        bad[(-1,) * bad.ndim] = value
        for form in (bad, bad.tolist(), np.asfortranarray(bad)):
            try:
                answer = call(form)
            except casca.Error as raised:
                assert value == 1e300 or f"{name}[{last}] is {why}" in str(raised)
            else:
                # In doubt a thing may be seen. Some numbers are read in double precision.
                assert np.array_equal(answer, np.ones(len(good))) or value == 1e300 and name in ("points", "eye")


def test_masked_arrays_are_refused(scene):
    with pytest.raises(casca.Error, match="boxes has entries that are masked"):
        scene.insert_boxes(np.ma.masked_greater(BOXES, 5))
    assert len(scene.insert_boxes(np.ma.masked_greater(BOXES, 50))) == 2


def test_nothing_is_an_empty_array(scene):
    ids = scene.insert_boxes([])
    assert ids.dtype == np.uint64 and len(ids) == 0
    scene.update_boxes([], np.zeros((0, 2, 3)))
    scene.set_transforms((), [])
    scene.remove([])
    assert scene.boxes([]).shape == (0, 2, 3) and scene.occluders(np.array([])).shape == (0,)
    assert plane.visible_region([], (0, 0), 1).shape[1] == 2
    assert len(points.hidden_point_removal([], EYE)) == 0


def test_ids_are_integers_of_the_scene(scene):
    ids = scene.insert_boxes(BOXES, occludes=True)
    ways = (scene.remove, scene.boxes, scene.occluders, lambda x: scene.update_boxes(x, BOXES))
    for wrong, why in (
        ([-1], r"ids\[0\] is -1, but must lie between 0 and 18446744073709551615"),
        ([ids[0], -(2**70)], r"ids\[1\] is -1180591620717411303424, but"),
        ([2**64], r"ids\[0\] is 18446744073709551616, but"),
        (np.array([0, -7], np.int8), r"ids\[1\] is -7, but"),
        ([ids[1], 12345], r"ids\[1\] is 12345, which names no object"),
        (np.array([2**32], np.uint64), r"ids\[0\] is 4294967296, which names no object"),
    ):
        for way in ways:
            with pytest.raises(casca.Error, match=why):
                way(wrong)
    for wrong in ([0.0], [0, 1.5], [True], [0, np.True_], np.array([0, 1], object), np.array([0.0]), ["0"], [None], 0):
        for way in ways:
            with pytest.raises(TypeError, match="ids must have shape"):
                way(wrong)
    # Integers of two types: numpy makes floats of them.
    assert scene.boxes([ids[1], 0]).shape == (2, 2, 3)
    assert scene.boxes(array.array("Q", ids)).shape == scene.boxes(range(2)).shape == (2, 2, 3)
    with pytest.raises(casca.Error, match=r"ids\[2\] comes twice"):
        scene.remove([*ids, ids[0]])
    assert len(scene) == 2 and scene.occluders().all()
    scene.remove(ids[:1])
    (new,) = scene.insert_boxes(BOXES[:1])
    assert new != ids[0] and new in scene and ids[0] not in scene
    with pytest.raises(casca.Error, match="names no object"):
        scene.boxes(ids[:1])
    assert -1 not in scene and 2**64 not in scene
    for wrong in (1.0, True, "1"):
        with pytest.raises(TypeError):
            wrong in scene  # noqa: B015


def test_indices_are_integers():
    corners = np.eye(3)
    for wrong in ([(0, 1, -1)], [(0, 1, 2**32)], np.array([[0, 1, -3]], np.int16)):
        with pytest.raises(casca.Error, match=r"triangles\[0, 2\] is"):
            casca.Mesh(corners, wrong)
    for wrong in ([(0, 1, 2.0)], np.array([[0, 1, 2.5]]), [(0, True, 2)]):
        with pytest.raises(TypeError, match="triangles"):
            casca.Mesh(corners, wrong)


class Index:
    def __index__(self):
        return 3


def whole():
    """For each integer that the package takes: its name, a call with it, and whether 0 is one."""
    scene, floor = casca.Scene(1.0), floors()
    path = casca.Scene.generate("spheres", scale=0.02)
    options = {"content": floor, "cell": 3.0, "height": (0.5, 2)}
    bake = casca.bake.Bake("a.glb", queries=4, **options)
    two, look = ([(0, 0, 0), (1, 0, 0)], [0, 2]), ((0, 0, 4), (0, 0, 0))
    view, mesh = casca.View.look_at(EYE, TARGET), casca.Mesh(np.eye(3), [(0, 1, 2)])
    sides = {"width": 8, "height": 8}
    calls = [
        ("queries", lambda n: casca.bake.Bake("a.glb", queries=n, **options), True),
        ("threads", lambda n: bake.find([0], threads=n), False),
        ("threads", lambda n: bake.write("/dev/full/out", threads=n), True),
        ("threads", lambda n: casca.run_many(scene, [view], threads=n), False),
        ("seed", lambda n: casca.Scene.generate("spheres", scale=0.01, seed=n), True),
        ("layers", lambda n: scene.insert_boxes(BOXES, layers=n), True),
        ("layers", lambda n: scene.insert_spheres([[5, 5, 5, 1]], layers=n), True),
        ("layers", lambda n: scene.insert_meshes(mesh, np.eye(4)[None], layers=n), True),
        ("mask", view.with_layers, True),
        ("frame", path.path_view, True),
        ("rays", lambda n: lines.ambient_occlusion(*two, rays=n), False),
        ("rays", lambda n: lines.picture(*two, *look, rays=n, **sides), False),
        ("cells_per_task", lambda n: casca.bake.on_dask(Nobody, "rooms", "out", cells_per_task=n, cell=40.0), False),
    ]
    for side in sides:
        calls += [
            (side, lambda n, side=side: casca.exact_visible(scene, view, **(sides | {side: n})), False),
            (side, lambda n, side=side: lines.picture(*two, *look, **(sides | {side: n})), False),
            (side, lambda n, side=side: points.splat_visible(np.eye(3), EYE, TARGET, radius=1, **(sides | {side: n})), False),
        ]
    return calls


class Nobody:
    """A client that has no workers."""

    def submit(*given, **named):
        raise OSError("there is nobody")


@pytest.mark.parametrize(("name", "call", "zero"), [pytest.param(*one, id=one[0]) for one in whole()])
def test_integers_are_checked(name, call, zero):
    for wrong in (1.0, np.float32(1), True, np.True_, "1", [1], 1j, object()):
        with pytest.raises(TypeError, match=f"^{name} must be an integer, not a {type(wrong).__name__}"):
            call(wrong)
    for wrong in (-1, 2**64, 2**64 + 3, -(2**64) + 3, 10**400, np.int8(-3), *([] if zero else [0])):
        if name == "cells_per_task" and wrong > 0:
            continue
        with pytest.raises(casca.Error, match=rf"^{name} must .*, not {int(wrong)}"):
            call(wrong)
    for good in (3, np.uint8(3), np.int64(3), Index()):
        try:
            call(good)
        except OSError:
            pass


def test_a_box_around_a_mesh_does_not_hide(scene):
    mesh = casca.Mesh(np.eye(3), [(0, 1, 2)])
    (placed,) = scene.insert_meshes(mesh, np.eye(4)[None])
    (solid,) = scene.insert_boxes(BOXES[:1], occludes=True)
    assert scene.occluders().all()
    scene.update_boxes([placed, solid], BOXES)
    assert scene.occluders([placed, solid]).tolist() == [False, True]


def test_a_place_is_looked_up_in_double_precision(level, tmp_path):
    casca.bake.Bake(level, cell=3.0, height=(0.5, 2), queries=4).write(tmp_path / "cells.pvs")
    baked = casca.bake.Baked(tmp_path / "cells.pvs")
    low, size = np.array(baked.low), np.array(baked.size)
    edges = [(axis, low[axis] + side * baked.dims[axis] * size[axis], side) for axis in range(3) for side in (0, 1)]
    tried = 0
    for axis, edge, side in edges:
        place = low + 0.5 * size * (baked.dims if axis != 1 else 1)
        place[axis] = np.nextafter(edge, -np.inf if side else np.inf)
        if baked.at(place) is not None and baked.at(place.astype(np.float32)) is None:
            tried += 1
            assert baked.may_see([place, place], [place, place])
    assert tried > 0


def test_paths_of_all_kinds(level, tmp_path):
    class Place:
        def __init__(self, name):
            self.name = name

        def __fspath__(self):
            return str(tmp_path / self.name)

    (tmp_path / "level.glb").write_bytes(level.read_bytes())
    options = {"cell": 3.0, "height": [0.5, 2], "within": [(0, 0, 0), (9, 2, 9)], "queries": 4}
    written = set()
    # Names of files need not be text.
    bytes_of_no_text = lambda name: tmp_path / (os.fsdecode(b"\xff") + pathlib.Path(name).name)
    bytes_of_no_text("level.glb").write_bytes(level.read_bytes())
    for way in (str, pathlib.Path, lambda name: Place(pathlib.Path(name).name), bytes_of_no_text):
        bake = casca.bake.Bake(way(tmp_path / "level.glb"), **options)
        bake.write(way(tmp_path / "out"))
        assert len(casca.bake.Baked(way(tmp_path / "out"))) == len(bake) > 0
        merge = casca.bake.Merge()
        merge.put(bake.find(bake.cells))
        merge.write(way(tmp_path / "merged"))
        assert len(casca.Scene.from_gltf(way(tmp_path / "level.glb"))) == 3
        written |= {(tmp_path / name).read_bytes() for name in ("out", "merged")}
    assert len(written) == 1
    assert len(casca.bake.Bake(pathlib.Path("rooms"), cell=40.0, queries=1)) > 0
    for way in (casca.bake.Bake, casca.bake.Baked, casca.Scene.from_gltf):
        with pytest.raises(OSError, match=re.escape(str(tmp_path / "none.glb"))):
            way(tmp_path / "none.glb")
        for wrong in (7, None, ["rooms"]):
            with pytest.raises(TypeError):
                way(wrong)


def garbage(rng, good):
    """A good value with something wrong, mostly."""
    numbers = [0, 1, -1, 0.5, 1e-40, 1e30, 3e38, 1e300, np.nan, np.inf, -np.inf, 2**31, 2**32, 2**63, 2**64, 10**400]
    pick = lambda options: options[rng.integers(len(options))]
    if rng.random() < 0.1:
        return pick([*numbers, True, None, "", "rooms", b"x", [], {}, [[]], object(), casca.Query(), np.ma.masked])
    made = np.resize(good, (rng.integers(5), *good.shape[1:])) if rng.random() < 0.5 else good
    made = made.astype(object)
    if made.size and rng.random() < 0.7:
        made.flat[rng.integers(made.size)] = pick(numbers)
    try:
        made = made.astype(pick([good.dtype, good.dtype, "f8", "f2", "i8", "u1", "U3", object]))
    except (OverflowError, ValueError, TypeError):
        pass
    return pick([made, made.tolist(), made.T, made[::-1]])


@pytest.mark.filterwarnings("ignore")
def test_garbage_raises_and_never_panics():
    rng, taken = np.random.default_rng(12), 0
    for _ in range(40):
        for name, good, call in CALLS:
            try:
                call(garbage(rng, good))
                taken += 1
            except (TypeError, ValueError):
                pass
    assert 300 < taken < 40 * len(CALLS) - 300
