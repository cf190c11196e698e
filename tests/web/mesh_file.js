// A simple writer and reader of binary STL that measures closedness and volume. Shares no code with the page or the program.

/** @param {number[][][]} triangles  three corners each, millimetres */
export function stlOf(triangles) {
  const file = Buffer.alloc(84 + 50 * triangles.length);
  file.writeUInt32LE(triangles.length, 80);
  triangles.flat(2).forEach((value, i) => {
    file.writeFloatLE(value, 84 + 50 * Math.floor(i / 9) + 12 + 4 * (i % 9));
  });
  return file;
}

/**
 * @param {Buffer} file
 * @returns {{triangles: number, openEdges: number, volume: number, min: number[], max: number[]}}
 *     openEdges: directed edges without their opposite; volume: in cubic millimetres, positive if normals point outwards
 */
export function measure(file) {
  const triangles = file.readUInt32LE(80);
  if (file.length !== 84 + 50 * triangles) {
    throw new Error(`${file.length} bytes are not a header and ${triangles} triangles`);
  }
  const edges = new Map();
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  let volume = 0;
  for (let at = 84; at < file.length; at += 50) {
    const corners = [0, 1, 2].map((corner) => [0, 4, 8].map((byte) => file.readFloatLE(at + 12 + 12 * corner + byte)));
    const names = corners.map(String);
    corners.forEach((corner, i) => {
      corner.forEach((value, axis) => {
        min[axis] = Math.min(min[axis], value);
        max[axis] = Math.max(max[axis], value);
      });
      const [there, back] = [`${names[i]} ${names[(i + 1) % 3]}`, `${names[(i + 1) % 3]} ${names[i]}`];
      edges.set(there, (edges.get(there) ?? 0) + 1);
      edges.set(back, (edges.get(back) ?? 0) - 1);
    });
    const [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners;
    volume += (ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)) / 6;
  }
  const openEdges = [...edges.values()].filter((balance) => balance > 0).length;
  return {triangles, openEdges, volume, min, max};
}
