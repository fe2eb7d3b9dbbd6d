// The page around the canvas, and how its parts work together.
import type { Element, Model, Pull, Scene, Seen } from "./data";
import { h, icon, toast } from "./dom";
import { EXTRAS, type Extra, Extras, Ghosts, gridStep } from "./extras";
import type { Gizmo } from "./gizmo";
import { Contrast, Info, typeOf } from "./info";
import { WIDTHS } from "./kinematics";
import { Clock, Meters } from "./meters";
import { Puller, Ruler } from "./pointer";
import { Sliders } from "./sliders";
import { Compass, copyPicture, Stage } from "./stage";
import { bodyOf, nameOf, numberOf, places, Tree } from "./tree";
import { host } from "./wire";
import { World } from "./world";

const TABS = ["Changes", "Info", "Joints", "Controls", "Sensors", "Show", "Attach"] as const;
const EXTRA_WORDS: Record<Extra, string> = {
  frames: "body frames",
  axes: "joint axes",
  inertia: "inertia boxes",
  contacts: "contacts",
  forces: "contact forces",
  cameras: "cameras",
  grid: "grid",
};
const KEYS: [string, string][] = [
  ["F", "fit the selection, or the whole"],
  ["0 … 5", "geom groups"],
  ["C", "collision shapes only"],
  ["J", "joint axes"],
  ["I", "inertia boxes"],
  ["B", "body frames"],
  ["S", "sites"],
  ["R", "reference pose"],
  ["K", "copy the pose as a keyframe"],
  ["L", "light or dark"],
  ["X", "before or after, where two models are compared"],
  ["M", "move or turn, where a server can change the recipe"],
  ["Ctrl Z", "undo a move"],
  ["G", "grid"],
  ["O", "contact forces"],
  ["D", "measure a distance"],
  ["P", "copy the picture"],
  ["Ctrl + drag", "pull a body while physics run"],
  ["/", "search"],
  ["Space", "run or pause the physics"],
  ["Esc", "select nothing"],
];

