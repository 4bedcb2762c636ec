// The npm package under node: what it finds against rays, and what it refuses.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { KeptQuery, Mesh, Query, Scene, View, fieldOfView, initSync, visibleRegion } from "casca";

const wasm = initSync({ module: readFileSync(new URL(import.meta.resolve("casca/casca_bg.wasm"))) });

// Random numbers from 0 to 1, the same in each run.
function generator(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), seed | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

// Whether the open segment from one point to another goes through the inside of a box.
function blocked(from, to, box) {
  let [near, far] = [0, 1];
  for (let i = 0; i < 3; i++) {
    const d = to[i] - from[i];
    if (Math.abs(d) < 1e-12) {
      if (from[i] <= box[i] || from[i] >= box[i + 3]) return false;
      continue;
    }
    const [a, b] = [(box[i] - from[i]) / d, (box[i + 3] - from[i]) / d];
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
  }
  return far - near > 1e-6;
}

// Boxes that stand in a field of 64 m, and an eye outside of them.
function field(random, count) {
  const boxes = [];
  for (let i = 0; i < count; i++) {
    const [x, z, w, h, d] = [random() * 60, random() * 60, 1 + random() * 5, 1 + random() * 9, 1 + random() * 5];
    boxes.push([x, 0, z, x + w, h, z + d].map(Math.fround));
  }
  for (;;) {
    const eye = [random() * 64, 1 + random() * 3, random() * 64].map(Math.fround);
    const inside = (b) => eye.every((c, i) => c >= b[i] - 0.1 && c <= b[i + 3] + 0.1);
    if (!boxes.some(inside)) return { boxes, eye };
  }
}

const room = () => new Scene(1);

// The numbers of the objects that some of many rays reach.
function seen({ boxes, eye }, random, rays) {
  const found = new Set();
  boxes.forEach((b, i) => {
    for (let n = 0; n < rays; n++) {
      const at = [0, 1, 2].map((k) => b[k] + random() * (b[k + 3] - b[k]));
      const axis = n % 3;
      at[axis] = random() < 0.5 ? b[axis] : b[axis + 3];
      if (boxes.every((other, j) => (j === i ? !blocked(eye, at, b) : !blocked(eye, at, other)))) {
        found.add(i);
        break;
      }
    }
  });
  return found;
}

test("no object that rays see is missing, and walls hide", () => {
  const random = generator(1);
  let [found, truly, all] = [0, 0, 0];
  for (let round = 0; round < 12; round++) {
    const place = field(random, 150);
    const scene = room();
    const ids = [...scene.insertBoxes(place.boxes.flat(), true)];
    const view = View.omnidirectional(place.eye);
    const sets = [new Query().run(scene, view), new Query("tight").run(scene, view), new KeptQuery().run(scene, view)];
    const visible = seen(place, random, 200);
    for (const set of sets) {
      const numbers = new Set([...set].map((id) => ids.indexOf(id)));
      for (const i of visible) assert(numbers.has(i), `${i} is seen from ${place.eye}`);
    }
    found += sets[0].length;
    truly += visible.size;
    all += ids.length;
  }
  assert(found < 1.5 * truly && found < all / 2, `${found} ${truly} of ${all}`);
});

test("a level far from the world's origin is as near as any to an origin near it", () => {
  const { boxes, eye } = field(generator(7), 100);
  const set = (far) => {
    const scene = room();
    scene.setOrigin(...far);
    const ids = [...scene.insertBoxes(boxes.flat(), true)];
    // The view of a renderer that draws relative to the eye.
    const view = () => scene.view(...eye.map((e, i) => e + far[i]), View.omnidirectional([0, 0, 0]));
    const before = [...new Query().run(scene, view())].map((id) => ids.indexOf(id)).sort();
    scene.setOrigin(...far.map((c) => c + 1024));
    assert.deepEqual([...scene.origin], far.map((c) => c + 1024));
    const after = [...new Query().run(scene, view())].map((id) => ids.indexOf(id)).sort();
    for (const i of before) assert(after.includes(i), `${i} is gone after the origin moved`);
    return before;
  };
  assert.deepEqual(set([4194304, 0, -65536]), set([0, 0, 0]));
  assert.throws(() => room().setOrigin(NaN, 0, 0));
});

