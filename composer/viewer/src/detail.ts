// Fewer triangles for surfaces that are small in the picture, that move, or that only cast a shadow.
import { BufferAttribute, BufferGeometry, type InstancedMesh, Matrix4, type PerspectiveCamera, Vector3 } from "three";

/** Triangles of a surface whose corners are merged on a grid. `cells` is the number of cells along its longest side. */
interface Level {
  cells: number;
  start: number;
  count: number;
}

const LEAST = 800;
const MOST_CELLS = 512;
const LEAST_CELLS = 4;
const SHADOW_CELLS = 22;
/** Sides of round things that differ from a circle by less than a quarter of a cell. */
const ROUND = [
  { sides: 24, cells: 64 },
  { sides: 16, cells: 28 },
  { sides: 8, cells: 7 },
  { sides: 6, cells: 3 },
];

/**
 * Add coarser triangles after the triangles of a surface. Its corners are in Morton order, with whole numbers below
 * 2^bits.
 */
export function simplify(geometry: BufferGeometry, whole: Uint16Array[], bits: number): void {
  const fine = geometry.index!.array;
  const count = whole[0].length;
  const levels: Level[] = [{ cells: Infinity, start: 0, count: fine.length }];
  if (fine.length < 3 * LEAST) {
    return;
  }
  const [x, y, z] = whole;
  const same = new Uint32Array(count);
  const pieces: (typeof fine)[] = [];
  let total = fine.length;
  let source = fine;
  for (let cells = MOST_CELLS; cells >= LEAST_CELLS; cells /= 2) {
    const shift = bits - Math.log2(cells);
    for (let k = 1; k < count; k++) {
      same[k] =
        x[k] >> shift === x[k - 1] >> shift &&
        y[k] >> shift === y[k - 1] >> shift &&
        z[k] >> shift === z[k - 1] >> shift
          ? same[k - 1]
          : k;
    }
    const coarse = source.slice();
    let size = 0;
    for (let k = 0; k < source.length; k += 3) {
      const a = same[source[k]];
      const b = same[source[k + 1]];
      const c = same[source[k + 2]];
      if (a === b || b === c || a === c) {
        continue;
      }
      coarse[size] = a;
      coarse[size + 1] = b;
      coarse[size + 2] = c;
      size += 3;
    }
    if (size > 0.7 * source.length) {
      continue;
    }
    source = coarse.slice(0, size);
    pieces.push(source);
    levels.push({ cells, start: total, count: size });
    total += size;
    if (size < LEAST) {
      break;
    }
  }
  const all = fine instanceof Uint16Array ? new Uint16Array(total) : new Uint32Array(total);
  all.set(fine);
  levels.slice(1).forEach((each, k) => all.set(pieces[k], each.start));
  geometry.setIndex(new BufferAttribute(all, 1));
  geometry.userData.levels = levels;
  use(geometry, Infinity);
}

/** Draw the coarsest triangles that have at least this number of cells. */
function use(geometry: BufferGeometry, cells: number): void {
  const levels = geometry.userData.levels as Level[];
  const level = [...levels].reverse().find((each) => each.cells >= cells)!;
  geometry.setDrawRange(level.start, level.count);
}

/** A shadow of a surface needs few triangles. */
export function shade(mesh: InstancedMesh): void {
  const { geometry } = mesh;
  if (!geometry.userData.levels) {
    return;
  }
  let before = geometry.drawRange;
  mesh.onBeforeShadow = () => {
    before = { ...geometry.drawRange };
    use(geometry, SHADOW_CELLS);
  };
  mesh.onAfterShadow = () => geometry.setDrawRange(before.start, before.count);
}

/** Draw no more triangles than the picture shows: `pixels` is its height, and `fine` how many cells a pixel has. */
export function suit(mesh: InstancedMesh, camera: PerspectiveCamera, pixels: number, fine: number): void {
  const { geometry } = mesh;
  if (!geometry.userData.levels) {
    return;
  }
  if (!geometry.boundingSphere) {
    geometry.computeBoundingSphere();
  }
  const { center, radius } = geometry.boundingSphere!;
  const matrix = new Matrix4();
  const place = new Vector3();
  const lens = 2 * Math.tan((camera.fov * Math.PI) / 360);
  let share = 0;
  for (let k = 0; k < mesh.count; k++) {
    mesh.getMatrixAt(k, matrix);
    const size = radius * matrix.getMaxScaleOnAxis();
    const distance = place.copy(center).applyMatrix4(matrix).distanceTo(camera.position) - size;
    share = Math.max(share, (2 * size) / (lens * Math.max(distance, camera.near)));
  }
  use(geometry, share * pixels * fine);
}

/** A round shape in versions with fewer and fewer sides. `make` returns it with a number of sides, at most `most`. */
export function rounded(make: (sides: number) => BufferGeometry, most: number): BufferGeometry {
  const all = [{ sides: most, cells: Infinity }, ...ROUND.filter(({ sides }) => sides < most)];
  const made = all.map(({ sides }) => make(sides));
  const whole = new BufferGeometry();
  for (const name of ["position", "normal", "uv"]) {
    const lists = made.map((each) => each.getAttribute(name));
    const joined = new Float32Array(lists.reduce((sum, each) => sum + each.array.length, 0));
    let at = 0;
    for (const { array } of lists) {
      joined.set(array, at);
      at += array.length;
    }
    whole.setAttribute(name, new BufferAttribute(joined, lists[0].itemSize));
  }
  const index: number[] = [];
  const levels: Level[] = [];
  let first = 0;
  made.forEach((each, k) => {
    levels.push({ cells: all[k].cells, start: index.length, count: each.index!.count });
    for (const corner of each.index!.array) {
      index.push(first + corner);
    }
    first += each.getAttribute("position").count;
    each.dispose();
  });
  whole.setIndex(index);
  whole.userData.levels = levels;
  use(whole, Infinity);
  return whole;
}
