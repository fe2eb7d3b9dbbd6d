// The drawings of a model beyond its surfaces: frames, joint axes, inertia boxes, contacts, cameras, and ghosts at
// other keyframes.
import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  ConeGeometry,
  CylinderGeometry,
  GridHelper,
  Group,
  InstancedMesh,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshPhongMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";
import { ConvexGeometry } from "three/examples/jsm/geometries/ConvexGeometry.js";
import { row } from "./data";
import { FREE, Pose, rotated, SLIDE } from "./kinematics";
import { MESH } from "./shapes";
import type { World } from "./world";

export const EXTRAS = [
  "frames",
  "axes",
  "inertia",
  "ellipsoids",
  "mass",
  "hulls",
  "contacts",
  "forces",
  "cameras",
  "grid",
] as const;
export type Extra = (typeof EXTRAS)[number];

const MOST_CONTACTS = 500;

/** The side of the squares of the grid. */
export const gridStep = (extent: number): number => 10 ** Math.round(Math.log10(extent / 8));

export class Extras {
  readonly root = new Group();
  private readonly shown = new Map<Extra, { group: Group; update: () => void }>();
  private readonly unit: number;

  constructor(private readonly world: World) {
    const { look } = world.model.scene;
    this.unit = Math.min(1.2 * look.meansize, 0.045 * look.extent) || 0.1;
  }

  set(name: Extra, visible: boolean): void {
    const now = this.shown.get(name);
    if (now) {
      this.root.remove(now.group);
    }
    this.shown.delete(name);
    if (!visible) {
      return;
    }
    const made = this[name]();
    this.shown.set(name, made);
    this.root.add(made.group);
    made.update();
  }

  update(): void {
    for (const { update } of this.shown.values()) {
      update();
    }
  }

  private lines(count: number): { group: Group; corners: Float32Array; colors: Float32Array; done: () => void } {
    const geometry = new BufferGeometry();
    const corners = new Float32Array(3 * count);
    const colors = new Float32Array(3 * count);
    geometry.setAttribute("position", new BufferAttribute(corners, 3));
    geometry.setAttribute("color", new BufferAttribute(colors, 3));
    const lines = new LineSegments(
      geometry,
      new LineBasicMaterial({ vertexColors: true, depthTest: false, transparent: true }),
    );
    lines.frustumCulled = false;
    lines.renderOrder = 4;
    const group = new Group();
    group.add(lines);
    return {
      group,
      corners,
      colors,
      done: () => {
        geometry.getAttribute("position").needsUpdate = true;
      },
    };
  }

  private frames() {
    const { pose } = this.world;
    const bodies = this.world.model.scene.body.name.length;
    const { group, corners, colors, done } = this.lines(6 * bodies);
    const axes = [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
    ];
    const tints = ["#ff5a5f", "#3ecf6b", "#4f8cff"];
    for (let b = 0; b < bodies; b++) {
      axes.forEach((_, a) => {
        for (const k of [0, 1]) {
          new Color(tints[a]).toArray(colors, 3 * (6 * b + 2 * a + k));
        }
      });
    }
    const update = () => {
      for (let b = 0; b < bodies; b++) {
        axes.forEach((axis, a) => {
          const along = rotated(pose.quat, 4 * b, axis, 0);
          const at = 3 * (6 * b + 2 * a);
          for (let k = 0; k < 3; k++) {
            corners[at + k] = pose.pos[3 * b + k];
            corners[at + 3 + k] = pose.pos[3 * b + k] + this.unit * 1.5 * along[k];
          }
        });
      }
      done();
    };
    return { group, update };
  }

