// Writes x.gz next to each file of the built page that becomes smaller by it: node compress.mjs FOLDER
import { readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

const folder = process.argv[2];
if (!folder) {
  console.error("compress.mjs: which folder?");
  process.exit(2);
}

let plain = 0;
let compressed = 0;
for (const name of readdirSync(folder, { recursive: true })) {
  const file = join(folder, String(name));
  if (!statSync(file).isFile() || file.endsWith(".gz")) continue;
  const bytes = readFileSync(file);
  const zipped = gzipSync(bytes, { level: 9 });
  plain += bytes.length;
  compressed += Math.min(zipped.length, bytes.length);
  if (zipped.length < 0.98 * bytes.length) writeFileSync(`${file}.gz`, zipped);
}
console.log(`page: ${plain} bytes, ${compressed} compressed`);