/** The lines of a diagnostic, by the class of their color. */
const LINES: [string, RegExp][] = [
  ["error", /(^|: )error\[/],
  ["warning", /(^|: )warning\[/],
  ["help", /^ *= help/],
  ["source", /^ *\d* *\|/],
];

export class App {
  readonly stage: Stage;
  world!: World;
  sliders!: Sliders;
  selection: Element | null = null;
  key = -1;
  /** The actions of the server that the page can ask for; a page without a server has none. */
  server: {
    play: () => void;
    pose: () => void;
    choose: (name: string, value: string) => void;
    look: () => void;
    pull: (pull: Pull | null) => void;
  } | null = null;
  readonly meters = new Meters();
  /** The keyframe whose pose is shown, -1 for the reference; null for any other pose. */
  at: number | null = -1;

  /** Moves the parts and elements that the recipe places; only a live page has one. */
  gizmo: Gizmo | null = null;

  private models: Model[] = [];
  private contrast: Contrast | null = null;
  private tree!: Tree;
  private info!: Info;
  private extras: Extras | null = null;
  private ghosts!: Ghosts;
  private readonly clock = new Clock();
  private readonly compass: Compass;
  private readonly ruler: Ruler;
  private readonly puller: Puller;
  private readonly rulerButton = h(
    "button",
    {
      className: "tool",
      title: "measure a distance (D)",
      ariaLabel: "measure a distance (D)",
      onclick: () => this.ruler.flip(),
    },
    icon("ruler"),
  );
  private playing = false;
  private readonly groups = [true, true, true, false, false, false];
  private collision = false;
  private readonly softs: Record<string, boolean> = { site: true, tendon: true, skin: true, flex: true };
  private readonly extra = new Set<Extra>();
  private readonly canvas = h("canvas", { tabIndex: 0, ariaLabel: "the model" });
  private readonly title = h("h1", {});
  private readonly keySelect = h("select", {
    ariaLabel: "keyframe",
    title: "keyframe",
    onchange: () => this.setKey(Number(this.keySelect.value)),
  });
  private readonly cameraSelect = h("select", {
    ariaLabel: "camera",
    title: "camera",
    onchange: () => this.setCamera(Number(this.cameraSelect.value)),
  });
  private readonly choices = h("span", { className: "choices" });
  private readonly playButton = h(
    "button",
    { className: "tool", title: "physics (space)", hidden: true, onclick: () => this.server?.play() },
    icon("play"),
  );
  private readonly moveButton = h(
    "button",
    { className: "tool", title: "move (M)", ariaLabel: "move (M)", hidden: true, onclick: () => this.gizmo?.cycle() },
    icon("move"),
  );
  private readonly searchBox = h("input", {
    type: "search",
    placeholder: "Search names  /",
    ariaLabel: "search names",
    oninput: () => this.search(),
  });
  private readonly treeBox = h("div", { className: "scroll" });
  private readonly panels = Object.fromEntries(
    TABS.map((tab) => [tab, h("div", { className: "scroll", hidden: true })]),
  ) as unknown as Record<(typeof TABS)[number], HTMLElement>;
  private readonly tabs = Object.fromEntries(
    TABS.map((tab) => [
      tab,
      h(
        "button",
        { role: "tab", onclick: () => this.open(tab), onkeydown: (event: KeyboardEvent) => this.nextTab(event) },
        tab,
      ),
    ]),
  ) as unknown as Record<(typeof TABS)[number], HTMLElement>;
  private readonly tip = h("div", { className: "tip", hidden: true });
  private readonly fault = h("div", { className: "fault", hidden: true, role: "alert" });
  private readonly status = h("div", { className: "status" });
  private readonly keyButtons = h("div", { className: "keys" });
  private readonly contactCount = h("span", {});

  constructor(root: HTMLElement) {
    this.theme(
      host?.theme ?? remembered("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"),
    );
    const tool = (name: string, title: string, act: () => void, className = "tool") =>
      h("button", { className, title, ariaLabel: title, onclick: act }, icon(name));
    const view = h(
      "main",
      {},
      this.canvas,
      this.meters.plot.root,
      this.tip,
      h("div", { className: "chips" }, this.status, this.clock.root),
      this.fault,
    );
    const left = h("aside", { className: "left" }, this.searchBox, this.treeBox);
    const right = h(
      "aside",
      { className: "right" },
      h("div", { className: "tabs", role: "tablist" }, ...TABS.map((tab) => this.tabs[tab])),
      ...TABS.map((tab) => this.panels[tab]),
    );
    const drawer = (side: string) => {
      root.classList.toggle(`show-${side}`);
      root.classList.remove(side === "left" ? "show-right" : "show-left");
    };
    root.append(
      h(
        "header",
        { className: "bar" },
        tool("tree", "the composition", () => drawer("left"), "tool narrow"),
        this.title,
        this.choices,
        h("span", { className: "gap" }),
        this.keySelect,
        this.cameraSelect,
        this.moveButton,
        this.playButton,
        this.rulerButton,
        tool("camera", "copy the picture (P)", () => this.copyPicture()),
        tool("fit", "fit (F)", () => this.fit()),
        tool("theme", "light or dark (L)", () => this.flipTheme()),
        tool("help", "keys (?)", () => this.help()),
        tool("panel", "joints and more", () => drawer("right"), "tool narrow"),
      ),
      left,
      view,
      right,
    );
    this.stage = new Stage(this.canvas);
    this.compass = new Compass(this.stage);
    this.ruler = new Ruler(this.stage, toast, () => this.rulerButton.classList.toggle("on", this.ruler.isOn));
    this.puller = new Puller(
      this.stage,
      () => this.playing,
      (pull) => this.server?.pull(pull),
      toast,
    );
    view.append(this.compass.root, this.ruler.label);
    this.stage.beforeFrame = () => {
      for (const drawing of [this.extras, this.compass, this.ruler, this.puller]) {
        drawing?.update();
      }
    };
    this.open("Info");
    this.pointer();
    addEventListener("keydown", (event) => this.keyboard(event));
  }

  // -- models ------------------------------------------------------------------------------------------------------

  /** Show a model. Pose, selection and hidden elements stay, as far as it has them in common with the model before. */
  async show(models: Model[], at = models.length - 1): Promise<void> {
    const model = models[at];
    const world = new World(model, this.world);
    const before = this.world as World | undefined;
    const controls = this.sliders?.ctrl;
    await world.load();
    this.models = models;
    const selected =
      this.selection && before ? { kind: this.selection.kind, name: nameOf(before.model, this.selection) } : null;
    const through = this.stage.through !== null && before ? before.model.scene.camera.name[this.stage.through] : null;
    const oldKey = this.key;
    if (before) {
      this.keepPose(before, world);
    }
    this.world = world;
    this.fillPanels(models, at);
    this.extras = new Extras(world);
    this.ghosts = new Ghosts(world);
    world.root.add(this.extras.root, this.ghosts.root);
    this.stage.show(world);
    for (const extra of this.extra) {
      this.extras.set(extra, true);
    }
    this.showPanel();
    this.applyGroups();
    this.menus();
    if (before && controls) {
      this.keepControls(before.model.scene, oldKey, controls);
    } else {
      this.setKey(firstKey(model.scene));
      this.stage.fit();
    }
    const index = selected ? numberOf(model, selected.kind, selected.name) : -1;
    this.select(selected && index >= 0 ? { kind: selected.kind, index } : null, false);
    if (through !== null && model.scene.camera.name.includes(through)) {
      this.stage.lookThrough(model.scene.camera.name.indexOf(through));
    }
    this.compare();
    if (!before && this.contrast) {
      this.open("Changes");
    }
    this.status.textContent = sizeOf(model.scene);
    this.stage.now();
    document.documentElement.dataset.shown = String(Number(document.documentElement.dataset.shown ?? 0) + 1);
  }

  /** The new world takes the keyframe and the pose of the one before, as far as it has their names. */
  private keepPose(before: World, world: World): void {
    const { scene } = world.model;
    const oldKey = this.key;
    const isMoved = this.at === null;
    this.key = oldKey < 0 ? -1 : scene.key.name.indexOf(before.model.scene.key.name[oldKey]);
    carry(before, oldKey, world, this.key);
    if (!isMoved) {
      world.softs.seen = scene.poses[this.key + 1];
    }
    this.at = isMoved ? null : this.key;
  }

  /** The actuators that the user has moved keep their values: `controls`, in the old scene. */
  private keepControls(old: Scene, oldKey: number, controls: number[]): void {
    const { scene } = this.world.model;
    const still = controlsAt(old, oldKey);
    this.sliders.setControls(controlsAt(scene, this.key));
    scene.actuator.name.forEach((name, a) => {
      const k = name ? (old.actuator.control[old.actuator.name.indexOf(name)] ?? -1) : -1;
      if (k >= 0 && controls[k] !== still[k]) {
        this.sliders.ctrl[scene.actuator.control[a]] = controls[k];
      }
    });
    this.sliders.refresh();
  }

  /** The parts of the page around the picture, for a new model. */
  private fillPanels(models: Model[], at: number): void {
    const { world } = this;
    const { model } = world;
    const { scene } = model;
    document.title = scene.title;
    this.title.textContent = scene.title;
    this.title.title = `${scene.title}, ${scene.made}`;
    const difference = models[models.length - 1].scene.difference;
    this.contrast = difference ? new Contrast(model, difference, at) : null;
    this.tree = new Tree(
      model,
      (element) => this.select(element, true),
      (element) => this.hover(element),
      (element) => this.contrast?.of(element) ?? "",
    );
    this.treeBox.replaceChildren(this.tree.root);
    this.info = new Info(model, (element) => this.select(element, true));
    this.sliders = new Sliders(
      model,
      world.pose,
      () => this.moved(),
      () => this.server?.pose(),
    );
    this.panels.Info.replaceChildren(this.info.root);
    this.panels.Joints.replaceChildren(this.poseTools(), this.sliders.joints);
    this.panels.Controls.replaceChildren(this.sliders.controls);
    this.meters.use(model, world.pose.qpos, this.sliders.ctrl);
    this.panels.Sensors.replaceChildren(this.meters.panel);
    this.ruler.clear();
    this.clock.reset();
    this.panels.Attach.replaceChildren(
      places(
        model,
        (element) => this.select(element, true),
        (element) => this.hover(element),
      ),
    );
  }

  private menus(): void {
    const { scene } = this.world.model;
    const option = (value: number, words: string) => h("option", { value: String(value) }, words);
    const named = (k: number) => (k < 0 ? "reference" : scene.key.name[k] || `key#${k}`);
    this.keySelect.replaceChildren(option(-1, "reference pose"), ...scene.key.name.map((_, k) => option(k, named(k))));
    if (this.at === null) {
      this.keySelect.append(h("option", { value: "", disabled: true }, `${named(this.key)}, moved`));
    }
    this.keySelect.value = this.at === null ? "" : String(this.at);
    this.cameraSelect.replaceChildren(
      option(-1, "free camera"),
      ...scene.camera.name.map((name, k) => option(k, name || `camera#${k}`)),
    );
    this.cameraSelect.hidden = !scene.camera.name.length;
    this.keyButtons.replaceChildren(
      ...[-1, ...scene.key.name.keys()].map((k) => {
        const ghost = h(
          "button",
          {
            className: "ghost",
            title: `show a ghost at ${named(k)}`,
            ariaLabel: `show a ghost at ${named(k)}`,
            ariaPressed: String(this.ghosts.has(k)),
            onclick: () => {
              this.ghosts.flip(k);
              this.menus();
              this.stage.draw();
            },
          },
          icon("ghost"),
        );
        if (this.ghosts.has(k)) {
          ghost.style.color = this.ghosts.color(k);
        }
        return h(
          "span",
          { className: k === this.at ? "chip on" : "chip" },
          h("button", { onclick: () => this.setKey(k) }, named(k)),
          ghost,
        );
      }),
    );
    this.choices.replaceChildren(
      ...(scene.choices ?? []).map((each) =>
        h(
          "select",
          {
            title: each.label,
            ariaLabel: each.label,
            onchange: (event: Event) => this.server?.choose(each.name, (event.target as HTMLSelectElement).value),
          },
          ...each.values.map((value) => h("option", { value, selected: value === each.value }, value)),
        ),
      ),
    );
    this.choices.hidden = !this.server;
    this.playButton.hidden = !this.server;
    this.moveButton.hidden = !this.gizmo?.writes;
  }

  /** Two models in one page: which one is shown, and what differs. */
  private compare(): void {
    const contrast = this.contrast;
    this.tabs.Changes.hidden = !contrast;
    this.tabs.Attach.hidden = Boolean(contrast);
    if (!contrast) {
      return;
    }
    const show = (number: number) =>
      h(
        "button",
        { className: number === contrast.at ? "chip on" : "chip", onclick: () => void this.show(this.models, number) },
        number ? "after" : "before",
      );
    this.choices.replaceChildren(show(0), show(1));
    this.choices.hidden = false;
    this.world.recolour(contrast.color);
    this.panels.Changes.replaceChildren(contrast.panel((element) => this.select(element, true)));
  }

  // -- pose --------------------------------------------------------------------------------------------------------

  setKey(key: number): void {
    this.key = key;
    this.at = key;
    const { scene } = this.world.model;
    this.world.pose.reset(key);
    this.sliders.setControls(controlsAt(scene, key));
    this.menus();
    this.see(scene.poses[key + 1]);
    this.posed();
    this.server?.pose();
  }

  /** The results of MuJoCo for the pose that is shown, with the time if physics run; null while they are not known. */
  see(seen: Seen | null, time: number | null = null): void {
    this.world.softs.seen = seen;
    this.meters.show(seen, time);
    if (time !== null) {
      this.clock.show(time);
    }
    this.contactCount.textContent = seen ? String(seen.contacts.length) : "–";
  }

  /** A slider has moved a joint. */
  private moved(): void {
    this.world.pose.update();
    this.stray();
    this.posed();
    this.server?.pose();
    if (!this.playing) {
      this.server?.look();
    }
  }

  /** The model has left the pose of its keyframe. */
  private stray(): void {
    this.see(null);
    if (this.at === null) {
      return;
    }
    this.at = null;
    this.menus();
  }

  /** The server or a test has a configuration. */
  setQpos(qpos: ArrayLike<number>, seen: Seen | null = null, time: number | null = null): void {
    this.world.pose.qpos.set(qpos);
    this.world.pose.update();
    this.stray();
    this.see(seen, time);
    this.stage.move();
    this.posed();
  }

  posed(): void {
    this.world.update();
    this.sliders.refresh();
    this.gizmo?.placed();
    this.stage.draw();
  }

  private poseTools(): HTMLElement {
    return h(
      "div",
      { className: "pose" },
      this.keyButtons,
      h(
        "button",
        { className: "wide", onclick: () => void this.sliders.copyPose() },
        icon("copy"),
        "Copy this pose as a keyframe",
      ),
      this.gizmo?.saver() ?? null,
    );
  }

  // -- the view ---------------------------------------------------------------------------------------------------

  private setCamera(index: number): void {
    if (index < 0) {
      this.stage.fit();
    } else {
      this.stage.lookThrough(index);
    }
  }

  private fit(): void {
    this.cameraSelect.value = "-1";
    const box = this.selection ? this.world.boxOf(this.selection) : undefined;
    this.stage.fit(box && !box.isEmpty() ? box : undefined);
  }

  applyGroups(): void {
    this.world.show((kind, group, collides) => {
      if (kind === "site") {
        return this.softs.site && group < 3;
      }
      return this.collision ? collides : this.groups[group];
    });
    for (const kind of ["tendon", "skin", "flex"]) {
      this.world.softs.show(kind, (group) => this.softs[kind] && !this.collision && group < 3);
    }
    this.world.softs.update();
    this.stage.draw();
  }

  private showPanel(): void {
    const { scene } = this.world.model;
    const check = (words: string, on: boolean, set: (on: boolean) => void, more: string | Node = "") =>
      h(
        "label",
        { className: "check" },
        h("input", {
          type: "checkbox",
          checked: on,
          onchange: (event: Event) => {
            set((event.target as HTMLInputElement).checked);
          },
        }),
        h("span", {}, words),
        h("span", { className: "more" }, more),
      );
    const counts = this.groups.map((_, group) => scene.geom.group.filter((each: number) => each === group).length);
    const groups = this.groups.flatMap((on, group) =>
      counts[group]
        ? [
            check(
              `group ${group}`,
              on,
              (now) => {
                this.groups[group] = now;
                this.applyGroups();
              },
              `${counts[group]} geoms`,
            ),
          ]
        : [],
    );
    const softs = Object.entries(this.softs).flatMap(([kind, on]) => {
      const count =
        kind === "site" || kind === "tendon" ? (scene as any)[kind].name.length : (scene as any)[kind].length;
      return count
        ? [
            check(
              `${kind}s`,
              on,
              (now) => {
                this.softs[kind] = now;
                this.applyGroups();
              },
              String(count),
            ),
          ]
        : [];
    });
    const details: Partial<Record<Extra, Node | string>> = {
      contacts: this.contactCount,
      grid: `${gridStep(scene.look.extent)} m`,
    };
    this.panels.Show.replaceChildren(
      h(
        "div",
        { className: "show" },
        h("h3", {}, "Geoms"),
        ...groups,
        check("collision shapes only", this.collision, (now) => {
          this.collision = now;
          this.applyGroups();
        }),
        softs.length ? h("h3", {}, "More of the model") : null,
        ...softs,
        h("h3", {}, "Marks"),
        ...EXTRAS.map((each) =>
          check(EXTRA_WORDS[each], this.extra.has(each), (on) => this.setExtra(each, on), details[each] ?? ""),
        ),
      ),
    );
  }

  setExtra(name: Extra, on: boolean): void {
    if (on) {
      this.extra.add(name);
    } else {
      this.extra.delete(name);
    }
    this.extras?.set(name, on);
    this.stage.draw();
  }

  // -- selection ---------------------------------------------------------------------------------------------------

  select(element: Element | null, open: boolean): void {
    this.selection = element;
    this.tree.select(element);
    this.info.show(element);
    this.world.mark(element, 0x3b82f6);
    this.gizmo?.follow(element, this.info.root);
    if (open) {
      this.open("Info");
    }
    this.stage.draw();
  }

  private hover(element: Element | null): void {
    this.world.mark(element ?? this.selection, element ? 0xffb020 : 0x3b82f6);
    this.stage.draw();
  }

  private pointer(): void {
    let down: [number, number] | null = null;
    let due = 0;
    this.canvas.addEventListener("pointerdown", (event) => {
      down = [event.clientX, event.clientY];
      this.tip.hidden = true;
    });
    this.canvas.addEventListener("pointerup", (event) => {
      if (this.gizmo?.busy) {
        down = null;
      }
      const isClick = down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 5;
      down = null;
      if (!isClick) {
        return;
      }
      if (this.ruler.isOn) {
        return this.ruler.click(event.clientX, event.clientY);
      }
      const element = this.stage.pick(event.clientX, event.clientY);
      this.select(element, element !== null);
    });
    this.canvas.addEventListener("pointerleave", () => {
      this.tip.hidden = true;
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (event.buttons || event.pointerType === "touch") {
        return;
      }
      cancelAnimationFrame(due);
      due = requestAnimationFrame(() => this.point(event.clientX, event.clientY));
    });
  }

  private point(x: number, y: number): void {
    const element = this.gizmo?.controls.axis ? null : this.stage.pick(x, y);
    this.tip.hidden = !element;
    if (!element) {
      return;
    }
    const { model } = this.world;
    const on = element.kind === "body" ? -1 : bodyOf(model, element);
    const body = on >= 0 ? nameOf(model, { kind: "body", index: on }) : "";
    const origin = model.scene.origins.of[element.kind]?.[element.index];
    const where = origin?.[0] ? `${model.scene.origins.files[origin[0][0]]}:${origin[0][1]}` : "";
    this.tip.replaceChildren(
      h("b", {}, nameOf(model, element)),
      h("span", {}, typeOf(model, element), body && ` on ${body}`),
      where && h("code", {}, where),
    );
    const box = this.canvas.getBoundingClientRect();
    this.tip.style.left = `${Math.min(x - box.left + 14, box.width - this.tip.offsetWidth - 8)}px`;
    this.tip.style.top = `${Math.min(y - box.top + 14, box.height - this.tip.offsetHeight - 8)}px`;
  }

  private search(): void {
    const text = this.searchBox.value.trim();
    this.treeBox.replaceChildren(...(text ? this.tree.search(text) : [this.tree.root]));
  }

  // -- the page ----------------------------------------------------------------------------------------------------

  open(tab: (typeof TABS)[number]): void {
    for (const name of TABS) {
      this.panels[name].hidden = name !== tab;
      this.tabs[name].ariaSelected = String(name === tab);
      this.tabs[name].tabIndex = name === tab ? 0 : -1;
    }
    if (tab === "Sensors") {
      this.meters.open();
    }
  }

  /** The arrows go from tab to tab. */
  private nextTab(event: KeyboardEvent): void {
    const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key] ?? 0;
    const shown = TABS.filter((tab) => !this.tabs[tab].hidden);
    if (!way) {
      return;
    }
    const next = shown[(shown.findIndex((tab) => this.tabs[tab] === event.target) + way + shown.length) % shown.length];
    this.open(next);
    this.tabs[next].focus();
  }

  private keyboard(event: KeyboardEvent): void {
    const field = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey) {
      return;
    }
    if (field.matches("input:not([type=range]):not([type=checkbox]), textarea, select")) {
      if (event.key === "Escape") {
        field.blur();
      }
      return;
    }
    const flip = (extra: Extra) => {
      this.setExtra(extra, !this.extra.has(extra));
      this.showPanel();
    };
    const acts: Record<string, () => void> = {
      m: () => this.gizmo?.cycle(),
      g: () => flip("grid"),
      o: () => flip("forces"),
      d: () => this.ruler.flip(),
      p: () => this.copyPicture(),
      f: () => this.fit(),
      l: () => this.flipTheme(),
      "?": () => this.help(),
      "/": () => this.searchBox.focus(),
      r: () => this.setKey(-1),
      x: () => {
        if (this.contrast) {
          void this.show(this.models, 1 - this.contrast.at);
        }
      },
      k: () => void this.sliders.copyPose(),
      j: () => flip("axes"),
      i: () => flip("inertia"),
      b: () => flip("frames"),
      c: () => {
        this.collision = !this.collision;
        this.applyGroups();
        this.showPanel();
      },
      s: () => {
        this.softs.site = !this.softs.site;
        this.applyGroups();
        this.showPanel();
      },
      escape: () => {
        if (this.ruler.isOn) {
          return this.ruler.flip(false);
        }
        this.select(null, false);
        document.querySelector("dialog")?.remove();
        this.fault.hidden = true;
      },
      " ": () => this.server?.play(),
    };
    const group = "012345".indexOf(event.key);
    const act =
      group >= 0
        ? () => {
            this.groups[group] = !this.groups[group];
            this.applyGroups();
            this.showPanel();
          }
        : acts[event.key.toLowerCase()];
    if (!act) {
      return;
    }
    event.preventDefault();
    act();
  }

  private help(): void {
    document.querySelector("dialog")?.remove();
    const dialog = h(
      "dialog",
      {},
      h("h2", {}, "Keys"),
      h("dl", {}, ...KEYS.flatMap(([key, words]) => [h("dt", {}, h("kbd", {}, key)), h("dd", {}, words)])),
      h(
        "p",
        { className: "hint" },
        "Drag to turn, right button or two fingers to move, wheel to come nearer. Made with ",
        this.world.model.scene.made,
        " and three.js (MIT).",
      ),
      h("button", { onclick: () => dialog.remove() }, "Close"),
    );
    document.body.append(dialog);
    dialog.showModal();
  }

  theme(name: string): void {
    document.documentElement.dataset.theme = name;
    try {
      localStorage.setItem("mjcompose-theme", name);
    } catch {
      /* a page from a file may have no storage */
    }
  }

  private flipTheme(): void {
    this.theme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
  }

  setPlaying(playing: boolean): void {
    this.playing = playing;
    if (playing) {
      this.setStopped(null);
    } else {
      this.clock.pause();
      this.stage.rest();
    }
    this.playButton.replaceChildren(icon(playing ? "pause" : "play"));
    this.playButton.classList.toggle("on", playing);
  }

  /** A fault over the last good model, in the words of the terminal; null takes it away. */
  setFault(text: string | null): void {
    this.banner(text, "The model has a fault", this.world ? "the last good one is shown" : "");
  }

  /** Why the simulation cannot go on; null takes it away. */
  setStopped(text: string | null): void {
    if (text !== null || this.fault.classList.contains("stopped")) {
      this.banner(text, "The simulation has stopped", "");
    }
    this.fault.classList.toggle("stopped", text !== null);
  }

  private banner(text: string | null, head: string, more: string): void {
    this.fault.classList.remove("stopped");
    this.fault.hidden = text === null;
    if (text === null) {
      return;
    }
    const hang = (line: string) => line.length - line.trimStart().length + (/^ *= /.test(line) ? 2 : 0);
    const lines = text
      .trimEnd()
      .split("\n")
      .map((line) =>
        h(
          "span",
          {
            style: `--hang:${hang(line)}ch`,
            className: LINES.find(([, pattern]) => pattern.test(line))?.[0] ?? "",
          },
          line || "\u200b",
        ),
      );
    this.fault.replaceChildren(
      h(
        "header",
        {},
        h("b", {}, head),
        h("span", {}, more),
        h(
          "button",
          {
            title: "hide (Esc)",
            onclick: () => {
              this.fault.hidden = true;
            },
          },
          "×",
        ),
      ),
      h("pre", {}, ...lines),
    );
  }

  private copyPicture(): void {
    void copyPicture(this.stage, this.world.model.scene.title);
  }

  notice(words: string): void {
    toast(words);
  }
}

