"""Visibility culling for dynamic 3D scenes: conservative potentially visible sets.

>>> import casca
>>> scene = casca.Scene(1.0)
>>> wall = scene.insert_boxes([[[2, 2, 15], [30, 30, 17]]], occludes=True)
>>> balls = scene.insert_spheres([[16, 16, 24, 0.5], [16, 16, 5, 0.5]])
>>> view = casca.View.look_at(eye=(16, 16, 1), target=(16, 16, 20))
>>> seen = casca.Query().run(scene, view)
>>> bool(balls[0] in seen), bool(balls[1] in seen)
(False, True)

Ids are numpy arrays of ``uint64``. Any array or list of the shape is taken; contiguous arrays of
``float32`` are read where they are. Queries, scenes from files and exact visibility release the GIL.
"""

from . import bake, lines, plane, points
from ._casca import SCENES, Error, Mesh, Query, Scene, View, __version__, exact_visible, run_many

__all__ = [
    "SCENES",
    "Error",
    "Mesh",
    "Query",
    "Scene",
    "View",
    "__version__",
    "bake",
    "exact_visible",
    "lines",
    "plane",
    "points",
    "run_many",
]
