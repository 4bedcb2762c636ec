"""What a call from Python costs beside the work itself: nanoseconds a call, and an entry of an array.

python examples/border.py
"""

import time

import casca
import numpy as np


def best(call, repeats=200):
    """Nanoseconds of the fastest of some calls."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter_ns()
        call()
        times.append(time.perf_counter_ns() - start)
    return min(times)


def main():
    n = 100_000
    scene = casca.Scene(1.0)
    rng = np.random.default_rng(1)
    spheres = np.hstack([rng.uniform(1, 99, (n, 3)), np.full((n, 1), 0.1)]).astype(np.float32)
    ids = scene.insert_spheres(spheres, moves=True)
    empty, away = casca.Scene(1.0), casca.View.omnidirectional((1, 1, 1))
    query = casca.Query("frustum")
    print("| call | ns | ns an entry |\n|---|---|---|")
    rows = [
        ("len(scene)", lambda: len(scene), 0),
        ("query of an empty scene", lambda: query.run(empty, away), 0),
        ("view.look_at", lambda: casca.View.look_at((0, 0, 0), (0, 0, 1)), 0),
        ("ids of 100,000 objects", lambda: scene.ids, n),
        ("boxes of 100,000 objects", lambda: scene.boxes(ids), n),
        ("update_spheres, float32", lambda: scene.update_spheres(ids, spheres), n),
        ("update_spheres, float64", lambda: scene.update_spheres(ids, spheres.astype(float)), n),
    ]
    for name, call, entries in rows:
        took = best(call, 20 if entries else 2000)
        print(f"| {name} | {took:,} | {took / entries if entries else 0:.0f} |")


if __name__ == "__main__":
    main()
