// The surfaces of geoms. Those of one form share a surface and are drawn at once, each scaled to its size.
import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  CircleGeometry,
  CylinderGeometry,
  PlaneGeometry,
  SphereGeometry,
} from "three";
import type { HeightField, Model } from "./data";
import { rounded, simplify } from "./detail";

export const PLANE = 0,
  HFIELD = 1,
  SPHERE = 2,
  CAPSULE = 3,
  ELLIPSOID = 4,
  CYLINDER = 5,
  BOX = 6,
  MESH = 7,
  SDF = 8;
export const SHAPE_NAMES = [
  "plane",
  "height field",
  "sphere",
  "capsule",
  "ellipsoid",
  "cylinder",
  "box",
  "mesh",
  "SDF",
];

export interface Shape {
  key: string;
  scale: [number, number, number];
  make: () => BufferGeometry;
}

/** The drawing of a geom or site; `far` is the distance to which an infinite plane is drawn. */
export function shapeOf(model: Model, type: number, size: number[], data: number, far: number, fine: boolean): Shape {
  const round = fine ? 48 : 20;
  const [a, b, c] = size;
  switch (type) {
    case PLANE: {
      const endless = a <= 0 || b <= 0;
      if (endless) {
        return { key: "endless", scale: [far, far, 1], make: () => new CircleGeometry(1, 64) };
      }
      return { key: "plane", scale: [a, b, 1], make: () => new PlaneGeometry(2, 2) };
    }
    case SPHERE:
      return {
        key: "sphere",
        scale: [a, a, a],
        make: () => rounded((sides) => upright(new SphereGeometry(1, sides, sides / 2)), round),
      };
    case ELLIPSOID:
      return {
        key: "sphere",
        scale: [a, b, c],
        make: () => rounded((sides) => upright(new SphereGeometry(1, sides, sides / 2)), round),
      };
    case CAPSULE: {
      const length = Number(((2 * b) / a).toPrecision(6));
      const make = () => rounded((sides) => upright(new CapsuleGeometry(1, length, sides / 4, sides)), round);
      return { key: `capsule ${length}`, scale: [a, a, a], make };
    }
    case CYLINDER:
      return {
        key: "cylinder",
        scale: [a, a, b],
        make: () => rounded((sides) => upright(new CylinderGeometry(1, 1, 2, sides)), round),
      };
    case BOX:
      return { key: "box", scale: [a, b, c], make: () => new BoxGeometry(2, 2, 2) };
    case HFIELD:
      return { key: `hfield ${data}`, scale: [1, 1, 1], make: () => heights(model, model.scene.hfield[data]) };
    default: {
      if (data < 0) {
        return { key: "box", scale: [a, b, c], make: () => new BoxGeometry(2, 2, 2) };
      }
      const blob = model.scene.mesh[data];
      return { key: `mesh ${blob}`, scale: [1, 1, 1], make: () => surface(model.blobs.get(blob)!) };
    }
  }
}

/** three.js has axes of round things along y, MuJoCo along z. */
const upright = (geometry: BufferGeometry): BufferGeometry => geometry.rotateX(Math.PI / 2);

