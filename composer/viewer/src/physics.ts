// MuJoCo in the page: its own WebAssembly steps the model that the page shows.
import loadMujoco from "@mujoco/mujoco";
import type { App } from "./app";
import type { Model, Pull, Seen } from "./data";
import { Past } from "./past";
import type { Player } from "./player";

/** No frame may take longer than this, in seconds of physics and in milliseconds: a slow machine plays slowly. */
const MOST = 1 / 8;
const MOST_MILLISECONDS = 50;
/** How often a pull follows the body, in seconds of physics. */
const PULL = 1 / 100;
const WASM = "mujoco.wasm";
const MODEL = "model.xml";

const MOST_CONTACTS = 500;
const PULLEY = -2;

const cross = (a: ArrayLike<number>, b: ArrayLike<number>): number[] => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

class Physics implements Player {
  private engine: any = null;
  private model: any = null;
  private data: any = null;
  private warnings: { kind: number; word: string; firsts: number[] }[] = [];
  private playing = false;
  private speed = 1;
  private readonly past = new Past();
  /** The warnings at which it has paused already. */
  private readonly heard = new Set<string>();
  private before = 0;
  private pulled: Pull | null = null;
  private force: any = null;

  constructor(
    private readonly app: App,
    private readonly packed: Model,
  ) {}

  play = (): void => {
    void this.flip();
  };

  step = (): void => {
    void this.tried(() => {
      this.pause();
      this.start();
      this.advance(this.data.time + 0.5 * this.model.opt.timestep);
    });
  };

  reset = (key: number): void => {
    if (this.data) {
      this.rewind(key);
      this.pose();
      this.app.time.clear();
    }
  };

  back = (time: number): void => {
    this.pause();
    const state = this.past.at(time);
    if (!state) {
      return;
    }
    const { data } = this;
    data.qpos.set(state.qpos);
    data.qvel.set(state.qvel);
    data.act.set(state.act);
    data.ctrl.set(state.ctrl);
    data.time = state.time;
    this.tell(state.seen);
  };

  setSpeed = (speed: number): void => {
    this.speed = speed;
    this.app.time.setSpeed(speed);
  };

  /** A slider has changed the pose or the controls. */
  pose = (): void => {
    if (!this.data) {
      return;
    }
    this.data.qpos.set(this.app.world.pose.qpos);
    this.data.ctrl.set(this.app.sliders.ctrl);
    if (this.data.mocap_pos.length) {
      this.data.mocap_pos.set(this.app.world.pose.mpos);
      this.data.mocap_quat.set(this.app.world.pose.mquat);
    }
  };

  choose = (): void => {};

  pull = (pull: Pull | null): void => {
    this.pulled = pull;
  };

  /** The results of MuJoCo for a pose, if it runs in the page already. */
  look = (): void => {
    if (!this.data || this.playing) {
      return;
    }
    this.pose();
    this.engine.mj_forward(this.model, this.data);
    this.app.see(this.seen());
    this.app.posed();
  };

  private async flip(): Promise<void> {
    if (this.playing) {
      return this.pause();
    }
    await this.tried(() => {
      this.start();
      this.playing = true;
      this.app.setPlaying(true);
      this.before = performance.now();
      requestAnimationFrame(this.frame);
    });
  }

  /** Do something with the model, which is loaded when it is needed first. */
  private async tried(act: () => void): Promise<void> {
    try {
      if (!this.data) {
        await this.load();
      }
      act();
    } catch (error) {
      this.app.notice(`the page's MuJoCo cannot load the model: ${error instanceof Error ? error.message : error}`);
    }
  }

  private pause(): void {
    this.playing = false;
    this.app.setPlaying(false);
  }

