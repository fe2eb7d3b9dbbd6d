// Skins, flexes and tendons: what changes its form with the pose.
import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  Color,
  CylinderGeometry,
  DoubleSide,
  Group,
  InstancedMesh,
  Matrix4,
  Mesh,
  type MeshPhongMaterial,
  type Object3D,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";
import { type Element, type Flex, type Model, row, type Seen, type Skin } from "./data";
import { type Pose, rotated } from "./kinematics";
import { colourOf, type Painter } from "./paint";

interface Soft {
  object: Object3D;
  kind: string;
  index: number;
  group: number;
  update: () => void;
  members?: number[];
}

const SITE = 3;
const PULLEY = 2;
const JOINT = 1;

export class Softs {
  readonly root = new Group();
  private readonly all: Soft[] = [];
  /** The results of MuJoCo for the pose, such as the paths of tendons; null while they are not known. */
  seen: Seen | null;

  constructor(
    private readonly model: Model,
    private readonly painter: Painter,
    private readonly pose: Pose,
  ) {
    this.seen = model.scene.poses[0];
  }

  build(): void {
    const { scene } = this.model;
    scene.skin.forEach((each, index) => this.add({ kind: "skin", index, group: each.group, ...this.skin(each) }));
    scene.flex.forEach((each, index) =>
      this.add({
        kind: "flex",
        index,
        group: each.group,
        ...(each.dimensions === 1 ? this.rope(each) : this.cloth(each)),
      }),
    );
    scene.tendon.name.forEach((_, index) => {
      if (scene.wrap.type[scene.tendon.first[index]] !== JOINT) {
        this.add({ kind: "tendon", index, group: scene.tendon.group[index], ...this.tendon(index) });
      }
    });
  }

  private add(soft: Soft): void {
    soft.object.visible = soft.group < 3;
    this.all.push(soft);
    this.root.add(soft.object);
  }

  private paint(material: number, rgba: number[], mapped: boolean): MeshPhongMaterial {
    const [r, g, b, a] = colourOf(this.model, rgba, material);
    const paint = this.painter.material(material, a, mapped ? null : [1, 1, 1], false);
    paint.color = new Color().setRGB(r, g, b);
    paint.side = DoubleSide;
    return paint;
  }

  private skin(skin: Skin): { object: Object3D; update: () => void } {
    const blob = this.model.blobs.get(skin.blob)!;
    const { count, bones } = skin;
    let at = 0;
    const floats = (n: number) => {
      const numbers = new Float32Array(blob, at, n);
      at += 4 * n;
      return numbers;
    };
    const whole = (n: number) => {
      const numbers = new Uint32Array(blob, at, n);
      at += 4 * n;
      return numbers;
    };
    const rest = floats(3 * count);
    const faces = whole(3 * skin.triangles);
    const flat = skin.mapped ? floats(2 * count) : null;
    const total = skin.moved.reduce((sum, each) => sum + each, 0);
    const moved = whole(total);
    const weights = floats(total);
    const geometry = new BufferGeometry();
    const corners = new Float32Array(3 * count);
    geometry.setAttribute("position", new BufferAttribute(corners, 3));
    if (flat) {
      geometry.setAttribute("uv", new BufferAttribute(flat.slice(), 2));
    }
    geometry.setIndex(new BufferAttribute(faces.slice(), 1));
    const mesh = new Mesh(geometry, this.paint(skin.material, skin.rgba, skin.mapped));
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.frustumCulled = false;
    const update = () => {
      corners.fill(0);
      let first = 0;
      bones.forEach((body, bone) => {
        const turn = new Quaternion(...xyzw(this.pose.quat, 4 * body)).multiply(
          new Quaternion(...xyzw(skin.quat, 4 * bone)).conjugate(),
        );
        const place = new Vector3()
          .fromArray(this.pose.pos, 3 * body)
          .sub(new Vector3().fromArray(skin.pos, 3 * bone).applyQuaternion(turn));
        const e = new Matrix4().compose(place, turn, new Vector3(1, 1, 1)).elements;
        for (let k = first; k < first + skin.moved[bone]; k++) {
          const v = 3 * moved[k];
          const w = weights[k];
          const x = rest[v];
          const y = rest[v + 1];
          const z = rest[v + 2];
          corners[v] += w * (e[0] * x + e[4] * y + e[8] * z + e[12]);
          corners[v + 1] += w * (e[1] * x + e[5] * y + e[9] * z + e[13]);
          corners[v + 2] += w * (e[2] * x + e[6] * y + e[10] * z + e[14]);
        }
        first += skin.moved[bone];
      });
      geometry.computeVertexNormals();
      if (skin.inflate) {
        const normals = geometry.getAttribute("normal").array;
        for (let k = 0; k < corners.length; k++) {
          corners[k] += skin.inflate * normals[k];
        }
      }
      geometry.getAttribute("position").needsUpdate = true;
      geometry.computeBoundingSphere();
    };
    return { object: mesh, update };
  }

