import { test } from "node:test";
import { Scene } from "./scene.mjs";

/**
 * A test that uses the console as a person does, on its own system.
 * @param {string} name a sentence that states the fact
 * @param {(scene: Scene) => Promise<void>} walk
 */
export function journey(name, walk) {
  test(name, async () => {
    const scene = new Scene(name);
    try {
      await walk(scene);
      await scene.checkFaults();
    } catch (error) {
      await scene.report();
      await scene.end().catch(console.log); // what went wrong first is what counts
      throw error;
    }
    await scene.end();
  });
}
