// A wall hides a box: one of two objects is seen.
import init, { Query, Scene, View } from "casca/inline";

export const seen = init().then(() => {
  const scene = new Scene(1);
  scene.insertBoxes([-9, -9, 0, 9, 9, 1], true);
  scene.insertBoxes([0, 0, 5, 1, 1, 6], false);
  return new Query().run(scene, View.omnidirectional([0, 0, -5])).length;
});
