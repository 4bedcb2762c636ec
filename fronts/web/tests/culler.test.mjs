// The helper for three.js, without a browser: what rays of three's own reach is drawn, whatever changes.
import assert from "node:assert/strict";
import { test } from "node:test";

import init from "casca/inline";
import { CascaCuller } from "casca/three";
import * as THREE from "three";

await init();

function generator(seed) {
  return () => {
    seed = (Math.imul(seed, 1664525) + 1013904223) | 0;
    return (seed >>> 0) / 2 ** 32;
  };
}

// As WebGLRenderer: a list of what is drawn, then shadows, then the meshes themselves.
class Renderer {
  isWebGLRenderer = true;
  clippingPlanes = [];
  xr = { isPresenting: false };
  target = null;
  depth = true;
  getRenderTarget = () => this.target;
  getContextAttributes = () => ({ depth: this.depth });
  shadowMap = { render: (scene) => scene.traverse((o) => o.isMesh && this.casters.add(o.layers.mask)) };

  render(scene, camera) {
    [this.drawn, this.casters] = [new Set(), new Set()];
    const visit = (object) => {
      if (!object.visible) return;
      if (object.isLOD) object.update(camera);
      if (object.isMesh && object.layers.test(camera.layers)) this.drawn.add(object);
      object.children.forEach(visit);
    };
    visit(scene);
    this.shadowMap.render(scene);
  }
}

// Materials; the first four are opaque.
const MATERIALS = [
  {}, {}, {}, { side: THREE.DoubleSide }, { side: THREE.BackSide },
  { transparent: true }, { opacity: 0.5, transparent: true }, { alphaTest: 0.5 }, { wireframe: true },
  { depthTest: false }, { depthWrite: false }, { colorWrite: false }, { blending: THREE.AdditiveBlending },
  { visible: false }, { alphaHash: true }, { polygonOffset: true }, { stencilWrite: true },
];

function world(random) {
  const scene = new THREE.Scene();
  const below = (n) => Math.floor(random() * n);
  // Half of all numbers are on a lattice.
  const number = (most) => (random() < 0.5 ? Math.round((random() - 0.5) * 2 * most) : (random() - 0.5) * 2 * most);
  const geometries = [new THREE.BoxGeometry(), new THREE.BoxGeometry(), new THREE.IcosahedronGeometry(0.6, 1), new THREE.PlaneGeometry()];
  geometries[1].setDrawRange(0, 30);
  const groups = [scene, new THREE.Group(), new THREE.Group()];
  scene.add(groups[1], groups[2]);
  const change = (mesh) => {
    const which = random() < 0.7 ? below(4) : below(MATERIALS.length);
    const kinds = { 0: () => mesh.position.set(number(8), number(4), number(8)),
      1: () => mesh.scale.set(...[1, 1, 1].map(() => [0.5, 3, 8, 8, -3][below(5)])),
      2: () => (mesh.material = new THREE.MeshBasicMaterial(MATERIALS[which])),
      3: () => (mesh.visible = random() < 0.8),
      4: () => mesh.layers.set(random() < 0.8 ? 0 : 1),
      5: () => (mesh.geometry = geometries[below(4)]),
      6: () => Object.assign(mesh.material, { transparent: false, opacity: 1, side: THREE.FrontSide }),
      7: () => groups[below(3)].add(mesh),
      8: () => mesh.rotation.set(number(1), number(1), number(1)) };
    kinds[below(9)]();
  };
  const meshes = [];
  for (let i = 0; i < 70; i++) {
    const mesh = new THREE.Mesh(geometries[0], new THREE.MeshBasicMaterial());
    scene.add(mesh);
    for (let n = 0; n < 6; n++) change(mesh);
    mesh.position.set(number(8), number(4), number(8));
    mesh.scale.set(...(i < 30 ? [8, 5, 0.5] : [0.6, 0.6, 0.6]));
    // A wall of each kind.
    if (i < MATERIALS.length) Object.assign(mesh, { geometry: geometries[0], material: new THREE.MeshBasicMaterial(MATERIALS[i]) });
    if (i < MATERIALS.length) mesh.position.z = -2 + i / 4;
    meshes.push(mesh);
  }
  const instances = new THREE.InstancedMesh(geometries[0], new THREE.MeshBasicMaterial(), 2);
  instances.scale.setScalar(3);
  scene.add(instances);
  return { scene, meshes, change, groups, number, below };
}

const opaque = ({ material: m }) =>
  m.visible && !m.transparent && !m.alphaTest && !m.wireframe && m.depthTest && m.depthWrite && m.colorWrite && !m.alphaHash &&
  m.blending === THREE.NormalBlending && m.opacity === 1;

// Asserts that all that rays reach is drawn; returns how many of the meshes behind are not.
function judge({ scene }, camera, renderer, random, what) {
  const shown = (o) => { for (; o; o = o.parent) if (!o.visible) return false; return true; };
  const caster = new THREE.Raycaster();
  caster.layers.mask = camera.layers.mask;
  const meshes = scene.getObjectsByProperty("isMesh", true).filter((m) => shown(m) && m.material.visible);
  for (const mesh of meshes) if (!mesh.material.depthTest && mesh.layers.test(camera.layers)) assert(renderer.drawn.has(mesh), what);
  let hidden = 0;
  for (let n = 0; n < 150; n++) {
    caster.setFromCamera(new THREE.Vector2(2 * random() - 1, 2 * random() - 1), camera);
    let free = true;
    for (const { object, instanceId } of caster.intersectObjects(meshes, false)) {
      const drawn = renderer.drawn.has(object);
      assert(drawn || !free, `${what}: ${meshes.indexOf(object)} is lost`);
      hidden += Number(!drawn);
      // A part of a geometry may be drawn; it hides nothing there.
      if (opaque(object) && instanceId === undefined) free = false;
    }
  }
  return hidden;
}