  private axes() {
    const { joint } = this.world.model.scene;
    const { pose } = this.world;
    const some = joint.type
      .map((type: number, j: number) => (type === FREE ? -1 : j))
      .filter((j: number) => j >= 0) as number[];
    const group = new Group();
    const width = this.unit * 0.045;
    const length = this.unit * 2.2;
    const rod = new InstancedMesh(
      new CylinderGeometry(width, width, length, 10).rotateX(Math.PI / 2),
      overlay(0xffffff),
      some.length,
    );
    const tip = new InstancedMesh(
      new ConeGeometry(2.4 * width, 6 * width, 14).rotateX(Math.PI / 2),
      overlay(0xffffff),
      some.length,
    );
    some.forEach((j, at) => {
      const color = new Color(joint.type[j] === SLIDE ? "#3ecf6b" : "#ff9f2e");
      rod.setColorAt(at, color);
      tip.setColorAt(at, color);
    });
    for (const mesh of [rod, tip]) {
      mesh.frustumCulled = false;
      mesh.renderOrder = 4;
      group.add(mesh);
    }
    const update = () => {
      const matrix = new Matrix4();
      const turn = new Quaternion();
      const along = new Vector3();
      const place = new Vector3();
      const one = new Vector3(1, 1, 1);
      some.forEach((j, at) => {
        along.fromArray(pose.axis, 3 * j);
        turn.setFromUnitVectors(new Vector3(0, 0, 1), along);
        place.fromArray(pose.anchor, 3 * j);
        rod.setMatrixAt(at, matrix.compose(place, turn, one));
        tip.setMatrixAt(at, matrix.compose(place.addScaledVector(along, length / 2), turn, one));
      });
      for (const mesh of [rod, tip]) {
        mesh.instanceMatrix.needsUpdate = true;
      }
    };
    return { group, update };
  }

  private inertia() {
    return this.inertias(new BoxGeometry(2, 2, 2), 1.5);
  }

  /** Ellipsoids of uniform density with the mass and the inertia of the bodies. */
  private ellipsoids() {
    return this.inertias(new SphereGeometry(1, 24, 16), 2.5);
  }

  /** The shape whose half axes are the roots of `factor` times the share of the mass in their directions. */
  private inertias(shape: BufferGeometry, factor: number) {
    const { body } = this.world.model.scene;
    const group = new Group();
    const some = this.heavy();
    const boxes = new InstancedMesh(
      shape,
      new MeshPhongMaterial({ color: 0xe0507a, transparent: true, opacity: 0.45, depthWrite: false }),
      some.length,
    );
    boxes.frustumCulled = false;
    group.add(boxes);
    const local = some.map((b) => {
      const [x, y, z] = row(body.inertia, b, 3);
      const mass = body.mass[b];
      const half = [y + z - x, x + z - y, x + y - z].map((each) => Math.sqrt((Math.max(each, 1e-12) * factor) / mass));
      const [qw, qx, qy, qz] = row(body.iquat, b, 4);
      return new Matrix4().compose(
        new Vector3(...(row(body.ipos, b, 3) as [number, number, number])),
        new Quaternion(qx, qy, qz, qw),
        new Vector3(...(half as [number, number, number])),
      );
    });
    const update = () => {
      const matrix = new Matrix4();
      some.forEach((b, at) => boxes.setMatrixAt(at, matrix.multiplyMatrices(this.world.bodyMatrix(b), local[at])));
      boxes.instanceMatrix.needsUpdate = true;
    };
    return { group, update };
  }

  private heavy(): number[] {
    const { mass } = this.world.model.scene.body;
    return mass.flatMap((each: number, b: number) => (b > 0 && each > 0 ? [b] : []));
  }

  /** Balls at the centers of mass, in front of everything. */
  private mass() {
    const { body } = this.world.model.scene;
    const some = this.heavy();
    const group = new Group();
    const balls = new InstancedMesh(new SphereGeometry(this.unit * 0.16, 16, 10), overlay(0xe0507a), some.length);
    balls.frustumCulled = false;
    balls.renderOrder = 4;
    group.add(balls);
    const update = () => {
      const matrix = new Matrix4();
      some.forEach((b, at) => {
        const place = new Vector3().fromArray(body.ipos, 3 * b).applyMatrix4(this.world.bodyMatrix(b));
        balls.setMatrixAt(at, matrix.makeTranslation(place));
      });
      balls.instanceMatrix.needsUpdate = true;
    };
    return { group, update };
  }

