import os
from collections.abc import Callable
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Bake", "Baked", "Merge", "on_dask", "on_ray"]

@final
class Bake:
    """A level made ready for baking, and its cells.

    level: a .glb or .gltf file, or the name of a generated scene (see casca.SCENES). What of a file
        hides is as for Scene.from_gltf.
    cell: the edge of a cell along x and z, in metres.
    height: (2,), the least and the greatest height of an eye over the floor, in metres. Cells are as
        high as that, and only those are baked in which an eye may be so. None bakes all cells of
        the level's box, as high as they are wide.
    within: (2, 3), the lower and the upper corner of a box; of these cells, only those whose middle
        lies in it are baked.
    queries: up to about so many queries for each cell; more take longer and make smaller sets.
    grid: the edge of a cell of casca's grid, in metres.
    solid: promises that closed boxes among the parts of meshes hold no eye: then cells that reach
        into walls get smaller sets. Not for rooms that are modelled as one box.
    cell_to_cell: finds which cells of the grid may be seen from each cell, instead of which objects:
        for all that moves.
    content: the bytes of the file, if it is not to be read here.

    Raises casca.Error for cells without size or too many of them, and OSError for a file that
    cannot be read.
    """

    def __new__(
        cls,
        level: str | os.PathLike[str],
        *,
        cell: float = 2.0,
        height: ArrayLike | None = None,
        within: ArrayLike | None = None,
        queries: int = 50,
        grid: float | None = None,
        solid: bool = False,
        cell_to_cell: bool = False,
        content: bytes | None = None,
    ) -> Bake: ...
    @property
    def cells(self) -> NDArray[np.uint32]:
        """The numbers of the cells to bake, neighbours near each other. A copy."""
    @property
    def objects(self) -> int:
        """The number of objects, or of cells of the grid; those of sets are less. For a file, the
        order of its nodes."""
    def find(
        self, cells: ArrayLike, *, threads: int = 1, progress: Callable[[float], object] | None = None
    ) -> bytes:
        """The sets of some cells, (n,) integers, as the bytes of a file with these alone. Releases the
        GIL."""
    def write(
        self,
        out: str | os.PathLike[str],
        *,
        threads: int = 0,
        progress: Callable[[float], object] | None = None,
    ) -> None:
        """Finds the sets of all cells and writes the file, whole or not at all.

        A journal lies beside it meanwhile: a call that was ended goes on where it was. threads: 0
        takes all cores. Raises OSError if a file cannot be written, and casca.Error if the journal
        is of another bake.
        """
    def __len__(self) -> int: ...

@final
class Merge:
    """Puts parts together, in any order."""

    def __new__(cls) -> Merge: ...
    def put(self, part: bytes) -> None:
        """Takes the bytes that Bake.find returned. Raises casca.Error for bytes that are damaged or
        of another bake."""
    def write(self, out: str | os.PathLike[str]) -> None:
        """Writes the file, whole or not at all."""
    def __len__(self) -> int:
        """The number of cells that have a set."""

@final
class Baked:
    """A file of sets, read into memory and checked."""

    def __new__(cls, file: str | os.PathLike[str]) -> Baked: ...
    def at(self, place: ArrayLike) -> NDArray[np.uint32] | None:
        """The objects that can be seen from a place, (3,) float64, in the coordinates of the level's file,
        ascending; None if nothing is known about it: then all may be seen."""
    def cell(self, number: int) -> NDArray[np.uint32] | None:
        """The set of a cell; x runs fastest, then y. None if it has none."""
    @property
    def dims(self) -> tuple[int, int, int]:
        """Cells along x, y and z."""
    @property
    def low(self) -> tuple[float, float, float]:
        """The least corner of the grid, in metres."""
    @property
    def size(self) -> tuple[float, float, float]:
        """The edges of a cell, in metres."""
    @property
    def objects(self) -> int:
        """The number of objects, or of cells of the grid."""
    @property
    def cell_to_cell(self) -> bool:
        """Whether sets hold cells of the grid itself."""
    def may_see(self, eyes: ArrayLike, target: ArrayLike) -> bool:
        """Whether an eye in one box may see a point in another, by sets from cell to cell; (2, 3)
        float64 each, the lower and the upper corner. True in doubt."""
    def __len__(self) -> int:
        """The number of cells that have a set."""

def on_dask(
    client: Any,
    level: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    cells_per_task: int = 16,
    progress: Callable[[float], object] | None = None,
    **options: Any,
) -> None:
    """Bakes on the workers of a distributed.Client; options are those of Bake.

    A level's file travels to each worker once; other files that it names must lie where the worker
    finds them. Workers need casca. Workers may die again and again: a task is given up, by
    distributed.KilledWorker, when about ten died that had it. Writes the same bytes as Bake(level, **options).write(out).
    Tasks should take some seconds.
    """

def on_ray(
    level: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    cells_per_task: int = 16,
    progress: Callable[[float], object] | None = None,
    **options: Any,
) -> None:
    """Bakes on a Ray cluster, after ray.init; as on_dask. A task whose worker dies is done again up
    to 8 times."""