function heights(model: Model, field: HeightField): BufferGeometry {
  const { rows, columns, size } = field;
  const steps = new Uint16Array(model.blobs.get(field.blob)!, 0, rows * columns);
  const [sx, sy, high, deep] = size;
  const at = (r: number, c: number) => [sx * ((2 * c) / (columns - 1) - 1), sy * ((2 * r) / (rows - 1) - 1)];
  const corners: number[] = [];
  const index: number[] = [];
  for (let r = 0; r < rows; r++) {
    for (let c = 0; c < columns; c++) {
      corners.push(...at(r, c), (high * steps[r * columns + c]) / 65535);
    }
  }
  for (let r = 0; r + 1 < rows; r++) {
    for (let c = 0; c + 1 < columns; c++) {
      const k = r * columns + c;
      index.push(k, k + 1, k + columns + 1, k, k + columns + 1, k + columns);
    }
  }
  // The sides down to its base, with corners of their own so that edges stay sharp.
  const rim: [number, number][] = [];
  for (let c = 0; c < columns; c++) {
    rim.push([0, c]);
  }
  for (let r = 1; r < rows; r++) {
    rim.push([r, columns - 1]);
  }
  for (let c = columns - 2; c >= 0; c--) {
    rim.push([rows - 1, c]);
  }
  for (let r = rows - 2; r >= 0; r--) {
    rim.push([r, 0]);
  }
  for (let k = 0; k + 1 < rim.length; k++) {
    const first = corners.length / 3;
    for (const [r, c] of [rim[k], rim[k + 1]]) {
      corners.push(...at(r, c), (high * steps[r * columns + c]) / 65535, ...at(r, c), -deep);
    }
    index.push(first, first + 1, first + 2, first + 1, first + 3, first + 2);
  }
  const base = corners.length / 3;
  corners.push(-sx, -sy, -deep, sx, -sy, -deep, sx, sy, -deep, -sx, sy, -deep);
  index.push(base, base + 2, base + 1, base, base + 3, base + 2);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(corners), 3));
  geometry.setIndex(index);
  geometry.computeVertexNormals();
  return geometry;
}

const MAPPED = 1;
const FLAT = 2;
const PLANES = 8;

/** A surface without normals is flat: each triangle has its own. */
export function surface(blob: ArrayBuffer): BufferGeometry {
  const [count, triangles, flags] = new Uint32Array(blob, 0, 3);
  const range = new Float32Array(blob, 12, 6);
  const bytes = new Uint8Array(blob);
  const geometry = new BufferGeometry();
  let at = 36;
  if (flags & MAPPED) {
    geometry.setAttribute("uv", new BufferAttribute(new Float32Array(blob.slice(at, at + 8 * count)), 2));
    at += 8 * count;
  }
  const corners = new Float32Array(3 * count);
  const steps: Uint16Array[] = [];
  for (let axis = 0; axis < 3; axis++, at += 2 * count) {
    const low = range[axis];
    const step = range[3 + axis];
    const list = new Uint16Array(count);
    for (let k = 0, whole = 0; k < count; k++) {
      const z = bytes[at + k] | (bytes[at + count + k] << 8);
      whole = (whole + ((z >> 1) ^ -(z & 1))) & 0xffff;
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
  const index = count <= 1 << 16 ? new Uint16Array(3 * triangles) : new Uint32Array(3 * triangles);
  const planes = flags >> PLANES;
  for (let k = 0, first = 0; k < 3 * triangles; k += 3) {
    let [a, b, c] = [0, 0, 0];
    for (let plane = planes - 1; plane >= 0; plane--) {
      const from = at + 3 * triangles * plane + k;
      a = (a << 8) | bytes[from];
      b = (b << 8) | bytes[from + 1];
      c = (c << 8) | bytes[from + 2];
    }
    index[k] = first += a;
    index[k + 1] = first + b;
    index[k + 2] = first + b + ((c >>> 1) ^ -(c & 1));
  }
  geometry.setIndex(new BufferAttribute(index, 1));
  simplify(geometry, steps, steps.some((each) => each.some((whole) => whole >= 1 << 14)) ? 16 : 14);
  return geometry;
}

/** Directions whose sphere is folded into a square. */
function normals(bytes: Uint8Array, at: number, count: number): Float32Array {
  const directions = new Float32Array(3 * count);
  for (let k = 0, u = 0, v = 0; k < count; k++) {
    u = (u + bytes[at + k]) & 255;
    v = (v + bytes[at + count + k]) & 255;
    let x = ((u << 24) >> 24) / 127;
    let y = ((v << 24) >> 24) / 127;
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) {
      [x, y] = [(1 - Math.abs(y)) * Math.sign(x || 1), (1 - Math.abs(x)) * Math.sign(y || 1)];
    }
    const length = Math.hypot(x, y, z);
    directions[3 * k] = x / length;
    directions[3 * k + 1] = y / length;
    directions[3 * k + 2] = z / length;
  }
  return directions;
}
