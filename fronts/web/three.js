// Draws a scene of three.js without the meshes that others hide.
import { BackSide, BatchedMesh, Box3, DoubleSide, LessDepth, LessEqualDepth, Material, Matrix4, NoBlending, NormalBlending, Object3D, Vector3, WebGPUCoordinateSystem } from "three";
import { KeptQuery, Mesh, Scene, View } from "./casca.js";

// What a mesh may do: nothing of ours, be hidden, hide what is behind its fronts, hide from both sides.
const [ALONE, HIDDEN, FRONT, BOTH] = [0, 1, 2, 3];

// Cells along the longest side of the scene, where the application names no size.
const CELLS = 256;

const own = (object, name, kind) => object[name] !== kind.prototype[name];

// What runs while the scene is drawn may clear depths, so that what is behind shows. Batches only sort.
const runs = (object) =>
  own(object, "onAfterRender", Object3D) || own(object, "onBeforeRender", object.isBatchedMesh ? BatchedMesh : Object3D) ||
  [object.material].flat().some((m) => m && own(m, "onBeforeRender", Material));

function kindOfMaterial(m) {
  // Vertices that move, and what is drawn, or counts in the stencil, in spite of what is before it.
  if (!m || m.isShaderMaterial || m.isNodeMaterial || m.displacementMap || own(m, "onBeforeCompile", Material)) return ALONE;
  if (!m.depthTest || ![LessEqualDepth, LessDepth].includes(m.depthFunc) || m.polygonOffset || m.stencilWrite) return ALONE;
  const opaque =
    m.visible && m.side !== BackSide && !m.wireframe && !m.transparent && m.opacity === 1 && !m.transmission &&
    !m.alphaTest && !m.alphaHash && !m.alphaMap && !m.alphaToCoverage && m.depthWrite && m.colorWrite &&
    !m.clippingPlanes?.length && [NormalBlending, NoBlending].includes(m.blending);
  return !opaque ? HIDDEN : m.side === DoubleSide ? BOTH : FRONT;
}

// Up to where groups draw the triangles of a geometry without a gap. One without a material draws nothing, and two may
// draw the same.
function drawnByGroups(groups, materials) {
  const drawn = groups.filter(({ start, materialIndex }) => start % 3 === 0 && materials[materialIndex]);
  const ends = (end, { start, count }) => (start <= end ? Math.max(end, start + Math.floor(count / 3) * 3) : end);
  return drawn.sort((a, b) => a.start - b.start).reduce(ends, 0);
}

// Whether a camera exchanges left and right, so that back sides are drawn.
function exchanges({ projectionMatrix: { elements: p }, matrixWorldInverse, isPerspectiveCamera }) {
  const row = (i) => new Vector3(p[i], p[4 + i], p[8 + i]);
  const ahead = isPerspectiveCamera ? row(3) : new Vector3(0, 0, -1);
  return !(row(0).cross(row(1)).dot(ahead) * matrixWorldInverse.determinant() < 0);
}

function kindOf(mesh) {
  const { geometry, material } = mesh;
  const moves = mesh.isSkinnedMesh || mesh.isInstancedMesh || mesh.isBatchedMesh || geometry.isInstancedBufferGeometry;
  const materials = [material].flat();
  let kind = moves || mesh.morphTargetInfluences?.some(Boolean) || !mesh.frustumCulled || !materials.length
    ? ALONE
    : Math.min(...materials.map(kindOfMaterial));
  const count = (geometry.index ?? geometry.attributes.position)?.count;
  const drawn = Array.isArray(material) ? drawnByGroups(geometry.groups, material) : count;
  const whole = geometry.drawRange.start === 0 && geometry.drawRange.count >= count && drawn >= count;
  const mirrored = mesh.matrixWorld.determinant() <= 0;
  if (!whole || (kind === FRONT && mirrored)) kind = Math.min(kind, HIDDEN);
  return kind;
}

// The triangles of a geometry as casca keeps them, by kind; made anew when they change.
class Shape {
  meshes = [];

  constructor(geometry) {
    this.stamp = Shape.stamp(geometry);
    const { index, attributes: { position } } = geometry;
    this.positions = new Float32Array(3 * position.count);
    for (let i = 0; i < position.count; i++) {
      this.positions.set([position.getX(i), position.getY(i), position.getZ(i)], 3 * i);
    }
    const corners = index ? Uint32Array.from(index.array) : Uint32Array.from({ length: position.count }, (_, i) => i);
    this.triangles = corners.subarray(0, corners.length - (corners.length % 3));
  }

  static stamp({ index, attributes: { position } }) {
    return [position, position?.version, position?.data?.version, index, index?.version];
  }

  mesh(kind) {
    this.meshes[kind] ??= new Mesh(this.positions, this.triangles, kind !== HIDDEN, kind === BOTH);
    return this.meshes[kind];
  }
}

export class CascaCuller {
  #shapes = new WeakMap();
  #known = new Map(); // by three's mesh
  #byId = new Map();
  #queries = new WeakMap(); // by camera
  #scene;
  #frame = 0;
  #masks = [];

  constructor(renderer, { cell } = {}) {
    if (!renderer.isWebGLRenderer) throw new Error("CascaCuller needs a WebGLRenderer");
    Object.assign(this, { renderer, cell, hidden: 0 });
  }