  /** The convex hulls of meshes that collide: MuJoCo looks for contacts of these, and not of the meshes. */
  private hulls() {
    const { geom } = this.world.model.scene;
    const group = new Group();
    const drawn: { mesh: Mesh; index: number }[] = [];
    const forms = new Map<BufferGeometry, BufferGeometry>();
    const paint = new MeshPhongMaterial({ color: 0x14b8a6, transparent: true, opacity: 0.4, flatShading: true });
    for (const { mesh, members } of this.world.surfaces()) {
      for (const index of members) {
        if (geom.type[index] !== MESH || !(geom.contype[index] || geom.conaffinity[index])) {
          continue;
        }
        const form = forms.get(mesh.geometry) ?? hullOf(mesh.geometry);
        forms.set(mesh.geometry, form);
        const made = new Mesh(form, paint);
        made.matrixAutoUpdate = false;
        group.add(made);
        drawn.push({ mesh: made, index });
      }
    }
    const update = () => {
      for (const { mesh, index } of drawn) {
        this.world.matrixOf("geom", index, mesh.matrix);
      }
    };
    return { group, update };
  }

  private contacts() {
    const group = new Group();
    const r = this.unit * 0.22;
    const discs = new InstancedMesh(
      new CylinderGeometry(r, r, r * 0.3, 18).rotateX(Math.PI / 2),
      overlay(0xff3b6b),
      MOST_CONTACTS,
    );
    discs.frustumCulled = false;
    discs.renderOrder = 4;
    group.add(discs);
    const update = () => {
      const contacts = this.world.softs.seen?.contacts ?? [];
      const matrix = new Matrix4();
      const turn = new Quaternion();
      const one = new Vector3(1, 1, 1);
      discs.count = contacts.length;
      contacts.forEach((each, at) => {
        turn.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(each[5], each[6], each[7]));
        discs.setMatrixAt(at, matrix.compose(new Vector3(each[2], each[3], each[4]), turn, one));
      });
      discs.instanceMatrix.needsUpdate = true;
    };
    return { group, update };
  }

  /**
   * Forces of contacts. The square root of a force is a length: one as large as the weight of the model is as long as
   * half of it.
   */
  private forces() {
    const { body, look } = this.world.model.scene;
    const width = this.unit * 0.07;
    const most = 0.5 * look.extent;
    const weight = 9.81 * body.mass.reduce((sum: number, each: number) => sum + each, 0);
    const rod = new InstancedMesh(
      new CylinderGeometry(width, width, 1, 10).rotateX(Math.PI / 2).translate(0, 0, 0.5),
      overlay(0xf5a524),
      MOST_CONTACTS,
    );
    const tip = new InstancedMesh(
      new ConeGeometry(2.4 * width, 6 * width, 14).rotateX(Math.PI / 2),
      overlay(0xf5a524),
      MOST_CONTACTS,
    );
    const group = new Group();
    for (const mesh of [rod, tip]) {
      mesh.frustumCulled = false;
      mesh.renderOrder = 5;
      group.add(mesh);
    }
    const update = () => {
      const matrix = new Matrix4();
      const turn = new Quaternion();
      const along = new Vector3();
      const place = new Vector3();
      const one = new Vector3(1, 1, 1);
      let count = 0;
      for (const contact of this.world.softs.seen?.contacts ?? []) {
        const force = along.fromArray(contact, 8).length();
        const length = Math.min(most, most * Math.sqrt(force / weight));
        if (!(length > 0.1 * width)) {
          continue;
        }
        turn.setFromUnitVectors(new Vector3(0, 0, 1), along.normalize());
        place.fromArray(contact, 2);
        rod.setMatrixAt(count, matrix.compose(place, turn, new Vector3(1, 1, length)));
        tip.setMatrixAt(count++, matrix.compose(place.addScaledVector(along, length), turn, one));
      }
      for (const mesh of [rod, tip]) {
        mesh.count = count;
        mesh.instanceMatrix.needsUpdate = true;
      }
    };
    return { group, update };
  }

  /** Squares on the ground, whose side is a power of ten of a meter. */
  private grid() {
    const { extent, center } = this.world.model.scene.look;
    const group = new Group();
    const step = gridStep(extent);
    const half = Math.ceil((0.3 * extent) / step);
    for (const [cells, opacity] of [
      [20 * half, 0.4],
      [2 * half, 0.9],
    ]) {
      const lines = new GridHelper(20 * half * step, cells, 0x94a3b8, 0x94a3b8);
      lines.rotateX(Math.PI / 2);
      lines.position.set(
        10 * step * Math.round(center[0] / step / 10),
        10 * step * Math.round(center[1] / step / 10),
        0.002 * extent,
      );
      Object.assign(lines.material, { transparent: true, opacity, depthWrite: false });
      group.add(lines);
    }
    return { group, update: () => {} };
  }

  private cameras() {
    const { camera } = this.world.model.scene;
    const { pose } = this.world;
    const count = camera.name.length;
    const { group, corners, colors, done } = this.lines(16 * count);
    colors.fill(0.75);
    const eyes = new InstancedMesh(new SphereGeometry(this.unit * 0.12, 12, 8), overlay(0xbfc7d5), Math.max(1, count));
    eyes.frustumCulled = false;
    eyes.count = count;
    group.add(eyes);
    const update = () => {
      camera.fovy.forEach((fovy: number, index: number) => {
        const b = camera.body[index];
        const deep = this.unit * 2;
        const high = deep * Math.tan((fovy * Math.PI) / 360);
        const wide = (high * 4) / 3;
        const world = (v: number[]) => {
          const own = rotated(row(camera.quat, index, 4), 0, v, 0);
          const on = [0, 1, 2].map((k) => own[k] + camera.pos[3 * index + k]);
          return rotated(pose.quat, 4 * b, on, 0).map((each, k) => each + pose.pos[3 * b + k]);
        };
        const eye = world([0, 0, 0]);
        const rim = [
          [-wide, -high, -deep],
          [wide, -high, -deep],
          [wide, high, -deep],
          [-wide, high, -deep],
        ].map(world);
        const ends = rim.flatMap((each, k) => [...eye, ...each, ...each, ...rim[(k + 1) % 4]]);
        corners.set(ends, 48 * index);
        eyes.setMatrixAt(index, new Matrix4().makeTranslation(eye[0], eye[1], eye[2]));
      });
      eyes.instanceMatrix.needsUpdate = true;
      done();
    };
    return { group, update };
  }
}