test("what rays reach is drawn, whatever changes", () => {
  let hidden = 0;
  for (let seed = 1; seed <= 12; seed++) {
    const random = generator(seed);
    const all = world(random);
    const renderer = new Renderer();
    const culler = new CascaCuller(renderer, seed % 2 ? { cell: 1 } : {});
    const cameras = [new THREE.PerspectiveCamera(70, 1.5, 0.1, 100), new THREE.OrthographicCamera(-8, 8, 5, -5, 0.1, 100)];
    for (let frame = 0; frame < 60; frame++) {
      for (let n = all.below(4); n > 0; n--) all.change(all.meshes[all.below(all.meshes.length)]);
      if (frame % 10 === 3) all.groups[1].visible = !all.groups[1].visible;
      if (frame % 20 === 7) all.scene.remove(all.meshes[all.below(70)]);
      const camera = cameras[frame % 5 === 4 ? 1 : 0];
      camera.position.set(all.number(3), all.number(2), 14);
      camera.lookAt(all.number(4), 0, 0);
      culler.render(all.scene, camera);
      hidden += judge(all, camera, renderer, random, `seed ${seed}, frame ${frame}`);
      // Shadows are drawn of all, and everything is as it was.
      assert(!renderer.casters.has(0));
      assert(all.meshes.every((mesh) => mesh.layers.mask !== 0));
    }
    culler.dispose();
  }
  console.log(`${hidden} hits of hidden meshes`);
  assert(hidden > 4_000);
});

test("what cannot be judged is drawn as without it", () => {
  const random = generator(5);
  const renderer = new Renderer();
  assert.throws(() => new CascaCuller({}), /WebGLRenderer/);
  const culler = new CascaCuller(renderer, { cell: 1 });
  const { scene } = world(random);
  const count = (camera) => {
    culler.render(scene, camera);
    return culler.hidden;
  };
  const camera = new THREE.PerspectiveCamera(70, 1.5, 0.1, 100);
  camera.position.z = 14;
  assert(count(camera) > 0);
  scene.overrideMaterial = new THREE.MeshBasicMaterial();
  assert.equal(count(camera), 0);
  scene.overrideMaterial = null;
  renderer.clippingPlanes.push(new THREE.Plane());
  assert.equal(count(camera), 0);
  renderer.clippingPlanes.pop();
  for (const name of ["onBeforeRender", "onAfterRender"]) {
    const line = new THREE.Line();
    for (const object of [scene, line, line.material].slice(0, name === "onBeforeRender" ? 3 : 2)) {
      scene.add(line);
      object[name] = () => {};
      assert.equal(count(camera), 0, name);
      delete object[name];
      scene.remove(line);
      assert(count(camera) > 0);
    }
  }
  for (const depthBuffer of [true, false]) {
    renderer.target = { depthBuffer };
    assert.equal(count(camera) > 0, depthBuffer);
  }
  renderer.target = null;
  renderer.depth = false;
  assert.equal(count(camera), 0);
  renderer.depth = true;
  const batch = new THREE.BatchedMesh(1, 3);
  scene.add(batch);
  assert(count(camera) > 0);
  scene.remove(batch);
  const mirror = camera.clone();
  mirror.projectionMatrix.elements[0] *= -1;
  assert.equal(count(mirror), 0);
  const broken = camera.clone();
  broken.projectionMatrix.elements.fill(NaN);
  assert.equal(count(broken), 0);
  assert(count(camera) > 0);
  // Places and triangles that are none.
  const mesh = new THREE.Mesh(new THREE.BoxGeometry(), new THREE.MeshBasicMaterial());
  mesh.position.x = NaN;
  const flat = new THREE.Mesh(new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array([NaN, 0, 0, 1, 0, 0, 0, 1, 0]), 3)));
  const none = new THREE.Mesh(new THREE.BufferGeometry());
  const group = new THREE.Mesh(new THREE.BoxGeometry(), [undefined]);
  const two = new THREE.Mesh(new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array(6), 2)));
  const foreign = new THREE.Mesh(new THREE.BufferGeometry().setAttribute("position", new THREE.GLBufferAttribute(null, 5126, 3, 4, 3)));
  const all = [mesh, flat, none, group, two, foreign];
  scene.add(...all);
  culler.render(scene, camera);
  for (const odd of all) assert(renderer.drawn.has(odd));
});

test("what groups leave out of a mesh hides nothing", () => {
  const materials = [0, 1, 2, 3, 4, 5].map(() => new THREE.MeshBasicMaterial());
  const wall = new THREE.Mesh(new THREE.BoxGeometry(20, 20, 1), materials);
  const thing = new THREE.Mesh(new THREE.BoxGeometry(), materials[0]);
  thing.position.z = -5;
  const scene = new THREE.Scene().add(wall, thing);
  const camera = new THREE.PerspectiveCamera(70, 1.5, 0.1, 100);
  camera.position.z = 14;
  const culler = new CascaCuller(new Renderer(), { cell: 1 });
  const { groups } = wall.geometry;
  const isHidden = () => {
    culler.render(scene, camera);
    return culler.hidden === 1;
  };
  assert(isHidden());
  // The side before the camera is the fifth of six.
  wall.material = materials.slice(0, 4);
  assert(!isHidden(), "a group without a material");
  wall.material = materials;
  for (const i of [4, 5]) groups[i] = groups[0];
  assert(!isHidden(), "groups that draw the same twice");
  wall.geometry.groups = [{ start: 18, count: 18, materialIndex: 1 }, { start: 0, count: 24, materialIndex: 0 }];
  assert(isHidden(), "in any order");
});
