// MuJoCo in the page: its own WebAssembly steps the model that the page shows.
import loadMujoco from "@mujoco/mujoco";
import type { App } from "./app";
import type { Model } from "./data";

/** No frame may take longer than this, in seconds of physics: a slow machine plays slowly. */
const MOST = 1 / 30;
const WASM = "mujoco.wasm", MODEL = "model.xml";

class Physics {
  private engine: any = null;
  private model: any = null;
  private data: any = null;
  private playing = false;
  private before = 0;

  constructor(private readonly app: App, private readonly packed: Model) {}

  play = (): void => { void this.flip(); };

  /** A slider or a keyframe has changed the pose or the controls. */
  pose = (): void => {
    if (!this.data) return;
    this.data.qpos.set(this.app.world.pose.qpos);
    this.data.ctrl.set(this.app.sliders.ctrl);
    if (this.data.mocap_pos.length) {
      this.data.mocap_pos.set(this.app.world.pose.mpos);
      this.data.mocap_quat.set(this.app.world.pose.mquat);
    }
  };

  choose = (): void => {};

  private async flip(): Promise<void> {
    try {
      if (!this.data) await this.load();
      this.playing = !this.playing;
      this.app.setPlaying(this.playing);
      if (!this.playing) return;
      this.start();
      this.before = performance.now();
      requestAnimationFrame(this.frame);
    } catch (error) {
      this.app.notice(`the page's MuJoCo cannot load the model: ${error instanceof Error ? error.message : error}`);
    }
  }

  private async load(): Promise<void> {
    this.app.notice("starting MuJoCo");
    const program = URL.createObjectURL(new Blob([this.packed.blobs.get(WASM)!], { type: "application/wasm" }));
    this.engine = await loadMujoco({ locateFile: () => program } as any);
    URL.revokeObjectURL(program);
    const files = new this.engine.MjVFS();
    for (const [name, content] of this.packed.blobs) if (name !== WASM && name !== MODEL) files.addBuffer(name, new Uint8Array(content));
    this.model = this.engine.MjModel.from_xml_string(new TextDecoder().decode(this.packed.blobs.get(MODEL)!), files);
    if (this.model.nq !== this.app.world.pose.qpos.length) throw new Error("it compiles to another model there");
    this.data = new this.engine.MjData(this.model);
  }

  /** From the pose of the page, at rest; from a keyframe with the velocities that it has. */
  private start(): void {
    const { key } = this.app;
    if (key >= 0) this.engine.mj_resetDataKeyframe(this.model, this.data, key);
    else this.engine.mj_resetData(this.model, this.data);
    this.pose();
  }

  private readonly frame = (now: number): void => {
    if (!this.playing) return;
    const end = this.data.time + Math.min((now - this.before) / 1000, MOST);
    this.before = now;
    while (this.data.time < end) this.engine.mj_step(this.model, this.data);
    this.app.setQpos(this.data.qpos);
    requestAnimationFrame(this.frame);
  };
}

(window as any).mjcomposePhysics = Physics;
