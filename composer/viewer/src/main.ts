// The start of the page: from the models in its file, or from a server.
import { App } from "./app";
import { embedded, type Model, type Scene, unpacked } from "./data";
import { h } from "./dom";
import { Gizmo } from "./gizmo";
import { elementAt, Http, host, type Wire } from "./wire";

/** How long the controls of this page win over those of states on the way, in milliseconds. */
const HOLD = 300;

export class Live {
  private readonly wire: Wire = host ?? new Http();
  private readonly blobs = new Map<string, ArrayBuffer>();
  private playing = false;
  private loading: Promise<void> = Promise.resolve();
  private version = -1;
  private looking: "asked" | "again" | null = null;
  private readonly page = Math.random().toString(36).slice(2);
  private count = 0;
  private looked = "";
  /** The values that a build does not have yet. */
  private readonly wanted = new Map<string, string | number>();
  /** A state that came before its model. */
  private early: any = null;
  /** When this page last sent its controls: states that are on the way have older ones. */
  private controlled = -Infinity;

  constructor(private readonly app: App) {
    const post = (path: string, data: unknown) => void this.wire.post(path, data);
    app.server = {
      play: () => post("play", { playing: !this.playing, ...this.state() }),
      step: () => post("step", this.state()),
      reset: (key) => post("reset", { key }),
      back: (time) => post("back", { time }),
      setSpeed: (speed) => post("speed", { speed }),
      pose: () => {
        if (this.playing) {
          this.controlled = performance.now();
          post("pose", { ctrl: app.sliders.ctrl });
        }
      },
      look: () => this.look(),
      pull: (pull) => post("pull", pull ?? {}),
      choose: (name, value) => void this.choose(name, value),
    };
    if (this.wire.ask) {
      const gizmo = new Gizmo(app, (request) => this.wire.ask!("change", request));
      app.gizmo = gizmo;
      app.banner.fix = ({ text }) => void gizmo.fix(text);
    }
    this.wire.listen(
      (name, data) => this.take(name, data),
      () => app.banner.setLost(true),
    );
    host?.follow(
      (name) => app.theme(name),
      (files, places) => {
        const element = this.version >= 0 && elementAt(app.world.model.scene, files, places, app.selection);
        if (element) {
          app.select(element, true);
        }
      },
    );
  }

  /** Build with other values: one build at a time, and always the newest value of each name. */
  private async choose(name: string, value: string | number): Promise<void> {
    const isUnderWay = this.wanted.size > 0;
    this.wanted.set(name, value);
    if (isUnderWay) {
      return;
    }
    while (this.wanted.size) {
      const [next, newest] = [...this.wanted][0];
      await this.wire.post("choose", { name: next, value: newest }).catch(() => {});
      if (this.wanted.get(next) === newest) {
        this.wanted.delete(next);
      }
    }
  }

  /** The state from which the physics start. */
  private state(): Record<string, unknown> {
    const { world, sliders, poses } = this.app;
    const { qpos, mpos, mquat } = world.pose;
    return {
      qpos: Array.from(qpos),
      ctrl: sliders.ctrl,
      mocap_pos: Array.from(mpos),
      mocap_quat: Array.from(mquat),
      key: poses.key,
    };
  }

  /** Ask for the results of MuJoCo for the pose, once at a time. */
  private look(): void {
    if (this.looking) {
      this.looking = "again";
      return;
    }
    this.looking = "asked";
    const { pose } = this.app.world;
    this.looked = `${this.page} ${++this.count}`;
    void this.wire
      .post("look", {
        version: this.version,
        looked: this.looked,
        qpos: Array.from(pose.qpos),
        ctrl: this.app.sliders.ctrl,
      })
      .finally(() => {
        const again = this.looking === "again";
        this.looking = null;
        if (again) {
          this.look();
        }
      });
  }

  private take(name: string, data: any): void {
    this.app.banner.setLost(false);
    if (name === "model") {
      this.loading = this.loading
        .then(() => this.load(data.version))
        .catch((error: Error) => this.app.notice(error.message));
    } else if (name === "fault") {
      this.app.setFault(data.text, data.rows ?? []);
    } else if (name === "state" && data.looked !== undefined) {
      const isOurs = data.looked === this.looked && data.version === this.version;
      if (isOurs && !this.playing && this.app.poses.at === null) {
        this.app.see(data.seen);
        this.app.posed();
      }
    } else if (name === "state") {
      this.takeState(data);
    }
  }

  /** A state of the physics, which all pages show. */
  private takeState(data: any): void {
    const { app } = this;
    const { playing, speed, version, qpos, key, stopped, warned } = data;
    if (version !== undefined && version !== this.version) {
      this.early = data;
      return;
    }
    if (playing !== this.playing) {
      this.playing = playing;
      app.setPlaying(playing);
    }
    if (speed !== undefined) {
      app.time.setSpeed(speed);
    }
    if (key !== undefined) {
      app.showKey(key);
      app.time.clear();
    } else if (qpos) {
      const isFresh = performance.now() - this.controlled > HOLD;
      app.setShot({ ...data, ctrl: isFresh ? data.ctrl : undefined });
    }
    if (stopped) {
      app.banner.setStopped(stopped);
    } else if (warned) {
      app.banner.setWarned(warned);
    }
  }

  private async load(version: number): Promise<void> {
    if (version === this.version) {
      return;
    }
    const scene = JSON.parse(new TextDecoder().decode(await this.wire.get(`model/${version}`))) as Scene;
    const used = new Set([
      ...scene.mesh,
      ...[...scene.hfield, ...scene.texture, ...scene.skin, ...scene.flex].map((each) => each.blob),
    ]);
    await Promise.all(
      [...used]
        .filter((name) => !this.blobs.has(name))
        .map(async (name) => {
          this.blobs.set(name, await this.wire.get(`blob/${name}`));
        }),
    );
    for (const name of this.blobs.keys()) {
      if (!used.has(name)) {
        this.blobs.delete(name);
      }
    }
    const model: Model = { scene, blobs: this.blobs };
    await this.app.gizmo?.idle;
    await this.app.show([model]);
    this.version = version;
    this.app.setFault(null);
    if (this.early?.version === version) {
      this.takeState(this.early);
    }
    this.early = null;
    void this.wire.post("shown", { version });
  }
}

/** Why this browser cannot draw the model, or null. */
function missing(): string | null {
  const pen = document.createElement("canvas").getContext("webgl2");
  pen?.getExtension("WEBGL_lose_context")?.loseContext();
  return pen
    ? null
    : "This browser cannot draw the model, because it has no WebGL 2. Turn on hardware acceleration in its settings, or " +
        "open the page in a current Firefox, Chrome, Edge or Safari. `mjcompose render` makes pictures without a browser.";
}

async function start(): Promise<void> {
  const root = document.getElementById("page")!;
  const broken = (words: string) => root.replaceChildren(h("p", { className: "broken" }, words));
  const reason = missing();
  if (reason) {
    return broken(reason);
  }
  try {
    const app = new App(root);
    (window as any).mjcompose = app;
    if (document.documentElement.dataset.live !== undefined) {
      new Live(app);
    } else {
      const physics = document.querySelector("script.physics");
      const Physics = (window as any).mjcomposePhysics;
      if (physics && Physics) {
        app.server = new Physics(app, await unpacked(physics));
      }
      await app.show(await embedded());
    }
  } catch (error) {
    broken(`This page cannot show the model: ${error instanceof Error ? error.message : error}`);
    throw error;
  }
}

void start();
