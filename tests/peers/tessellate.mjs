// node tessellate.mjs TOOL HEIGHTS SIZE TOLERANCE OUT: one height field as triangles, by delatin, martini or meshoptimizer.
// HEIGHTS: SIZE x SIZE raw f32, row by row; TOLERANCE in their unit. Writes OUT: raw u32, three texels (y * SIZE + x) a
// triangle. Prints {triangles, cpu_s}: user and system seconds from heights in memory to triangles in memory.
import { readFileSync, writeFileSync } from "node:fs";

// Of meshoptimizer's mesh, in texels: it measures distances to planes, so steepness must matter little.
const RELIEF = 64;

async function delatin() {
  const { default: Delatin } = await import("delatin");
  return (heights, size, tolerance) => {
    const tin = new Delatin(heights, size, size);
    tin.run(tolerance);
    return { corners: tin.triangles, texel: (v) => tin.coords[2 * v + 1] * size + tin.coords[2 * v] };
  };
}

async function martini() {
  const { default: Martini } = await import("@mapbox/martini");
  return (heights, size, tolerance) => {
    const mesh = new Martini(size).createTile(heights).getMesh(tolerance);
    return { corners: mesh.triangles, texel: (v) => mesh.vertices[2 * v + 1] * size + mesh.vertices[2 * v] };
  };
}

async function meshoptimizer() {
  const { MeshoptSimplifier } = await import("meshoptimizer");
  await MeshoptSimplifier.ready;
  return (heights, size, tolerance) => {
    const relief = RELIEF / rangeOf(heights);
    const positions = new Float32Array(3 * heights.length);
    for (let v = 0; v < heights.length; v++) {
      positions[3 * v] = v % size;
      positions[3 * v + 1] = Math.floor(v / size);
      positions[3 * v + 2] = relief * heights[v];
    }
    const [corners] = MeshoptSimplifier.simplify(grid(size), positions, 3, 0, relief * tolerance, ["ErrorAbsolute"]);
    return { corners, texel: (v) => v };
  };
}

function rangeOf(heights) {
  let [least, most] = [Infinity, -Infinity];
  for (const height of heights) [least, most] = [Math.min(least, height), Math.max(most, height)];
  return most > least ? most - least : 1;
}

// Two triangles a cell.
function grid(size) {
  const corners = new Uint32Array(6 * (size - 1) ** 2);
  let next = 0;
  for (let v = 0; v < size * (size - 1); v++) {
    if (v % size === size - 1) continue;
    for (const corner of [v, v + size + 1, v + size, v, v + 1, v + size + 1]) corners[next++] = corner;
  }
  return corners;
}

const [tool, heightsFile, side, tolerance, out] = process.argv.slice(2);
const tessellate = await { delatin, martini, meshoptimizer }[tool]();
const bytes = readFileSync(heightsFile);
const heights = new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));

const start = process.cpuUsage();
const { corners, texel } = tessellate(heights, Number(side), Number(tolerance));
const used = process.cpuUsage(start);

writeFileSync(out, Uint32Array.from(corners, texel));
console.log(JSON.stringify({ triangles: corners.length / 3, cpu_s: (used.user + used.system) / 1e6 }));
