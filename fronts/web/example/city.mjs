// A city in three.js whose hidden meshes casca hides: draw calls before and after, and whether the
// pictures are equal.
import init from "casca";
import { CascaCuller } from "casca/three";
import * as THREE from "three";

const BLOCKS = 20;
const PITCH = 12;
const SIZE = BLOCKS * PITCH;

// Random numbers from 0 to 1, the same in each run.
function generator(seed) {
  return () => {
    seed = (Math.imul(seed, 1664525) + 1013904223) | 0;
    return (seed >>> 0) / 2 ** 32;
  };
}

function add(world, geometry, material, at, size) {
  const mesh = new THREE.Mesh(geometry, material);
  mesh.position.set(...at);
  mesh.scale.set(...size);
  world.add(mesh);
  return mesh;
}

function city() {
  const random = generator(7);
  const world = new THREE.Scene();
  world.background = new THREE.Color(0xbfd9f2);
  world.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 2.5));
  const sun = new THREE.DirectionalLight(0xffffff, 1.5);
  sun.position.set(60, 120, 30);
  world.add(sun);
  const cube = new THREE.BoxGeometry(1, 1, 1);
  const ball = new THREE.IcosahedronGeometry(0.5, 1);
  const paint = (h, s, l) => new THREE.MeshLambertMaterial({ color: new THREE.Color().setHSL(h, s, l) });
  const walls = [...Array(8)].map((_, i) => paint(0.06 + 0.01 * i, 0.35, 0.5 + 0.04 * i));
  const things = [paint(0.55, 0.7, 0.5), paint(0.95, 0.7, 0.55), paint(0.33, 0.5, 0.4)];
  const glass = new THREE.MeshLambertMaterial({ color: 0x88ccff, transparent: true, opacity: 0.3 });
  const mark = new THREE.MeshBasicMaterial({ color: 0xff0000, transparent: true, depthTest: false });
  add(world, cube, paint(0.1, 0.05, 0.45), [SIZE / 2, -0.5, SIZE / 2], [SIZE, 1, SIZE]);
  for (let x = 0; x < BLOCKS; x++) {
    for (let z = 0; z < BLOCKS; z++) {
      const height = 8 + Math.floor(random() * 24);
      const [cx, cz] = [(x + 0.5) * PITCH, (z + 0.5) * PITCH];
      const wall = walls[Math.floor(random() * walls.length)];
      add(world, cube, wall, [cx, height / 2, cz], [8, height, 8]);
      // Panes of glass and blocks that are not drawn close the street; a mark shows through houses.
      if (z === BLOCKS / 2) {
        add(world, cube, x % 2 ? glass : wall, [cx + 6, 4, cz - 6], [0.2, 8, 4]).visible = x % 2 === 1;
        add(world, ball, mark, [cx, height / 2, cz + 2 * PITCH], [1, 1, 1]);
      }
      // Things that stand in the streets.
      for (let n = 0; n < 6; n++) {
        const along = (random() - 0.5) * 10;
        const at = n % 2 ? [cx + along, 0.5, cz + 6] : [cx + 6, 0.5, cz + along];
        add(world, ball, things[n % 3], at, [1, 1, 1]);
      }
    }
  }
  return world;
}

// Walks through the city. Returns the means of all frames.
export async function run(canvas, frames) {
  await init();
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  renderer.setSize(canvas.width, canvas.height, false);
  const camera = new THREE.PerspectiveCamera(60, canvas.width / canvas.height, 0.1, 500);
  const world = city();
  const culler = new CascaCuller(renderer, { cell: 2 });

  const picture = () => {
    const gl = renderer.getContext();
    const pixels = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels;
  };
  const objects = world.children.filter((child) => child.isMesh).length;
  const said = { objects, frames, before: 0, after: 0, differing: 0 };
  for (let frame = 0; frame < frames; frame++) {
    // A walk along a street, looking around.
    const along = ((frame + 0.5) / frames) * (SIZE - 40) + 20;
    camera.position.set(along, 1.7, SIZE / 2);
    camera.lookAt(along + Math.cos(frame), 2.5 + Math.sin(frame * 0.7), SIZE / 2 + Math.sin(frame));
    // Three's own culling by the frustum is on in both.
    renderer.render(world, camera);
    const all = picture();
    said.before += renderer.info.render.calls / frames;
    culler.render(world, camera);
    const culled = picture();
    said.after += renderer.info.render.calls / frames;
    for (let i = 0; i < all.length; i++) said.differing += Number(all[i] !== culled[i]);
  }
  return said;
}