test("a frame: objects move, are hidden, cast shadows and go", () => {
  const scene = room();
  const [wall] = scene.insertBoxes([10, 0, 20, 50, 12, 21], true);
  const [ball] = scene.insertSpheres([30, 2, 40, 1], false, true);
  const query = new Query("balanced");
  const view = View.perspective([30, 2, 5], looking());
  assert.deepEqual([...query.run(scene, view)], [wall]);
  assert.deepEqual([...query.maySeePoints(scene, [30, 2, 10, 30, 2, 40])], [1, 0]);
  assert.deepEqual([...query.maySeeBoxes(scene, [29, 1, 9, 31, 3, 11, 29, 1, 39, 31, 3, 41])], [1, 0]);
  scene.beginFrame(0.1);
  scene.updateSpheres([ball], [30, 2, 15, 1]);
  assert.deepEqual([...query.run(scene, view)].sort(), [wall, ball].sort());
  // A box high above: its shadow falls to the ground in sight, and it is not seen.
  scene.updateBoxes([wall], [10, 0, 20, 50, 4, 21]);
  const [roof] = scene.insertBoxes([28, 14, 10, 32, 15, 14], false);
  assert(!query.run(scene, view).includes(roof));
  assert(query.shadowCastersOfSun(scene, [0, -1, 0.1]).includes(roof));
  assert(query.shadowCastersOfLamp(scene, [30, 15.5, 12], 100).includes(roof));
  assert.equal(scene.length, 3);
  assert(scene.has(roof) && scene.memoryBytes > 1000);
  scene.remove([roof]);
  assert(!scene.has(roof) && scene.length === 2 && [...scene.ids].length === 2);
  assert.throws(() => scene.remove([roof]), /0: /);
  // Layers.
  const [layered] = scene.insertBoxes([29, 1, 9, 31, 3, 11], false, false, 4n);
  assert(!query.run(scene, view.withLayers(1n)).includes(layered));
  assert(query.run(scene, view.withLayers(5n)).includes(layered));
});

// A camera of 90 degrees that looks along z, as WebGL has it: x and z of the world are turned.
function looking() {
  const [near, far, eye] = [0.1, 100, [30, 2, 5]];
  const [c, d] = [-(far + near) / (far - near), (-2 * far * near) / (far - near)];
  // View: x to -x, z to -z around the eye. Columns of projection times view.
  return [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -c, 1, eye[0], -eye[1], c * eye[2] + d, -eye[2]];
}

test("meshes hide, and instances move", () => {
  const scene = room();
  const square = new Mesh([-20, 0, 0, 20, 0, 0, 20, 12, 0, -20, 12, 0], [0, 1, 2, 0, 2, 3]);
  assert(!square.isClosed && square.occludes && square.length === 2 && square.memoryBytes > 0);
  const at = (x, z) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, z, 1];
  const [wall] = scene.insertMeshes(square, at(30, 20));
  const [box] = scene.insertBoxes([29, 1, 39, 31, 3, 41], false);
  const query = new Query();
  const view = View.omnidirectional([30, 2, 5]);
  assert.deepEqual([...query.run(scene, view)], [wall]);
  scene.setTransforms([wall], at(30, 50));
  assert(query.run(scene, view).includes(box));
  // A box around the mesh covers what the mesh does not.
  scene.updateBoxes([wall], [10, 0, 19, 50, 12, 21]);
  assert(query.run(scene, view).includes(box));
  const [one, many] = [View.fromMatrix(looking()), View.omnidirectional([30, 2, 5]).withReach(0.5).withTurn(0.1)];
  assert(new Query().run(scene, one).length <= new Query("fast").run(scene, many).length);
});

test("fields of view on tiles and between walls", () => {
  // The wall between the rooms has a gap in the last row.
  const map = ["#######", "#..#..#", "#..#..#", "#..#..#", "#.....#", "#######"];
  const walls = map.flatMap((row) => [...row].map((c) => Number(c === "#")));
  const tile = (tiles, x, y) => tiles[y * 7 + x];
  const tiles = fieldOfView(walls, 7, 1.5, 1.5);
  assert.equal(tiles.length, 42);
  assert(tile(tiles, 2, 3) === 1 && tile(tiles, 3, 1) === 1, "the room and its wall");
  assert(tile(tiles, 5, 1) === 0 && tile(tiles, 6, 3) === 0, "the other room");
  assert(tile(fieldOfView(walls, 7, 2.5, 4.5), 5, 4) === 1, "through the gap");
  assert(tile(fieldOfView(walls, 7, 2.5, 4.5, 2), 5, 4) === 0, "but not as far");
  const corners = visibleRegion([-1, 2, 1, 2], [0, 0], 10);
  for (let i = 0; i < corners.length; i += 2) {
    const [x, y] = [corners[i], corners[i + 1]];
    assert(Math.abs(x) > 0.9 || y < 2.1, `${x} ${y}`);
  }
});

