// node screenshots.mjs OUTDIR [--docs | STATE...]: takes screenshots of the console's main states, each on its own system. With
// --docs only the one of the README, which is also copied to docs/console.png.
import { copyFileSync, mkdirSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { Scene } from "./support/scene.mjs";
import * as bringers from "./support/states.mjs";

const [, , folder, ...wanted] = process.argv;
const docsPicture = fileURLToPath(new URL("../../docs/console.png", import.meta.url));
const forDocs = wanted.includes("--docs");
const states = new Map(Object.entries(bringers));
const names = forDocs ? ["readme"] : wanted;
if (folder === undefined || names.some((name) => !states.has(name))) {
  console.error("usage: node screenshots.mjs OUTDIR [--docs | STATE...]; there are");
  for (const name of states.keys()) console.error(`  ${name}`);
  process.exit(2);
}
mkdirSync(folder, { recursive: true });

for (const name of names.length > 0 ? names : states.keys()) await bringAbout(name);
if (forDocs && process.exitCode === undefined) copyFileSync(pathOf("console"), docsPicture);

async function bringAbout(name) {
  const scene = new Scene(name);
  try {
    await states.get(name)(scene, shoot);
  } catch (error) {
    process.exitCode = 1;
    console.error(`${name}: ${error}`);
    await scene.report();
  } finally {
    await scene.end();
  }
}

async function shoot(page, name, options = {}) {
  await page.page.evaluate(() => Promise.all(document.getAnimations().map((one) => one.finished)));
  const path = pathOf(name);
  await page.page.screenshot({ path, ...options });
  console.log(path);
}

function pathOf(name) {
  return join(folder, `${name}.png`);
}