  private flex(flex: Flex): { shell: Uint32Array; edges: Uint32Array; place: (into: Float32Array) => void } {
    const blob = this.model.blobs.get(flex.blob)!;
    const { count } = flex;
    const local = new Float32Array(blob, 0, 3 * count);
    const bodies = new Uint32Array(blob, 12 * count, count);
    const shell = new Uint32Array(blob, 16 * count, 3 * flex.triangles);
    const edges = new Uint32Array(blob, 16 * count + 12 * flex.triangles, 2 * flex.edges);
    const place = (into: Float32Array) => {
      for (let k = 0; k < count; k++) {
        const b = bodies[k];
        const [x, y, z] = rotated(this.pose.quat, 4 * b, local as any, 3 * k);
        into[3 * k] = this.pose.pos[3 * b] + x;
        into[3 * k + 1] = this.pose.pos[3 * b + 1] + y;
        into[3 * k + 2] = this.pose.pos[3 * b + 2] + z;
      }
    };
    return { shell, edges, place };
  }

  /** A flex with a surface, which is as far from its corners as its radius says. */
  private cloth(flex: Flex): { object: Object3D; update: () => void } {
    const { shell, place } = this.flex(flex);
    const { count, radius } = flex;
    const plain = new BufferGeometry();
    const middle = new Float32Array(3 * count);
    plain.setAttribute("position", new BufferAttribute(middle, 3));
    plain.setIndex(new BufferAttribute(shell.slice(), 1));
    const both = flex.dimensions === 2;
    const corners = new Float32Array((both ? 2 : 1) * 3 * count);
    const index = [...shell];
    if (both) {
      for (let k = 0; k < shell.length; k += 3) {
        index.push(shell[k] + count, shell[k + 2] + count, shell[k + 1] + count);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(corners, 3));
    geometry.setIndex(index);
    const mesh = new Mesh(geometry, this.paint(flex.material, flex.rgba, false));
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.frustumCulled = false;
    const update = () => {
      place(middle);
      plain.computeVertexNormals();
      const normals = plain.getAttribute("normal").array;
      for (let k = 0; k < middle.length; k++) {
        corners[k] = middle[k] + radius * normals[k];
        if (both) {
          corners[middle.length + k] = middle[k] - radius * normals[k];
        }
      }
      geometry.getAttribute("position").needsUpdate = true;
      geometry.computeVertexNormals();
      geometry.computeBoundingSphere();
    };
    return { object: mesh, update };
  }

  private rope(flex: Flex): { object: Object3D; update: () => void } {
    const { edges, place } = this.flex(flex);
    const corners = new Float32Array(3 * flex.count);
    const rods = new Rods(this.paint(flex.material, flex.rgba, false), flex.edges, false);
    return {
      object: rods.root,
      update: () => {
        place(corners);
        rods.place(ends(corners, edges), flex.radius);
      },
    };
  }

  private tendon(index: number): { object: Object3D; update: () => void } {
    const { tendon } = this.model.scene;
    const most = Math.max(
      tendon.count[index] - 1,
      ...this.model.scene.poses.map((each) => each.tendons[index].length / 6),
    );
    const rods = new Rods(
      this.paint(tendon.material[index], row(tendon.rgba, index, 4), false),
      Math.max(1, most, 2 * tendon.count[index]),
    );
    return { object: rods.root, update: () => rods.place(this.way(index), tendon.width[index]) };
  }

  /**
   * The straight pieces of a tendon; away from a known pose, the pieces from site to site, without the geoms that it
   * wraps around.
   */
  private way(index: number): number[] {
    const { scene } = this.model;
    const { tendon, wrap, site } = scene;
    if (this.seen) {
      return this.seen.tendons[index];
    }
    const pieces: number[] = [];
    let last: number[] | null = null;
    for (let k = tendon.first[index]; k < tendon.first[index] + tendon.count[index]; k++) {
      if (wrap.type[k] === PULLEY) {
        last = null;
      }
      if (wrap.type[k] !== SITE) {
        continue;
      }
      const number = wrap.object[k];
      const b = site.body[number];
      const moved = rotated(this.pose.quat, 4 * b, site.pos, 3 * number);
      const here = moved.map((each, axis) => each + this.pose.pos[3 * b + axis]);
      if (last) {
        pieces.push(...last, ...here);
      }
      last = here;
    }
    return pieces;
  }

  update(): void {
    for (const soft of this.all) {
      if (soft.object.visible) {
        soft.update();
      }
    }
  }

  show(kind: string, visible: (group: number) => boolean): void {
    for (const soft of this.all) {
      if (soft.kind === kind) {
        soft.object.visible = visible(soft.group);
      }
    }
  }

  targets(): Object3D[] {
    const meshes: Object3D[] = [];
    for (const soft of this.all) {
      if (soft.object.visible) {
        soft.object.traverse((part) => {
          if (part instanceof Mesh) {
            meshes.push(part);
          }
        });
      }
    }
    return meshes;
  }

  element(object: Object3D, _instance?: number): Element | null {
    for (const { object: root, kind, index } of this.all) {
      let up: Object3D | null = object;
      while (up && up !== root) {
        up = up.parent;
      }
      if (up) {
        return { kind, index };
      }
    }
    return null;
  }

  box(): Box3 {
    const bounds = new Box3();
    for (const { object, kind } of this.all) {
      if (object.visible && kind !== "tendon") {
        bounds.expandByObject(object);
      }
    }
    return bounds;
  }

  dispose(): void {
    this.root.traverse((each) => {
      if (each instanceof Mesh) {
        each.geometry.dispose();
      }
    });
  }
}

/** Round rods between points, and balls at their ends. */
class Rods {
  readonly root = new Group();
  private readonly rods: InstancedMesh;
  private readonly balls: InstancedMesh;

