// The poses of bodies at a configuration, like `mj_kinematics`, in double precision.
import type { Scene } from "./data";

export const FREE = 0,
  BALL = 1,
  SLIDE = 2,
  HINGE = 3;
export const WIDTHS = [7, 4, 1, 1];

type Numbers = Float64Array | number[];

/** out = a * b, quaternions w x y z; `out` may be one of them. */
export function multiply(out: Numbers, o: number, a: Numbers, i: number, b: Numbers, j: number): void {
  const [aw, ax, ay, az] = [a[i], a[i + 1], a[i + 2], a[i + 3]];
  const [bw, bx, by, bz] = [b[j], b[j + 1], b[j + 2], b[j + 3]];
  out[o] = aw * bw - ax * bx - ay * by - az * bz;
  out[o + 1] = aw * bx + ax * bw + ay * bz - az * by;
  out[o + 2] = aw * by - ax * bz + ay * bw + az * bx;
  out[o + 3] = aw * bz + ax * by - ay * bx + az * bw;
}

/** The vector at `v[j]` turned by the quaternion at `q[i]`. */
export function rotated(q: Numbers, i: number, v: Numbers, j: number): [number, number, number] {
  const [w, x, y, z] = [q[i], q[i + 1], q[i + 2], q[i + 3]];
  const [a, b, c] = [v[j], v[j + 1], v[j + 2]];
  const tx = 2 * (y * c - z * b),
    ty = 2 * (z * a - x * c),
    tz = 2 * (x * b - y * a);
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
}

function normalize(q: Float64Array, i: number): void {
  const length = Math.hypot(q[i], q[i + 1], q[i + 2], q[i + 3]);
  if (length < 1e-15) {
    q[i] = 1;
    q[i + 1] = q[i + 2] = q[i + 3] = 0;
    return;
  }
  for (let k = 0; k < 4; k++) q[i + k] /= length;
}

export class Pose {
  readonly qpos: Float64Array;
  readonly mpos: Float64Array;
  readonly mquat: Float64Array;
  /** Three and four numbers for each body, in the world. */
  readonly pos: Float64Array;
  readonly quat: Float64Array;
  /** One for each joint, in the world. */
  readonly anchor: Float64Array;
  readonly axis: Float64Array;
  private readonly of: number[][];

  constructor(readonly scene: Scene) {
    const bodies = scene.body.name.length,
      joints = scene.joint.name.length;
    this.qpos = Float64Array.from(scene.qpos0);
    this.pos = new Float64Array(3 * bodies);
    this.quat = new Float64Array(4 * bodies);
    this.anchor = new Float64Array(3 * joints);
    this.axis = new Float64Array(3 * joints);
    this.of = Array.from({ length: bodies }, () => []);
    scene.joint.body.forEach((body: number, joint: number) => this.of[body].push(joint));
    const mocap = Math.max(-1, ...scene.body.mocap) + 1;
    this.mpos = new Float64Array(3 * mocap);
    this.mquat = new Float64Array(4 * mocap);
    this.placeMocap();
    this.update();
  }

  private placeMocap(): void {
    const { mocap, pos, quat } = this.scene.body;
    mocap.forEach((number: number, body: number) => {
      if (number < 0) return;
      for (let k = 0; k < 3; k++) this.mpos[3 * number + k] = pos[3 * body + k];
      for (let k = 0; k < 4; k++) this.mquat[4 * number + k] = quat[4 * body + k];
    });
  }

  /** The reference configuration, or a keyframe. */
  reset(key: number): void {
    const { qpos, mpos, mquat } = this.scene.key;
    if (key < 0) {
      this.qpos.set(this.scene.qpos0);
      this.placeMocap();
    } else {
      this.qpos.set(qpos.slice(key * this.qpos.length, (key + 1) * this.qpos.length));
      this.mpos.set(mpos.slice(key * this.mpos.length, (key + 1) * this.mpos.length));
      this.mquat.set(mquat.slice(key * this.mquat.length, (key + 1) * this.mquat.length));
    }
    this.update();
  }

  update(): void {
    const { body, joint, qpos0 } = this.scene;
    const { pos, quat, qpos, anchor, axis } = this;
    quat[0] = 1;
    const turn = new Float64Array(4);
    for (let b = 1; b < body.name.length; b++) {
      const p = body.parent[b],
        mocap = body.mocap[b],
        joints = this.of[b];
      if (joints.length === 1 && joint.type[joints[0]] === FREE) {
        const q = joint.qpos[joints[0]];
        for (let k = 0; k < 3; k++) pos[3 * b + k] = anchor[3 * joints[0] + k] = qpos[q + k];
        for (let k = 0; k < 4; k++) quat[4 * b + k] = qpos[q + 3 + k];
        axis[3 * joints[0]] = axis[3 * joints[0] + 1] = 0;
        axis[3 * joints[0] + 2] = 1;
        normalize(quat, 4 * b);
        continue;
      }
      const own: Numbers = mocap >= 0 ? this.mpos : body.pos,
        first = 3 * (mocap >= 0 ? mocap : b);
      const turned: Numbers = mocap >= 0 ? Array.from(this.mquat.slice(4 * mocap, 4 * mocap + 4)) : body.quat;
      const moved = rotated(quat, 4 * p, own, first);
      for (let k = 0; k < 3; k++) pos[3 * b + k] = pos[3 * p + k] + moved[k];
      multiply(quat, 4 * b, quat, 4 * p, turned, mocap >= 0 ? 0 : 4 * b);
      if (mocap >= 0) normalize(quat, 4 * b);
      for (const j of joints) {
        const at = rotated(quat, 4 * b, joint.pos, 3 * j),
          along = rotated(quat, 4 * b, joint.axis, 3 * j);
        for (let k = 0; k < 3; k++) {
          anchor[3 * j + k] = pos[3 * b + k] + at[k];
          axis[3 * j + k] = along[k];
        }
        const q = joint.qpos[j],
          type = joint.type[j];
        if (type === SLIDE) {
          for (let k = 0; k < 3; k++) pos[3 * b + k] += along[k] * (qpos[q] - qpos0[q]);
          continue;
        }
        if (type === BALL) {
          for (let k = 0; k < 4; k++) turn[k] = qpos[q + k];
          normalize(turn, 0);
        } else {
          const half = (qpos[q] - qpos0[q]) / 2,
            sine = Math.sin(half);
          turn[0] = Math.cos(half);
          for (let k = 0; k < 3; k++) turn[k + 1] = joint.axis[3 * j + k] * sine;
        }
        multiply(quat, 4 * b, quat, 4 * b, turn, 0);
        const back = rotated(quat, 4 * b, joint.pos, 3 * j);
        for (let k = 0; k < 3; k++) pos[3 * b + k] = anchor[3 * j + k] - back[k];
      }
      normalize(quat, 4 * b);
    }
  }
}