  private async load(): Promise<void> {
    this.app.notice("starting MuJoCo");
    const program = URL.createObjectURL(new Blob([this.packed.blobs.get(WASM)!], { type: "application/wasm" }));
    this.engine = await loadMujoco({ locateFile: () => program } as any);
    URL.revokeObjectURL(program);
    const files = new this.engine.MjVFS();
    for (const [name, content] of this.packed.blobs) {
      if (name !== WASM && name !== MODEL) {
        files.addBuffer(name, new Uint8Array(content));
      }
    }
    this.model = this.engine.MjModel.from_xml_string(new TextDecoder().decode(this.packed.blobs.get(MODEL)!), files);
    if (this.model.nq !== this.app.world.pose.qpos.length) {
      throw new Error("it compiles to another model there");
    }
    this.data = new this.engine.MjData(this.model);
    this.force = new this.engine.DoubleBuffer(6);
    const { mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC } = this.engine.mjtWarning;
    const { jnt_qposadr, jnt_dofadr } = this.model;
    this.warnings = [
      [mjWARN_BADQPOS, "position", jnt_qposadr],
      [mjWARN_BADQVEL, "velocity", jnt_dofadr],
      [mjWARN_BADQACC, "acceleration", jnt_dofadr],
    ].map(([kind, word, firsts]) => ({ kind: kind.value, word, firsts: Array.from(firsts as Int32Array) }));
  }

  /**
   * Go on from where it paused, if the page still shows that pose. Otherwise begin at the pose of the page, at rest; at
   * a keyframe, with the velocities that it has.
   */
  private start(): void {
    const { qpos } = this.app.world.pose;
    const isSame = this.past.range !== null && qpos.every((value, k) => value === this.data.qpos[k]);
    if (!isSame) {
      this.rewind(this.app.poses.key);
    }
    this.pose();
  }

  private rewind(key: number): void {
    if (key >= 0) {
      this.engine.mj_resetDataKeyframe(this.model, this.data, key);
    } else {
      this.engine.mj_resetData(this.model, this.data);
    }
    this.past.clear();
    this.heard.clear();
  }

  private readonly frame = (now: number): void => {
    if (!this.playing) {
      return;
    }
    const end = this.data.time + this.speed * Math.min((now - this.before) / 1000, MOST);
    this.before = now;
    this.advance(end);
    if (this.playing) {
      requestAnimationFrame(this.frame);
    }
  };

  /** Step until a time, and show the state. */
  private advance(end: number): void {
    // A browser that is busy calls late, so the time of the call does not count.
    const begun = performance.now();
    let pull = -Infinity;
    // MuJoCo sets a simulation that diverges back to the time 0, so the steps are counted.
    const timestep = this.model.opt.timestep;
    for (
      let left = Math.ceil((this.speed * MOST) / timestep) + 1;
      left > 0 && this.data.time < end && performance.now() - begun < MOST_MILLISECONDS;
      left--
    ) {
      if (this.data.time - pull >= PULL) {
        pull = this.data.time;
        this.drag();
      }
      this.engine.mj_step(this.model, this.data);
    }
    const stopped = timestep > 0 ? this.diverged() : "the timestep of the model is 0, so no time passes";
    if (stopped !== null) {
      this.past.clear();
      this.pause();
      this.app.banner.setStopped(stopped);
      return;
    }
    const { qpos, qvel, act, ctrl, time } = this.data;
    const seen = this.seen();
    const copies = [qpos, qvel, act, ctrl].map((each) => Float64Array.from(each));
    this.past.add({ qpos: copies[0], qvel: copies[1], act: copies[2], ctrl: copies[3], time, seen });
    this.tell(seen);
    const warned = this.warned();
    if (warned.length) {
      this.pause();
      this.app.banner.setWarned(warned);
    }
  }

  private tell(seen: Seen): void {
    const { qpos, ctrl, time } = this.data;
    this.app.setShot({ qpos, ctrl, time, seen, kept: this.past.range });
  }