  /** Whether the ends are `round`: MuJoCo has plain cylinders for ropes. */
  constructor(paint: MeshPhongMaterial, most: number, round = true) {
    this.rods = new InstancedMesh(new CylinderGeometry(1, 1, 1, 16).rotateX(Math.PI / 2), paint, most);
    this.balls = new InstancedMesh(new SphereGeometry(1, 16, 10), paint, 2 * most);
    for (const mesh of [this.rods, this.balls]) {
      mesh.frustumCulled = false;
      mesh.castShadow = true;
    }
    this.root.add(this.rods);
    if (round) {
      this.root.add(this.balls);
    }
  }

  place(corners: number[], radius: number): void {
    const a = new Vector3();
    const b = new Vector3();
    const along = new Vector3();
    const turn = new Quaternion();
    const matrix = new Matrix4();
    const up = new Vector3(0, 0, 1);
    const still = new Quaternion();
    const count = Math.min(corners.length / 6, this.rods.instanceMatrix.count);
    for (let k = 0; k < count; k++) {
      a.fromArray(corners, 6 * k);
      b.fromArray(corners, 6 * k + 3);
      along.subVectors(b, a);
      const length = along.length();
      turn.setFromUnitVectors(up, length > 1e-12 ? along.divideScalar(length) : up);
      this.rods.setMatrixAt(
        k,
        matrix.compose(a.clone().add(b).multiplyScalar(0.5), turn, new Vector3(radius, radius, Math.max(length, 1e-9))),
      );
      this.balls.setMatrixAt(2 * k, matrix.compose(a, still, new Vector3(radius, radius, radius)));
      this.balls.setMatrixAt(2 * k + 1, matrix.compose(b, still, new Vector3(radius, radius, radius)));
    }
    this.rods.count = count;
    this.balls.count = 2 * count;
    for (const mesh of [this.rods, this.balls]) {
      mesh.instanceMatrix.needsUpdate = true;
      mesh.boundingSphere = null;
    }
  }
}

const ends = (corners: Float32Array, edges: Uint32Array): number[] => {
  const points = new Array<number>(3 * edges.length);
  for (let k = 0; k < edges.length; k++) {
    for (let a = 0; a < 3; a++) {
      points[3 * k + a] = corners[3 * edges[k] + a];
    }
  }
  return points;
};

const xyzw = (q: ArrayLike<number>, i: number): [number, number, number, number] => [
  q[i + 1],
  q[i + 2],
  q[i + 3],
  q[i],
];
