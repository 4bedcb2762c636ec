"""Hidden point removal side by side: casca-points, Open3D and qhull (scipy), on the same points, in turns.

    pip install numpy scipy open3d
    cargo build --release -p casca-lab --features experiments --bin points-compare
    python sisters/points/compare/compare.py target/release/points-compare

Prints a table: the median seconds of each, the ratio to casca-points, and how many points have another answer than by
casca-points. Each method gets doubles relative to the eye and returns the indices of visible points; reading the points is not timed.
casca-points answers in exact arithmetic. Options: points, rounds, CSV file.
"""

import argparse
import csv
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy as np
from scipy.spatial import ConvexHull

try:
    import open3d
except ImportError as why:
    open3d = None
    print(f"skipped: Open3D cannot be loaded ({why})")

LOG10_RADIUS = 3.0


def by_open3d(points):
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
    radius = np.linalg.norm(points, axis=1).max() * 10**LOG10_RADIUS
    start = time.perf_counter()
    _, visible = cloud.hidden_point_removal([0.0, 0.0, 0.0], radius)
    return time.perf_counter() - start, np.asarray(visible)


def by_qhull(points):
    start = time.perf_counter()
    length = np.linalg.norm(points, axis=1)[:, None]
    radius = length.max() * 10**LOG10_RADIUS
    flipped = points + 2 * (radius - length) * points / length
    hull = ConvexHull(np.vstack([flipped, [0.0, 0.0, 0.0]]))
    visible = hull.vertices[hull.vertices < len(points)]
    return time.perf_counter() - start, visible


def by_casca(program, file, folder):
    answer = folder / "answer"
    told = subprocess.run([program, "time", file, str(LOG10_RADIUS), answer], check=True, capture_output=True, text=True)
    return float(told.stdout), np.flatnonzero(np.fromfile(answer, dtype=np.uint8))


def measure(program, name, count, rounds, folder):
    file = folder / f"{name}.f64"
    subprocess.run([program, "cloud", name, str(count), file], check=True)
    points = np.fromfile(file, dtype="<f8").reshape(-1, 3)
    methods = {"casca-points": lambda: by_casca(program, file, folder), "qhull (scipy)": lambda: by_qhull(points)}
    if open3d:
        methods["Open3D"] = lambda: by_open3d(points)
    times, answers = {m: [] for m in methods}, {}
    for _ in range(rounds):
        for method, run in methods.items():
            seconds, answers[method] = run()
            times[method].append(seconds)
    ours = statistics.median(times["casca-points"])
    for method in methods:
        seconds = statistics.median(times[method])
        other = len(np.setxor1d(answers[method], answers["casca-points"]))
        yield [name, len(points), method, f"{seconds:.3f}", f"{seconds / ours:.2f}", len(answers[method]), other]


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("program")
    options.add_argument("--points", type=int, default=1_000_000)
    options.add_argument("--rounds", type=int, default=5)
    options.add_argument("--csv", type=pathlib.Path)
    given = options.parse_args()
    rows = [["cloud", "points", "method", "median s", "times casca-points", "found visible", "other answers"]]
    with tempfile.TemporaryDirectory() as folder:
        for name in ["sphere", "hare", "scan", "facade", "terrain", "torus", "copies"]:
            rows += measure(given.program, name, given.points, given.rounds, pathlib.Path(folder))
    for row in rows:
        print("".join(str(cell).ljust(20) for cell in row))
    if given.csv:
        with given.csv.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    main()
