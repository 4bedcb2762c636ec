"""How a bake grows with its workers: measures one and two, and predicts more.

    python examples/workers.py [--level rooms] [--cell 2.0] [--queries 50]

The model: a worker makes the level ready once, then each cell takes the same time. It is made from
one worker and checked with two.
"""

import argparse
import os
import tempfile
import time

import casca
import distributed


def bake(workers, level, options):
    """Seconds until the first result, seconds from then to the end, cells, bytes of the file."""
    with (
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
        ) as cluster,
        distributed.Client(cluster) as client,
        tempfile.TemporaryDirectory() as folder,
    ):
        # Workers import casca before the clock runs.
        client.run(lambda: bool(casca.bake.Merge))
        out = os.path.join(folder, "out.pvs")
        times = [time.perf_counter()]
        told = lambda share: times.append(time.perf_counter())
        casca.bake.on_dask(client, level, out, cells_per_task=8, progress=told, **options)
        with open(out, "rb") as file:
            content = file.read()
        return times[1] - times[0], times[-1] - times[1], len(times) - 1, len(casca.bake.Baked(out)), content


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--level", default="rooms")
    parser.add_argument("--cell", type=float, default=2.0)
    parser.add_argument("--queries", type=int, default=50)
    parser.add_argument("--within", type=float, default=40.0, help="metres along x and z")
    arguments = parser.parse_args()
    room = ((0, 0, 0), (arguments.within, 2, arguments.within))
    options = {
        "cell": arguments.cell, "height": (0.2, 2.0), "queries": arguments.queries, "within": room
    }
    start, rest, tasks, cells, content = bake(1, arguments.level, options)
    first = cells / tasks
    each = rest / (cells - first)
    ready = max(start - first * each, 0.0)
    print(f"{cells} cells in {tasks} tasks, {len(content) / cells:.0f} bytes a cell")
    print(f"1 worker:  {start + rest:.1f} s, {tasks / (start + rest):.2f} tasks/s, {each:.3f} s a cell")
    start, rest, tasks, cells, other = bake(2, arguments.level, options)
    assert other == content, "the bytes do not depend on the workers"
    predicted = ready + cells * each / 2
    print(f"2 workers: {start + rest:.1f} s, {tasks / (start + rest):.2f} tasks/s; predicted {predicted:.1f} s")
    world = 5000**2
    hours = (ready + world * each / 100) / 3600
    print(f"10 km x 10 km of such cells of 2 m, {world} of them, on 100 workers: {hours:.0f} hours,")
    print(f"{world * len(content) / cells / 1e9:.1f} GB")


if __name__ == "__main__":
    main()