  // Draws as renderer.render does.
  render(scene, camera) {
    if (scene.matrixWorldAutoUpdate) scene.updateMatrixWorld();
    if (camera.parent === null && camera.matrixWorldAutoUpdate) camera.updateMatrixWorld();
    this.#hide(scene, camera);
    // The list of meshes is complete before shadows are drawn; mirrors draw the scene again even later.
    const { shadowMap } = this.renderer;
    const { render } = shadowMap;
    shadowMap.render = (...all) => {
      this.#show();
      return render.apply(shadowMap, all);
    };
    try {
      this.renderer.render(scene, camera);
    } finally {
      this.#show();
      shadowMap.render = render;
    }
  }

  dispose() {
    this.#scene?.free();
    this.#known.clear();
  }

  #show() {
    for (const [mesh, mask] of this.#masks) mesh.layers.mask = mask;
    this.#masks = [];
  }

  #hide(scene, camera) {
    this.hidden = 0;
    const { renderer } = this;
    const plain = (camera.isPerspectiveCamera || camera.isOrthographicCamera) && !camera.isArrayCamera;
    if (!plain || exchanges(camera) || renderer.clippingPlanes.length || renderer.xr?.isPresenting || scene.overrideMaterial) return;
    // Without depths, what is behind may be drawn last.
    const target = renderer.getRenderTarget();
    if (target ? !target.depthBuffer : !renderer.getContextAttributes().depth) return;
    if (!this.#follow(scene, camera) || !this.#scene) return;
    const matrix = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const zeroToOne = camera.coordinateSystem === WebGPUCoordinateSystem || camera.reversedDepth === true;
    const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld).toArray();
    let view, seen;
    try {
      view = camera.isPerspectiveCamera ? View.perspective(eye, matrix.elements, zeroToOne) : View.fromMatrix(matrix.elements, zeroToOne);
      if (!this.#queries.has(camera)) this.#queries.set(camera, new KeptQuery());
      seen = new Set(this.#queries.get(camera).run(this.#scene, view.withLayers(BigInt(camera.layers.mask >>> 0))));
    } catch {
      return; // A camera that sees nothing sensible.
    } finally {
      view?.free();
    }
    for (const [id, mesh] of this.#byId) {
      if (seen.has(id)) continue;
      this.#masks.push([mesh, mesh.layers.mask]);
      mesh.layers.mask = 0;
    }
    this.hidden = this.#masks.length;
  }

  // Brings casca's scene up to date: what came, moved, changed or went. Returns whether hidden meshes stay hidden.
  #follow(scene, camera) {
    this.#frame++;
    let quiet = true;
    const meshes = [];
    const visit = (object) => {
      if (!object.visible) return;
      quiet &&= !runs(object);
      if (object.isLOD && object.autoUpdate && object.layers.test(camera.layers)) object.update(camera);
      if (object.isMesh) meshes.push(object);
      object.children.forEach(visit);
    };
    visit(scene);
    if (!this.#scene && meshes.length) {
      const box = new Box3().setFromObject(scene);
      const size = this.cell ?? Math.max(...box.getSize(new Vector3()).toArray()) / CELLS;
      this.#scene = new Scene(Number.isFinite(size) && size > 0 ? size : 1);
    }
    this.#scene?.beginFrame(this.#frame / 60);
    meshes.forEach((mesh) => this.#meet(mesh));
    for (const [mesh, { frame }] of this.#known) if (frame !== this.#frame) this.#forget(mesh);
    return quiet;
  }

  #meet(mesh) {
    const { geometry, layers: { mask }, matrixWorld: { elements } } = mesh;
    let shape = this.#shapes.get(geometry);
    const stamp = Shape.stamp(geometry);
    // Some positions only the graphics processor has; of two numbers, it takes 0 for the third.
    const { position } = geometry.attributes;
    let kind = position?.getZ && position.itemSize > 2 ? kindOf(mesh) : ALONE;
    if (kind !== ALONE && !shape?.stamp.every((part, i) => part === stamp[i])) {
      shape = new Shape(geometry);
      this.#shapes.set(geometry, shape);
    }
    const known = this.#known.get(mesh);
    const same = known && known.kind === kind && known.mask === mask && (kind === ALONE || known.shape === shape);
    const moved = known && elements.some((number, i) => number !== known.place[i]);
    if (same) known.frame = this.#frame;
    if (same && !moved) return;
    const place = Float32Array.from(elements);
    try {
      if (same && known.moves && known.id !== undefined) {
        this.#scene.setTransforms([known.id], place);
        known.place = elements.slice();
        return;
      }
    } catch {
      kind = ALONE; // A place that is none.
    }
    this.#forget(mesh);
    let id;
    try {
      const wanted = kind !== ALONE && mask !== 0;
      if (wanted) [id] = this.#scene.insertMeshes(shape.mesh(kind), place, moved, BigInt(mask >>> 0));
    } catch {
      id = undefined; // Triangles or a place that casca refuses: it is drawn.
    }
    this.#known.set(mesh, { id, kind, mask, shape, place: elements.slice(), moves: moved, frame: this.#frame });
    if (id !== undefined) this.#byId.set(id, mesh);
  }

  #forget(mesh) {
    const { id } = this.#known.get(mesh) ?? {};
    this.#known.delete(mesh);
    if (id === undefined) return;
    this.#byId.delete(id);
    this.#scene.remove([id]);
  }
}
