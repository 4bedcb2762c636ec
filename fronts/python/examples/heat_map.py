"""How much each place of a level sees: a map from above.

python examples/heat_map.py [--scene rooms] [--file level.glb] [--step 1.0] [--out heat.png]

A place counts the objects that can be seen from it in any direction. "#" in the map that is printed
sees most. Cost: a query for each place, on all cores.
"""

import argparse

import casca
import numpy as np

SHADES = " .:-=+*%#"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="rooms", choices=casca.SCENES)
    parser.add_argument("--scale", type=float, default=0.2, help="the share of the scene's objects")
    parser.add_argument("--file", help="a glTF file in the place of a generated scene")
    parser.add_argument("--places", type=int, default=60, help="places along the longer side")
    parser.add_argument("--height", type=float, help="of the eyes, in world units; that of the path if none")
    parser.add_argument("--out", help="a picture of the map; needs matplotlib")
    given = parser.parse_args()
    if given.file:
        scene = casca.Scene.from_gltf(given.file)
    else:
        scene = casca.Scene.generate(given.scene, scale=given.scale)
    low, high = scene.boxes().min(axis=(0, 1)), scene.boxes().max(axis=(0, 1))
    height = scene.path_view(0).eye[1] if given.height is None else given.height
    step = (high - low)[[0, 2]].max() / given.places
    xs, zs = np.arange(low[0] + step / 2, high[0], step), np.arange(low[2] + step / 2, high[2], step)
    eyes = [(x, height, z) for z in zs for x in xs]
    sets = casca.run_many(scene, [casca.View.omnidirectional(eye) for eye in eyes], preset="fast")
    seen = np.array([len(ids) for ids in sets]).reshape(len(zs), len(xs))

    print(f"{scene}: {len(eyes)} places see {seen.min()} to {seen.max()} objects, {seen.mean():.0f} in the mean")
    shades = (seen / max(seen.max(), 1) * (len(SHADES) - 1)).astype(int)
    # Letters are about twice as high as wide.
    for row in shades[::2]:
        print("".join(SHADES[shade] for shade in row))
    if given.out:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        figure, axes = pyplot.subplots(figsize=(8, 6), layout="constrained")
        image = axes.imshow(seen, extent=(low[0], high[0], high[2], low[2]), cmap="magma")
        figure.colorbar(image, label="objects that can be seen from there, in any direction")
        axes.set(xlabel="x", ylabel="z", title=f"{scene}, eyes at height {height:.1f}")
        figure.savefig(given.out, dpi=150)


if __name__ == "__main__":
    main()
