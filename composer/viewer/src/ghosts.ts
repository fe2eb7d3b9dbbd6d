// The model at other keyframes, transparent.
import { Group, InstancedMesh, Matrix4, MeshPhongMaterial, Quaternion, Vector3 } from "three";
import { Pose } from "./kinematics";
import type { World } from "./world";

const COLORS = [0x3b82f6, 0xf59e0b, 0x10b981, 0xec4899, 0x8b5cf6, 0x14b8a6];

export class Ghosts {
  readonly root = new Group();
  private readonly shown = new Map<number, Group>();

  constructor(private readonly world: World) {}

  has(key: number): boolean {
    return this.shown.has(key);
  }

  color(key: number): string {
    return `#${COLORS[(key + 1) % COLORS.length].toString(16).padStart(6, "0")}`;
  }

  flip(key: number): void {
    const now = this.shown.get(key);
    if (now) {
      this.shown.delete(key);
      this.root.remove(now);
      return;
    }
    const { scene } = this.world.model, pose = new Pose(scene), group = new Group();
    pose.reset(key);
    const bodies = scene.body.name.map((_, b) => new Matrix4().compose(new Vector3().fromArray(pose.pos, 3 * b), new Quaternion(pose.quat[4 * b + 1], pose.quat[4 * b + 2], pose.quat[4 * b + 3], pose.quat[4 * b]), new Vector3(1, 1, 1)));
    const paint = new MeshPhongMaterial({ color: COLORS[(key + 1) % COLORS.length], transparent: true, opacity: 0.28, depthWrite: false, flatShading: true });
    for (const { mesh, members, matrices } of this.world.surfaces()) {
      const some = members.filter((geom) => this.moves(scene.geom.body[geom]));
      if (!mesh.visible || !some.length) continue;
      const made = new InstancedMesh(mesh.geometry, paint, some.length);
      some.forEach((geom, at) => made.setMatrixAt(at, new Matrix4().multiplyMatrices(bodies[scene.geom.body[geom]], matrices[geom])));
      made.frustumCulled = false;
      made.renderOrder = 2;
      group.add(made);
    }
    this.shown.set(key, group);
    this.root.add(group);
  }

  private moves(body: number): boolean {
    const { body: columns, joint } = this.world.model.scene;
    for (let b = body; b > 0; b = columns.parent[b]) if (columns.mocap[b] >= 0 || joint.body.includes(b)) return true;
    return false;
  }
}
