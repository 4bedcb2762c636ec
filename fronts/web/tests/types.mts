// What TypeScript must take, and must refuse.
import { KeptQuery, Mesh, Query, Scene, View, fieldOfView } from "casca";
import inline from "casca/inline";
import { CascaCuller } from "casca/three";
import { PerspectiveCamera, Scene as World, WebGLRenderer } from "three";

const scene = new Scene(1);
const ids: BigUint64Array = scene.insertBoxes(new Float32Array(6), true);
const mesh = new Mesh(new Float32Array(9), new Uint32Array(3), true);
scene.insertMeshes(mesh, new Float32Array(16), undefined, 4n);
const view: View = View.omnidirectional(new Float32Array(3)).withLayers(1n);
const seen: BigUint64Array = new Query("fast").run(scene, view);
const kept: BigUint64Array = new KeptQuery().run(scene, view);
const tiles: Uint8Array = fieldOfView(new Uint8Array(4), 2, 0.5, 0.5);
scene.remove(ids);
// @ts-expect-error: ids are bigints
scene.has(3);
// @ts-expect-error: a view is no scene
new Query().run(view, view);
console.log(seen, kept, tiles);
await inline();
const culler = new CascaCuller(new WebGLRenderer(), { cell: 1 });
culler.render(new World(), new PerspectiveCamera());
// @ts-expect-error: a camera is no scene
culler.render(new PerspectiveCamera(), new PerspectiveCamera());