function hullOf(form: BufferGeometry): BufferGeometry {
  const corners = form.getAttribute("position");
  return new ConvexGeometry(
    Array.from({ length: corners.count }, (_, k) => new Vector3().fromBufferAttribute(corners, k)),
  );
}

const overlay = (color: number) => new MeshBasicMaterial({ color, depthTest: false, transparent: true, opacity: 0.9 });

const GHOSTS = [0x3b82f6, 0xf59e0b, 0x10b981, 0xec4899, 0x8b5cf6, 0x14b8a6];

export class Ghosts {
  readonly root = new Group();
  private readonly shown = new Map<number, Group>();

  constructor(private readonly world: World) {}

  has(key: number): boolean {
    return this.shown.has(key);
  }

  color(key: number): string {
    return `#${GHOSTS[(key + 1) % GHOSTS.length].toString(16).padStart(6, "0")}`;
  }

  flip(key: number): void {
    const now = this.shown.get(key);
    if (now) {
      this.shown.delete(key);
      this.root.remove(now);
      return;
    }
    const { scene } = this.world.model;
    const pose = new Pose(scene);
    const group = new Group();
    pose.reset(key);
    const bodies = scene.body.name.map((_, b) =>
      new Matrix4().compose(
        new Vector3().fromArray(pose.pos, 3 * b),
        new Quaternion(pose.quat[4 * b + 1], pose.quat[4 * b + 2], pose.quat[4 * b + 3], pose.quat[4 * b]),
        new Vector3(1, 1, 1),
      ),
    );
    const paint = new MeshPhongMaterial({
      color: GHOSTS[(key + 1) % GHOSTS.length],
      transparent: true,
      opacity: 0.28,
      depthWrite: false,
      flatShading: true,
    });
    for (const { mesh, members, matrices } of this.world.surfaces()) {
      const some = members.filter((geom) => this.moves(scene.geom.body[geom]));
      if (!mesh.visible || !some.length) {
        continue;
      }
      const made = new InstancedMesh(mesh.geometry, paint, some.length);
      some.forEach((geom, at) =>
        made.setMatrixAt(at, new Matrix4().multiplyMatrices(bodies[scene.geom.body[geom]], matrices[geom])),
      );
      made.frustumCulled = false;
      made.renderOrder = 2;
      group.add(made);
    }
    this.shown.set(key, group);
    this.root.add(group);
  }

  private moves(body: number): boolean {
    const { body: columns, joint } = this.world.model.scene;
    for (let b = body; b > 0; b = columns.parent[b]) {
      if (columns.mocap[b] >= 0 || joint.body.includes(b)) {
        return true;
      }
    }
    return false;
  }
}