  /** The warnings of a kind that has not been heard before. */
  private warned(): string[] {
    const kinds = Object.entries(this.engine.mjtWarning).filter(([kind]) => /^mjWARN/.test(kind));
    return kinds.flatMap(([kind, { value }]: [string, any]) => {
      const warning = this.data.warning.get(value);
      const { number, lastinfo } = warning;
      warning.delete();
      if (!number || this.heard.has(kind)) {
        return [];
      }
      this.heard.add(kind);
      return [this.engine.mju_warningText(value, lastinfo)];
    });
  }

  private seen(): Seen {
    const contacts: number[][] = [];
    const all = this.data.contact;
    const count = Math.min(all.size(), MOST_CONTACTS);
    for (let k = 0; k < count; k++) {
      const each = all.get(k);
      const frame = each.frame;
      this.engine.mj_contactForce(this.model, this.data, k, this.force);
      const own = this.force.GetView();
      const along = [0, 1, 2].map((axis) => own[0] * frame[axis] + own[1] * frame[3 + axis] + own[2] * frame[6 + axis]);
      contacts.push([...each.geom, ...each.pos, frame[0], frame[1], frame[2], ...along]);
      each.delete();
    }
    all.delete();
    return { contacts, tendons: this.ways(), sensors: Array.from(this.data.sensordata) };
  }

  /** The straight pieces of tendons. */
  private ways(): number[][] {
    const { ten_wrapadr: first, ten_wrapnum: count, wrap_obj: object, wrap_xpos: place } = this.data;
    return Array.from(first as Int32Array, (start, tendon) => {
      const numbers: number[] = [];
      for (let k = start; k < start + count[tendon] - 1; k++) {
        if (object[k] !== PULLEY && object[k + 1] !== PULLEY) {
          numbers.push(...place.slice(3 * k, 3 * k + 6));
        }
      }
      return numbers;
    });
  }

  /** The pull of the mouse: `pull` in `composer/mjcompose/mujoco/scene.py`. */
  private drag(): void {
    const { data, model, pulled } = this;
    data.xfrc_applied.fill(0);
    if (!pulled) {
      return;
    }
    this.engine.mj_fwdPosition(model, data);
    this.engine.mj_fwdVelocity(model, data);
    const { body, to } = pulled;
    const turn = data.xmat.slice(9 * body, 9 * body + 9);
    const own = pulled.at;
    const root = model.body_rootid[body];
    const at = [0, 1, 2].map(
      (k) => data.xpos[3 * body + k] + turn[3 * k] * own[0] + turn[3 * k + 1] * own[1] + turn[3 * k + 2] * own[2],
    );
    const turning = data.cvel.slice(6 * body, 6 * body + 3);
    const arm = at.map((each, k) => each - data.subtree_com[3 * root + k]);
    const swung = cross(turning, arm);
    const weight = 1 / Math.max(model.body_invweight0[2 * body], 1e-9);
    const { stiffness } = this.app.world.model.scene.look;
    const force = at.map(
      (each, k) =>
        weight * (stiffness * (to[k] - each) - 2 * Math.sqrt(stiffness) * (data.cvel[6 * body + 3 + k] + swung[k])),
    );
    const torque = cross(
      at.map((each, k) => each - data.xipos[3 * body + k]),
      force,
    );
    data.xfrc_applied.set([...force, ...torque], 6 * body);
  }

  /** Which number became NaN, infinite, or larger than MuJoCo accepts. */
  private diverged(): string | null {
    for (const { kind, word, firsts } of this.warnings) {
      const warning = this.data.warning.get(kind);
      const { number, lastinfo } = warning; // a copy of a part of the data, which is not to be deleted itself
      warning.delete();
      if (!number) {
        continue;
      }
      const at = firsts.filter((first) => first <= lastinfo).length - 1;
      const name = this.app.world.model.scene.joint.name[at];
      return `unstable: NaN or a huge ${word} in joint ${name ? `\`${name}\`` : `${at}, which has no name`}`;
    }
    return null;
  }
}

(window as any).mjcomposePhysics = Physics;