test("what cannot be used is refused, and changes nothing", () => {
  const scene = room();
  const [id] = scene.insertBoxes([1, 1, 1, 2, 2, 2], true);
  const other = room();
  const [foreign, gone] = other.insertBoxes([1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4], true);
  other.remove([gone]);
  const query = new Query();
  const view = View.omnidirectional([5, 5, 5]);
  const refused = [
    () => new Scene(0),
    () => new Scene(NaN),
    () => new Scene([0, 0, 0], [64, 16, 64], 1),
    () => scene.insertBoxes([1, 2, 3, 4, 5], true),
    () => scene.insertBoxes([1, 1, 1, 2, 2, 2, NaN, 0, 0, 1, 1, 1], true),
    () => scene.insertBoxes([2, 2, 2, 1, 1, 1], true),
    () => scene.insertSpheres([1, 1, 1, -1], true),
    () => scene.updateBoxes([id], []),
    () => scene.updateBoxes([123456789n], [1, 1, 1, 2, 2, 2]),
    () => scene.updateBoxes([-1n], [1, 1, 1, 2, 2, 2]),
    () => scene.updateBoxes([1], [1, 1, 1, 2, 2, 2]),
    () => other.remove([gone]),
    () => scene.remove([foreign]),
    () => scene.remove([id, id]),
    () => other.updateBoxes([id], [1, 1, 1, 2, 2, 2]),
    () => scene.setTransforms([id], new Float32Array(16)),
    () => scene.beginFrame(NaN),
    () => scene.insertMeshes(query, []),
    () => query.run(null, view),
    () => query.run(view, scene),
    () => new Query().maySeePoints(scene, [1, 1, 1]),
    () => query.maySeePoints(scene, [1, 1]),
    () => query.shadowCastersOfSun(scene, [0, 0, 0]),
    () => new Query("best"),
    () => View.perspective([0, 0, 0], new Float32Array(15)),
    () => View.perspective([0, 0, 0], new Float32Array(16)),
    () => View.omnidirectional([0, NaN, 0]),
    () => view.withReach(-1),
    () => new Mesh([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 7]),
    () => new Mesh([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1]),
    () => fieldOfView([0, 0, 0], 2, 0.5, 0.5),
    () => fieldOfView([], 0, 0.5, 0.5),
    () => fieldOfView([0, 0], 2, NaN, 0.5),
    () => fieldOfView([0, 0], 2, 0.5, 0.5, -1),
    () => visibleRegion([1, 2, 3], [0, 0], 1),
    () => visibleRegion([1, 2, 3, Infinity], [0, 0], 1),
    () => visibleRegion([], [0, 0], 0),
  ];
  for (const call of refused) {
    assert.throws(call, (why) => why instanceof Error && why.message.length > 8 && !(why instanceof WebAssembly.RuntimeError), call.toString());
  }
  assert(typeof foreign === "bigint" && !scene.has(foreign) && scene.length === 1 && other.length === 1);
  assert.deepEqual([...query.run(scene, view)], [id]);
  // Freed ones are refused, too.
  const freed = room();
  freed.free();
  assert.throws(() => query.run(freed, view), /null pointer/);
  assert.deepEqual([...query.run(scene, view)], [id]);
});

test("memory stays where it is over a thousand frames", () => {
  const random = generator(5);
  const { boxes, eye } = field(random, 200);
  const scene = room();
  const ids = scene.insertBoxes(boxes.flat(), true, true);
  const query = new Query();
  const frame = (n) => {
    scene.beginFrame(n / 60);
    scene.updateBoxes(ids.subarray(0, 20), boxes.slice(0, 20).flatMap((b) => b.map((c, i) => c + (i % 3 ? 0 : (n % 2) * 0.1))));
    const view = View.omnidirectional(eye);
    query.run(scene, view);
    view.free();
  };
  for (let n = 0; n < 100; n++) frame(n);
  const before = wasm.memory.buffer.byteLength;
  for (let n = 100; n < 1100; n++) frame(n);
  assert.equal(wasm.memory.buffer.byteLength, before);
});
