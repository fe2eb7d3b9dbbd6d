// The surfaces of geoms. Those of one form share a surface and are drawn at once, each scaled to its size.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, CircleGeometry, CylinderGeometry, PlaneGeometry,
  SphereGeometry,
} from "three";
import type { HeightField, Model } from "./data";
import { rounded } from "./detail";
import { surface } from "./surface";

export const PLANE = 0, HFIELD = 1, SPHERE = 2, CAPSULE = 3, ELLIPSOID = 4, CYLINDER = 5, BOX = 6, MESH = 7, SDF = 8;
export const SHAPE_NAMES = ["plane", "height field", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "SDF"];

export interface Shape { key: string; scale: [number, number, number]; make: () => BufferGeometry }

/** The drawing of a geom or site; `far` is the distance to which an infinite plane is drawn. */
export function shapeOf(model: Model, type: number, size: number[], data: number, far: number, fine: boolean): Shape {
  const round = fine ? 48 : 20;
  const [a, b, c] = size;
  switch (type) {
    case PLANE: {
      const endless = a <= 0 || b <= 0;
      if (endless) return { key: "endless", scale: [far, far, 1], make: () => new CircleGeometry(1, 64) };
      return { key: "plane", scale: [a, b, 1], make: () => new PlaneGeometry(2, 2) };
    }
    case SPHERE:
      return { key: "sphere", scale: [a, a, a], make: () => rounded((sides) => upright(new SphereGeometry(1, sides, sides / 2)), round) };
    case ELLIPSOID:
      return { key: "sphere", scale: [a, b, c], make: () => rounded((sides) => upright(new SphereGeometry(1, sides, sides / 2)), round) };
    case CAPSULE: {
      const length = Number((2 * b / a).toPrecision(6));
      const make = () => rounded((sides) => upright(new CapsuleGeometry(1, length, sides / 4, sides)), round);
      return { key: `capsule ${length}`, scale: [a, a, a], make };
    }
    case CYLINDER:
      return { key: "cylinder", scale: [a, a, b], make: () => rounded((sides) => upright(new CylinderGeometry(1, 1, 2, sides)), round) };
    case BOX:
      return { key: "box", scale: [a, b, c], make: () => new BoxGeometry(2, 2, 2) };
    case HFIELD:
      return { key: `hfield ${data}`, scale: [1, 1, 1], make: () => heights(model, model.scene.hfield[data]) };
    default: {
      if (data < 0) return { key: "box", scale: [a, b, c], make: () => new BoxGeometry(2, 2, 2) };
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
  const at = (r: number, c: number) => [sx * (2 * c / (columns - 1) - 1), sy * (2 * r / (rows - 1) - 1)];
  const corners: number[] = [], index: number[] = [];
  for (let r = 0; r < rows; r++) {
    for (let c = 0; c < columns; c++) corners.push(...at(r, c), high * steps[r * columns + c] / 65535);
  }
  for (let r = 0; r + 1 < rows; r++) {
    for (let c = 0; c + 1 < columns; c++) {
      const k = r * columns + c;
      index.push(k, k + 1, k + columns + 1, k, k + columns + 1, k + columns);
    }
  }
  // The sides down to its base, with corners of their own so that edges stay sharp.
  const rim: [number, number][] = [];
  for (let c = 0; c < columns; c++) rim.push([0, c]);
  for (let r = 1; r < rows; r++) rim.push([r, columns - 1]);
  for (let c = columns - 2; c >= 0; c--) rim.push([rows - 1, c]);
  for (let r = rows - 2; r >= 0; r--) rim.push([r, 0]);
  for (let k = 0; k + 1 < rim.length; k++) {
    const first = corners.length / 3;
    for (const [r, c] of [rim[k], rim[k + 1]]) {
      corners.push(...at(r, c), high * steps[r * columns + c] / 65535, ...at(r, c), -deep);
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
