"""Visibility of a level found ahead of time, on this machine or on many.

>>> import casca
>>> bake = casca.bake.Bake("rooms", cell=10.0, height=(0.2, 2.0), within=((0, 0, 0), (10, 2, 10)), queries=16)
>>> merge = casca.bake.Merge()
>>> merge.put(bake.find(bake.cells[:2]))
>>> len(merge)
1

The file holds, for each cell, the objects that can be seen from anywhere in it: no visible one is
missing. Objects that move are in no set. ``on_dask`` and ``on_ray`` make the same bytes as
``Bake(...).write(out)``.
"""

import operator
import os
import uuid

from ._casca import Bake, Baked, Error, Merge

__all__ = ["Bake", "Baked", "Merge", "on_dask", "on_ray"]

# So often a task is done again where workers died with it, besides what a scheduler does by itself.
_RETRIES = 8

# The level that this process has made ready, by the bake that it is of: its tasks share it.
_ready = {}


def _content(level):
    """The bytes of a level's file; None for a generated one."""
    if not level.lower().endswith((".glb", ".gltf")):
        return None
    with open(level, "rb") as file:
        return file.read()


def _same(content):
    """A task: unlike data that were scattered, it can be done again where a worker died."""
    return content


def _find(bake, level, content, options, cells):
    """A task: the sets of some cells."""
    ready = _ready.get(bake)
    if ready is None:
        ready = Bake(level, content=content, **options)
        # Of one bake at a time: levels may be large.
        _ready.clear()
        _ready[bake] = ready
    return ready.find(cells)


def _parts(level, content, options, cells_per_task):
    kind = type(cells_per_task)
    if kind is bool or not hasattr(kind, "__index__"):
        raise TypeError(f"cells_per_task must be an integer, not a {kind.__name__}")
    cells_per_task = operator.index(cells_per_task)
    if cells_per_task < 1:
        raise Error(f"cells_per_task must be 1 or more, not {cells_per_task}")
    cells = Bake(level, content=content, **options).cells
    return [cells[at : at + cells_per_task] for at in range(0, len(cells), cells_per_task)]


def _merged(out, parts, count, progress):
    merge = Merge()
    for done, part in enumerate(parts, 1):
        merge.put(part)
        if progress is not None:
            progress(done / count)
    merge.write(out)


def on_dask(client, level, out, *, cells_per_task=16, progress=None, **options):
    """Bakes on the workers of a Dask client."""
    from distributed import KilledWorker, as_completed

    level = os.fspath(level)
    content = _content(level)
    parts = _parts(level, content, options, cells_per_task)
    # Of this call alone: what died with a worker must not be looked for again.
    bake = uuid.uuid4().hex
    if content is not None:
        # One worker gets it from here, the others from each other.
        content = client.submit(_same, content, pure=False)
    tasks = [client.submit(_find, bake, level, content, options, part, pure=False) for part in parts]

    def results():
        left, tries = as_completed(tasks), {}
        for task in left:
            try:
                yield task.result()
            except KilledWorker:
                # Dask gives up what was on a few workers that died, be it their fault or not.
                tries[task] = tries.get(task, 0) + 1
                if tries[task] > _RETRIES:
                    raise
                task.retry()
                left.add(task)

    try:
        _merged(out, results(), len(tasks), progress)
    finally:
        client.cancel(tasks)


def on_ray(level, out, *, cells_per_task=16, progress=None, **options):
    """Bakes on the nodes of a Ray cluster, which must be initialised."""
    import ray

    level = os.fspath(level)
    content = _content(level)
    parts = _parts(level, content, options, cells_per_task)
    # A worker that dies is replaced, and its task is done again.
    find = ray.remote(max_retries=_RETRIES)(_find)
    content = ray.put(content)
    bake = uuid.uuid4().hex
    tasks = [find.remote(bake, level, content, options, part) for part in parts]

    def results():
        left = list(tasks)
        while left:
            done, left = ray.wait(left)
            yield from ray.get(done)

    try:
        _merged(out, results(), len(tasks), progress)
    finally:
        for task in tasks:
            ray.cancel(task, force=False)
