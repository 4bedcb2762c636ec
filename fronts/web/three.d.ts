import type { Camera, Scene, WebGLRenderer } from "three";

/**
 * Draws a scene of three.js without the meshes that others hide. Pictures, shadows and mirrors stay the same.
 *
 * Call `init()` of `casca` first, then `culler.render(scene, camera)` in the place of `renderer.render(scene, camera)`. Meshes that
 * come, move, change or go are found in each frame. What hides is opaque, drawn, and no skinned, instanced or morphed mesh; what has
 * a shader of its own, no depth test or `frustumCulled = false` is never hidden. Nothing is hidden in a frame in which something visible
 * has its own `onBeforeRender` or `onAfterRender`, nor into a target without depth. Places are rounded to single precision: keep
 * scenes within some 10,000 units of the origin.
 */
export class CascaCuller {
  /**
   * @param options `cell`: the edge of casca's cells in world units, about the size of a usual mesh; by default a 256th of the
   * longest side of the scene in the first frame.
   */
  constructor(renderer: WebGLRenderer, options?: { cell?: number });
  /** How many meshes the last frame left out; those outside of the frustum count. */
  readonly hidden: number;
  /** Draws as `WebGLRenderer.render` does. */
  render(scene: Scene, camera: Camera): void;
  /** Gives memory back. */
  dispose(): void;
}
