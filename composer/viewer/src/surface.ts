// The surface of a mesh, from the bytes that `composer/mjcompose/mujoco/mesh_bytes.py` describes.
import { BufferAttribute, BufferGeometry } from "three";
import { simplify } from "./detail";

const MAPPED = 1, FLAT = 2, PLANES = 8;

/** A surface without normals is flat: each triangle has its own. */
export function surface(blob: ArrayBuffer): BufferGeometry {
  const [count, triangles, flags] = new Uint32Array(blob, 0, 3);
  const range = new Float32Array(blob, 12, 6), bytes = new Uint8Array(blob), geometry = new BufferGeometry();
  let at = 36;
  if (flags & MAPPED) {
    geometry.setAttribute("uv", new BufferAttribute(new Float32Array(blob.slice(at, at + 8 * count)), 2));
    at += 8 * count;
  }
  const corners = new Float32Array(3 * count), steps: Uint16Array[] = [];
  for (let axis = 0; axis < 3; axis++, at += 2 * count) {
    const low = range[axis], step = range[3 + axis], list = new Uint16Array(count);
    for (let k = 0, whole = 0; k < count; k++) {
      const z = bytes[at + k] | bytes[at + count + k] << 8;
      whole = whole + (z >> 1 ^ -(z & 1)) & 0xffff;
      list[k] = whole;
      corners[3 * k + axis] = low + step * whole;
    }
    steps.push(list);
  }
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  if (!(flags & FLAT)) {
    geometry.setAttribute("normal", new BufferAttribute(normals(bytes, at, count), 3));
    at += 2 * count;
  }
  const index = count <= 1 << 16 ? new Uint16Array(3 * triangles) : new Uint32Array(3 * triangles), planes = flags >> PLANES;
  for (let k = 0, first = 0; k < 3 * triangles; k += 3) {
    let [a, b, c] = [0, 0, 0];
    for (let plane = planes - 1; plane >= 0; plane--) {
      const from = at + 3 * triangles * plane + k;
      a = a << 8 | bytes[from]; b = b << 8 | bytes[from + 1]; c = c << 8 | bytes[from + 2];
    }
    index[k] = first += a;
    index[k + 1] = first + b;
    index[k + 2] = first + b + (c >>> 1 ^ -(c & 1));
  }
  geometry.setIndex(new BufferAttribute(index, 1));
  simplify(geometry, steps, steps.some((each) => each.some((whole) => whole >= 1 << 14)) ? 16 : 14);
  return geometry;
}

/** Directions whose sphere is folded into a square. */
function normals(bytes: Uint8Array, at: number, count: number): Float32Array {
  const found = new Float32Array(3 * count);
  for (let k = 0, u = 0, v = 0; k < count; k++) {
    u = u + bytes[at + k] & 255;
    v = v + bytes[at + count + k] & 255;
    let x = (u << 24 >> 24) / 127, y = (v << 24 >> 24) / 127;
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) [x, y] = [(1 - Math.abs(y)) * Math.sign(x || 1), (1 - Math.abs(x)) * Math.sign(y || 1)];
    const length = Math.hypot(x, y, z);
    found[3 * k] = x / length; found[3 * k + 1] = y / length; found[3 * k + 2] = z / length;
  }
  return found;
}