function sizeOf({ body, joint, geom, actuator }: Scene): string {
  const counts = [
    `${body.name.length - 1} bodies`,
    `${joint.name.length} joints`,
    `${geom.name.length} geoms`,
    `${actuator.name.length} actuators`,
  ];
  return counts.join(" · ");
}

/** The keyframe that a page shows first. */
function firstKey({ key, key_named }: Scene): number {
  if (key_named) {
    return key.name.indexOf(key_named);
  }
  return key.name.length ? 0 : -1;
}

/**
 * The pose of a model for another one, by the names of joints. Joints that nobody moved follow the new keyframe or
 * reference.
 */
function carry(before: World, oldKey: number, after: World, key: number): void {
  const old = before.model.scene;
  const now = after.model.scene;
  const { pose } = before;
  const still = oldKey < 0 ? old.qpos0 : old.key.qpos.slice(oldKey * pose.qpos.length, (oldKey + 1) * pose.qpos.length);
  after.pose.reset(key);
  now.joint.name.forEach((name, j) => {
    const k = name ? old.joint.name.indexOf(name) : -1;
    if (k < 0 || old.joint.type[k] !== now.joint.type[j]) {
      return;
    }
    const width = WIDTHS[now.joint.type[j]];
    const from = old.joint.qpos[k];
    const to = now.joint.qpos[j];
    const moved = Array.from({ length: width }, (_, at) => pose.qpos[from + at] !== still[from + at]).some(Boolean);
    if (moved) {
      for (let at = 0; at < width; at++) {
        after.pose.qpos[to + at] = pose.qpos[from + at];
      }
    }
  });
  after.softs.seen = null;
  after.pose.update();
  after.update();
}

/** The controls of a keyframe; all zero without one. */
function controlsAt(scene: Scene, key: number): number[] {
  const count = scene.actuator.range.length / 2;
  return key < 0 ? new Array(count).fill(0) : scene.key.ctrl.slice(key * count, (key + 1) * count);
}

function remembered(what: string): string | null {
  try {
    return localStorage.getItem(`mjcompose-${what}`);
  } catch {
    return null;
  }
}
