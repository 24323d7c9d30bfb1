import { writeFileSync } from "node:fs";
import { join } from "node:path";

/**
 * A map of side x side cells as a ROS map_server file: rooms of room x room with doors on all sides.
 * @returns {string} the YAML file in `folder`
 */
export function writeBigMap(folder, side = 150, room = 10) {
  const pixels = Buffer.alloc(side * side, 254);
  for (let row = 0; row < side; row += 1) {
    for (let column = 0; column < side; column += 1) {
      if (isWall(side, room, row, column)) pixels[row * side + column] = 0;
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

function isWall(side, room, row, column) {
  const last = side - 1;
  if (row === 0 || column === 0 || row === last || column === last) return true;
  const isDoor = (at) => at % room === room / 2;
  return (row % room === 0 && !isDoor(column)) || (column % room === 0 && !isDoor(row));
}
