// The start of the page: from the models in its file, or from a server.
import { App } from "./app";
import { embedded, type Model, type Scene, unpacked } from "./data";
import { h } from "./dom";
import { Gizmo } from "./gizmo";
import { elementAt, Http, host, type Wire } from "./wire";

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

  constructor(private readonly app: App) {
    app.server = {
      play: () =>
        void this.wire.post("play", {
          playing: !this.playing,
          qpos: Array.from(app.world.pose.qpos),
          ctrl: app.sliders.ctrl,
          key: app.key,
        }),
      pose: () => {
        if (this.playing) {
          void this.wire.post("pose", { ctrl: app.sliders.ctrl });
        }
      },
      look: () => this.look(),
      pull: (pull) => void this.wire.post("pull", pull ?? {}),
      choose: (name, value) => void this.wire.post("choose", { name, value }),
    };
    if (this.wire.ask) {
      app.gizmo = new Gizmo(app, (request) => this.wire.ask!("change", request));
    }
    this.wire.listen(
      (name, data) => this.take(name, data),
      () => app.notice("the server does not answer"),
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
    if (name === "model") {
      this.loading = this.loading
        .then(() => this.load(data.version))
        .catch((error: Error) => this.app.notice(error.message));
    } else if (name === "fault") {
      this.app.setFault(data.text);
    } else if (name === "state") {
      const { qpos, playing, version, stopped, seen, time, looked } = data;
      if (looked !== undefined) {
        if (looked === this.looked && version === this.version && !this.playing && this.app.at === null) {
          this.app.see(seen);
          this.app.posed();
        }
        return;
      }
      if (playing !== this.playing) {
        this.playing = playing;
        this.app.setPlaying(playing);
      }
      if (qpos && version === this.version) {
        this.app.setQpos(qpos, seen, time);
      }
      if (stopped) {
        this.app.setStopped(stopped);
      }
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
    void this.wire.post("shown", { version });
  }
}

async function start(): Promise<void> {
  const root = document.getElementById("page")!;
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
    root.replaceChildren(
      h(
        "p",
        { className: "broken" },
        `This browser cannot show the model: ${error instanceof Error ? error.message : error}. It needs WebGL 2.`,
      ),
    );
    throw error;
  }
}

void start();
