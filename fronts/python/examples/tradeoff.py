"""Speed against accuracy of all methods and presets: a chart, and its table.

python examples/tradeoff.py [--scene rooms] [--file level.glb] [--views 12] [--out tradeoff.png]
"""

import argparse
import time

import casca
import numpy as np

WAYS = {
    "frustum": dict(method="frustum"),
    "cell": dict(method="cell"),
    "point, fast": dict(preset="fast"),
    "point, balanced": dict(preset="balanced"),
    "point, tight": dict(preset="tight"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="rooms", choices=casca.SCENES)
    parser.add_argument("--scale", type=float, default=0.5, help="the share of the scene's objects")
    parser.add_argument("--file", help="a glTF file in the place of a generated scene")
    parser.add_argument("--views", type=int, default=12)
    parser.add_argument("--out", help="a picture of the chart; needs matplotlib")
    given = parser.parse_args()
    if given.file:
        scene = casca.Scene.from_gltf(given.file)
    else:
        scene = casca.Scene.generate(given.scene, scale=given.scale)
    frames = np.linspace(0, scene.path_length - 1, given.views).astype(int)
    views = [scene.path_view(int(frame)) for frame in frames]
    exact = [set(casca.exact_visible(scene, view, width=960, height=540)) for view in views]
    seen = sum(map(len, exact))

    rows = []
    for name, how in WAYS.items():
        query = casca.Query(**how)
        took, found, lost = [], 0, 0
        for view, truth in zip(views, exact, strict=True):
            times = []
            for _ in range(5):
                start = time.perf_counter()
                ids = query.run(scene, view)
                times.append(1e3 * (time.perf_counter() - start))
            took.append(min(times))
            found += len(ids)
            lost += len(truth - set(ids))
        rows.append((name, np.median(took), found / max(seen, 1), lost))

    print(f"{scene}, {len(views)} views, {seen / len(views):.0f} objects visible in the mean")
    print("| method | ms, median | set by exact set | visible objects lost |")
    print("|---|---|---|---|")
    for name, took, ratio, lost in rows:
        print(f"| {name} | {took:.3f} | {ratio:.2f} | {lost} |")
    if given.out:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot, ticker

        figure, axes = pyplot.subplots(figsize=(7, 4.5), layout="constrained")
        for i, (name, took, ratio, _) in enumerate(rows):
            axes.plot(took, ratio, "o")
            # Points near each other have names above and below.
            axes.annotate(name, (took, ratio), xytext=(6, 6 - 16 * (i % 2)), textcoords="offset points")
        axes.axhline(1, color="grey", linewidth=1)
        axes.annotate("exact", (axes.get_xlim()[0], 1), xytext=(4, 3), textcoords="offset points", color="grey")
        axes.set(xscale="log", yscale="log", ylim=(0.9, 1.1 * max(row[2] for row in rows)))
        axes.set(xlabel="milliseconds a query", ylabel="objects in the set for each visible one")
        axes.margins(x=0.2)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(ticker.NullFormatter())
        axes.set_yticks([1, 2, 4, 8][: 1 + int(np.log2(axes.get_ylim()[1]))])
        axes.set_title(f"{scene}: lower is tighter, left is faster", fontsize=10)
        figure.savefig(given.out, dpi=150)


if __name__ == "__main__":
    main()
