// The poses of bodies at a configuration, like `mj_kinematics`, in double precision.
import type { Scene } from "./data";

export const FREE = 0;
export const BALL = 1;
export const SLIDE = 2;
export const HINGE = 3;
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
  const tx = 2 * (y * c - z * b);
  const ty = 2 * (z * a - x * c);
  const tz = 2 * (x * b - y * a);
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
}

function normalize(q: Float64Array, i: number): void {
  const length = Math.hypot(q[i], q[i + 1], q[i + 2], q[i + 3]);
  if (length < 1e-15) {
    q[i] = 1;
    q[i + 1] = q[i + 2] = q[i + 3] = 0;
    return;
  }
  for (let k = 0; k < 4; k++) {
    q[i + k] /= length;
  }
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
    const bodies = scene.body.name.length;
    const joints = scene.joint.name.length;
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
      if (number < 0) {
        return;
      }
      for (let k = 0; k < 3; k++) {
        this.mpos[3 * number + k] = pos[3 * body + k];
      }
      for (let k = 0; k < 4; k++) {
        this.mquat[4 * number + k] = quat[4 * body + k];
      }
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

  /** The places of all bodies and joints for `qpos`, `mpos` and `mquat`, as MuJoCo's mj_kinematics computes them. */
  update(): void {
    const { body, joint } = this.scene;
    this.quat[0] = 1;
    for (let b = 1; b < body.name.length; b++) {
      const joints = this.of[b];
      if (joints.length === 1 && joint.type[joints[0]] === FREE) {
        this.float(b, joints[0]);
        continue;
      }
      this.follow(b);
      for (const j of joints) {
        this.move(b, j);
      }
      normalize(this.quat, 4 * b);
    }
  }

  /** A body with a free joint is where the joint has it. */
  private float(b: number, j: number): void {
    const { pos, quat, qpos, anchor, axis } = this;
    const q = this.scene.joint.qpos[j];
    for (let k = 0; k < 3; k++) {
      pos[3 * b + k] = qpos[q + k];
      anchor[3 * j + k] = qpos[q + k];
    }
    for (let k = 0; k < 4; k++) {
      quat[4 * b + k] = qpos[q + 3 + k];
    }
    axis.set([0, 0, 1], 3 * j);
    normalize(quat, 4 * b);
  }

  /** A body follows its parent, before its joints move it. */
  private follow(b: number): void {
    const { pos, quat } = this;
    const { body } = this.scene;
    const p = body.parent[b];
    const mocap = body.mocap[b];
    const isMocap = mocap >= 0;
    const own: Numbers = isMocap ? this.mpos : body.pos;
    const turned: Numbers = isMocap ? Array.from(this.mquat.slice(4 * mocap, 4 * mocap + 4)) : body.quat;
    const moved = rotated(quat, 4 * p, own, 3 * (isMocap ? mocap : b));
    for (let k = 0; k < 3; k++) {
      pos[3 * b + k] = pos[3 * p + k] + moved[k];
    }
    multiply(quat, 4 * b, quat, 4 * p, turned, isMocap ? 0 : 4 * b);
    if (isMocap) {
      normalize(quat, 4 * b);
    }
  }

  /** A hinge, a ball or a slide moves its body. */
  private move(b: number, j: number): void {
    const { joint, qpos0 } = this.scene;
    const { pos, quat, qpos, anchor, axis } = this;
    const q = joint.qpos[j];
    const at = rotated(quat, 4 * b, joint.pos, 3 * j);
    const along = rotated(quat, 4 * b, joint.axis, 3 * j);
    for (let k = 0; k < 3; k++) {
      anchor[3 * j + k] = pos[3 * b + k] + at[k];
      axis[3 * j + k] = along[k];
    }
    if (joint.type[j] === SLIDE) {
      for (let k = 0; k < 3; k++) {
        pos[3 * b + k] += along[k] * (qpos[q] - qpos0[q]);
      }
      return;
    }
    multiply(quat, 4 * b, quat, 4 * b, this.turn(j), 0);
    // The anchor of a joint stays where it is.
    const back = rotated(quat, 4 * b, joint.pos, 3 * j);
    for (let k = 0; k < 3; k++) {
      pos[3 * b + k] = anchor[3 * j + k] - back[k];
    }
  }

  /** The rotation of a hinge or a ball, as a quaternion. */
  private turn(j: number): Float64Array {
    const { joint, qpos0 } = this.scene;
    const q = joint.qpos[j];
    if (joint.type[j] === BALL) {
      const turn = this.qpos.slice(q, q + 4);
      normalize(turn, 0);
      return turn;
    }
    const half = (this.qpos[q] - qpos0[q]) / 2;
    const sine = Math.sin(half);
    const [x, y, z] = joint.axis.slice(3 * j, 3 * j + 3);
    return Float64Array.of(Math.cos(half), x * sine, y * sine, z * sine);
  }
}
