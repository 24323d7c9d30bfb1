import { writeFileSync } from "node:fs";
import { join } from "node:path";

const side = 150;

/**
 * A map of 150 x 150 cells as a ROS map_server file: rooms of 10 x 10 with doors on all sides.
 * @returns {string} the YAML file in `folder`
 */
export function writeBigMap(folder) {
  const pixels = Buffer.alloc(side * side, 254);
  for (let row = 0; row < side; row += 1) {
    for (let column = 0; column < side; column += 1) {
      if (isWall(row, column)) pixels[row * side + column] = 0;
    }
  }
  writeFileSync(
    join(folder, "big.pgm"),
    Buffer.concat([Buffer.from(`P5\n${side} ${side}\n255\n`), pixels]),
  );
  const file = join(folder, "big.yaml");
  const keys = {
    image: "big.pgm",
    resolution: 2,
    origin: [0, 0, 0],
    negate: 0,
    occupied_thresh: 0.65,
    free_thresh: 0.196,
  };
  writeFileSync(file, JSON.stringify(keys));
  return file;
}

function isWall(row, column) {
  const last = side - 1;
  if (row === 0 || column === 0 || row === last || column === last) return true;
  const isDoor = (at) => at % 10 === 5;
  return (row % 10 === 0 && !isDoor(column)) || (column % 10 === 0 && !isDoor(row));
}
