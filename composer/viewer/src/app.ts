// The page around the canvas, and how its parts work together.
import { Banner, type FaultRow } from "./banner";
import type { Element, Model, Scene, Seen } from "./data";
import { h, toast } from "./dom";
import { Frame, type Tab, tool } from "./frame";
import type { Gizmo } from "./gizmo";
import { Contrast, Info, typeOf } from "./info";
import { help, listen } from "./keyboard";
import { WIDTHS } from "./kinematics";
import { Labels } from "./labels";
import { Meters } from "./meters";
import { Params } from "./params";
import type { Player, Shot } from "./player";
import { Puller, Ruler } from "./pointer";
import { Poses } from "./poses";
import { Sliders } from "./sliders";
import { Compass, copyPicture, Stage } from "./stage";
import { TimeBar } from "./time";
import { bodyOf, nameOf, numberOf, places, Tree } from "./tree";
import { Visible } from "./visible";
import { host } from "./wire";
import { POINTED, SELECTED, World } from "./world";

/** The models of the page, and its views of the current one. */
interface Shown {
  models: Model[];
  contrast: Contrast | null;
  tree: Tree;
  info: Info;
}

export class App {
  readonly stage: Stage;
  readonly frame: Frame;
  readonly visible = new Visible(() => this.stage.draw());
  readonly banner = new Banner();
  readonly meters = new Meters();
  readonly ruler: Ruler;
  readonly puller: Puller;
  readonly time: TimeBar;
  readonly poses: Poses;
  readonly params = new Params(
    (name, value) => this.server?.choose(name, value),
    (name, value) => void this.gizmo?.setParameter(name, value),
  );
  world!: World;
  sliders!: Sliders;
  /** The selected elements; the last one is `selection`. */
  selected: Element[] = [];
  /** Runs the physics; a page without a server and without physics has none. */
  server: Player | null = null;
  /** Moves the parts and elements that the recipe places; only a live page has one. */
  gizmo: Gizmo | null = null;
  private shown!: Shown;

  constructor(root: HTMLElement) {
    this.theme(
      host?.theme ?? remembered("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"),
    );
    this.time = new TimeBar(
      () => this.server,
      () => this.reset(),
    );
    this.poses = new Poses(
      (key) => this.setKey(key),
      () => this.stage.draw(),
    );
    const rulerButton = tool("ruler", "measure a distance (D)", () => this.ruler.flip());
    this.frame = new Frame(root, {
      menus: [this.poses.menu],
      tools: [
        rulerButton,
        tool("camera", "copy the picture (P)", () => this.copyPicture()),
        tool("fit", "fit (F)", () => this.fit()),
        tool("theme", "light or dark (L)", () => this.flipTheme()),
        tool("help", "keys (?)", () => help(this)),
      ],
      over: [this.meters.plot.root],
      camera: (index) => this.setCamera(index),
      move: () => this.gizmo?.cycle(),
      search: (text) => this.search(text),
      opened: (tab) => tab === "Sensors" && this.meters.open(),
    });
    const { view, canvas, status } = this.frame;
    view.append(
      h("div", { className: "chips" }, status, this.time.clock.root),
      this.time.root,
      this.banner.root,
      this.banner.lost,
    );
    this.stage = new Stage(canvas);
    this.visible.labels = new Labels(this.stage);
    const compass = new Compass(this.stage);
    this.ruler = new Ruler(this.stage, toast, () => rulerButton.classList.toggle("on", this.ruler.isOn));
    this.puller = new Puller(
      this.stage,
      () => this.time.isPlaying,
      (pull) => this.server?.pull(pull),
      toast,
    );
    view.append(compass.root, this.ruler.label);
    this.stage.beforeFrame = () => {
      for (const drawing of [this.visible.extras, compass, this.ruler, this.puller, this.visible.labels]) {
        drawing?.update();
      }
    };
    this.frame.panels.open("Info");
    this.pointer();
    listen(this);
  }

  get canvas(): HTMLCanvasElement {
    return this.frame.canvas;
  }

  get selection(): Element | null {
    return this.selected[this.selected.length - 1] ?? null;
  }

  get contrast(): Contrast | null {
    return this.shown.contrast;
  }

  // -- models ------------------------------------------------------------------------------------------------------

  /** Show a model. Pose, selection and hidden elements stay, as far as it has them in common with the model before. */
  async show(models: Model[], at = models.length - 1): Promise<void> {
    const model = models[at];
    const world = new World(model, this.world);
    const before = this.world as World | undefined;
    const controls = this.sliders?.ctrl;
    await world.load();
    const selected =
      this.selection && before ? { kind: this.selection.kind, name: nameOf(before.model, this.selection) } : null;
    const through = this.stage.through !== null && before ? before.model.scene.camera.name[this.stage.through] : null;
    const oldKey = this.poses.key;
    if (before) {
      this.keepPose(before, world);
    }
    this.world = world;
    this.fillPanels(models, at);
    this.poses.use(world);
    this.stage.show(world);
    this.visible.use(world);
    this.menus();
    if (before && controls) {
      this.keepControls(before.model.scene, oldKey, controls);
    } else {
      this.showKey(firstKey(model.scene));
      this.stage.fit();
    }
    const index = selected ? numberOf(model, selected.kind, selected.name) : -1;
    this.select(selected && index >= 0 ? { kind: selected.kind, index } : null, false);
    if (through !== null && model.scene.camera.name.includes(through)) {
      this.stage.lookThrough(model.scene.camera.name.indexOf(through));
    }
    this.compare(at);
    if (!before && this.contrast) {
      this.open("Changes");
    }
    this.frame.status.textContent = sizeOf(model.scene);
    this.stage.now();
    document.documentElement.dataset.shown = String(Number(document.documentElement.dataset.shown ?? 0) + 1);
  }

  /** The new world takes the keyframe and the pose of the one before, as far as it has their names. */
  private keepPose(before: World, world: World): void {
    const { scene } = world.model;
    const oldKey = this.poses.key;
    const isMoved = this.poses.at === null;
    const key = oldKey < 0 ? -1 : scene.key.name.indexOf(before.model.scene.key.name[oldKey]);
    carry(before, oldKey, world, key);
    if (!isMoved) {
      world.softs.seen = scene.poses[key + 1];
    }
    this.poses.key = key;
    this.poses.at = isMoved ? null : key;
  }

  /** The actuators that the user has moved keep their values: `controls`, in the old scene. */
  private keepControls(old: Scene, oldKey: number, controls: number[]): void {
    const { scene } = this.world.model;
    const still = controlsAt(old, oldKey);
    this.sliders.setControls(controlsAt(scene, this.poses.key));
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
    const { world, frame } = this;
    const { model } = world;
    const { scene } = model;
    document.title = scene.title;
    frame.title.textContent = scene.title;
    frame.title.title = `${scene.title}, ${scene.made}`;
    const choose = (element: Element) => this.select(element, true);
    const hover = (element: Element | null) => this.hover(element);
    const difference = models[models.length - 1].scene.difference;
    const contrast = difference ? new Contrast(model, difference, at) : null;
    const chooseRow = (element: Element, more: boolean) => (more ? this.add(element) : this.select(element, true));
    const tree = new Tree(model, chooseRow, hover, (element) => contrast?.of(element) ?? "");
    const info = new Info(model, choose);
    this.shown = { models, contrast, tree, info };
    const parameters = this.server ? (scene.params ?? []) : [];
    this.params.use(parameters, Boolean(this.gizmo?.writes));
    frame.panels.setParams(parameters.length > 0);
    frame.panels.of.Params.replaceChildren(this.params.panel);
    frame.tree.replaceChildren(tree.root);
    this.sliders = new Sliders(
      model,
      world.pose,
      () => this.moved(),
      () => this.server?.pose(),
    );
    const panels = frame.panels.of;
    panels.Info.replaceChildren(info.root);
    panels.Joints.replaceChildren(this.poseTools(), this.sliders.joints);
    panels.Controls.replaceChildren(this.sliders.controls);
    this.meters.use(model, world.pose.qpos, this.sliders.ctrl);
    panels.Sensors.replaceChildren(this.meters.panel);
    panels.Show.replaceChildren(this.visible.panel);
    panels.Attach.replaceChildren(places(model, choose, hover));
    this.ruler.clear();
    this.time.clear();
  }

  private menus(): void {
    const { scene } = this.world.model;
    const { choices, cameras } = this.frame;
    this.poses.show();
    const option = (value: number, words: string) => h("option", { value: String(value) }, words);
    cameras.replaceChildren(
      option(-1, "free camera"),
      ...scene.camera.name.map((name, k) => option(k, name || `camera#${k}`)),
    );
    cameras.hidden = !scene.camera.name.length;
    choices.replaceChildren(
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
    choices.hidden = !this.server;
    this.time.root.hidden = !this.server;
    this.frame.moveButton.hidden = !this.gizmo?.writes;
  }

  /** Two models in one page: which one is shown, and what differs. */
  private compare(at: number): void {
    const { contrast, models } = this.shown;
    this.frame.panels.setCompared(contrast !== null);
    if (!contrast) {
      return;
    }
    const show = (number: number) =>
      h(
        "button",
        { className: number === at ? "chip on" : "chip", onclick: () => void this.show(models, number) },
        number ? "after" : "before",
      );
    this.frame.choices.replaceChildren(show(0), show(1));
    this.frame.choices.hidden = false;
    this.world.recolour(contrast.color);
    this.frame.panels.of.Changes.replaceChildren(contrast.panel((element) => this.select(element, true)));
  }

  flipCompared(): void {
    const { contrast, models } = this.shown;
    if (contrast) {
      void this.show(models, 1 - contrast.at);
    }
  }

  // -- pose --------------------------------------------------------------------------------------------------------

  /** The user chooses a keyframe: physics that run go on from it. */
  setKey(key: number): void {
    this.showKey(key);
    if (this.time.isPlaying) {
      this.server?.reset(key);
    }
  }

  /** Time 0 of the keyframe that was chosen last. */
  reset(): void {
    this.showKey(this.poses.key);
    this.server?.reset(this.poses.key);
  }

  /** The pose and the controls of a keyframe, or of the reference. */
  showKey(key: number): void {
    const { scene } = this.world.model;
    this.world.pose.reset(key);
    this.sliders.setControls(controlsAt(scene, key));
    this.poses.set(key);
    this.see(scene.poses[key + 1]);
    this.posed();
  }

  /** The results of MuJoCo for the pose that is shown, with the time if physics run; null while they are not known. */
  see(seen: Seen | null, time: number | null = null): void {
    this.world.softs.seen = seen;
    this.meters.show(seen, time);
    this.visible.contactCount.textContent = seen ? String(seen.contacts.length) : "–";
  }

  /** A slider has moved a joint. */
  private moved(): void {
    this.world.pose.update();
    this.stray();
    this.posed();
    this.server?.pose();
    if (!this.time.isPlaying) {
      this.server?.look();
    }
  }

  /** The model has left the pose of its keyframe. */
  private stray(): void {
    this.see(null);
    this.poses.stray();
  }

  /** A configuration, for example of a test. */
  setQpos(qpos: ArrayLike<number>, seen: Seen | null = null, time: number | null = null): void {
    this.world.pose.qpos.set(qpos);
    this.world.pose.update();
    this.stray();
    this.see(seen, time);
    this.stage.move();
    this.posed();
  }

  /** A state of the physics. */
  setShot({ qpos, seen, time, ctrl, kept }: Shot): void {
    if (ctrl) {
      this.sliders.setControls(Array.from(ctrl));
    }
    this.setQpos(qpos, seen, time);
    this.time.show(time, kept);
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
      this.poses.buttons,
      h("button", { className: "wide", onclick: () => void this.sliders.copyPose() }, "Copy this pose as a keyframe"),
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

  fit(): void {
    this.frame.cameras.value = "-1";
    const box = this.selection ? this.world.boxOf(this.selection) : undefined;
    this.stage.fit(box && !box.isEmpty() ? box : undefined);
  }

  copyPicture(): void {
    void copyPicture(this.stage, this.world.model.scene.title);
  }

  // -- selection ---------------------------------------------------------------------------------------------------

  select(element: Element | null, open: boolean): void {
    this.selectAll(element ? [element] : [], open);
  }

  /** Select one more; an element that is selected already is left out. */
  add(element: Element): void {
    const others = this.selected.filter(({ kind, index }) => kind !== element.kind || index !== element.index);
    this.selectAll(others.length < this.selected.length ? others : [...others, element], true);
  }

  hideSelected(): void {
    this.visible.bodies.hide(this.selected);
    this.select(null, false);
  }

  private selectAll(elements: Element[], open: boolean): void {
    const { tree, info } = this.shown;
    this.selected = elements;
    const element = this.selection;
    tree.select(element);
    info.show(element, elements.slice(0, -1));
    this.world.mark(elements, SELECTED);
    this.gizmo?.follow(element, info.root);
    if (open) {
      this.open("Info");
    }
    this.stage.draw();
  }

  private hover(element: Element | null): void {
    this.world.mark(element ? [element] : this.selected, element ? POINTED : SELECTED);
    this.stage.draw();
  }

  /** Leave the ruler, or else hide a message, or else select nothing. */
  leave(): void {
    if (this.ruler.isOn) {
      this.ruler.flip(false);
    } else if (!this.banner.hide()) {
      this.select(null, false);
    }
  }

  private pointer(): void {
    let down: [number, number] | null = null;
    let due = 0;
    const { canvas, tip } = this.frame;
    canvas.addEventListener("pointerdown", (event) => {
      down = [event.clientX, event.clientY];
      tip.hidden = true;
    });
    canvas.addEventListener("pointerup", (event) => {
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
      if (element && event.shiftKey) {
        this.add(element);
      } else {
        this.select(element, element !== null);
      }
    });
    canvas.addEventListener("pointerleave", () => {
      tip.hidden = true;
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons || event.pointerType === "touch") {
        return;
      }
      cancelAnimationFrame(due);
      due = requestAnimationFrame(() => this.point(event.clientX, event.clientY));
    });
  }

  private point(x: number, y: number): void {
    const element = this.gizmo?.controls.axis ? null : this.stage.pick(x, y);
    const { canvas, tip } = this.frame;
    tip.hidden = !element;
    if (!element) {
      return;
    }
    const { model } = this.world;
    const on = element.kind === "body" ? -1 : bodyOf(model, element);
    const body = on >= 0 ? nameOf(model, { kind: "body", index: on }) : "";
    const origin = model.scene.origins.of[element.kind]?.[element.index];
    const where = origin?.[0] ? `${model.scene.origins.files[origin[0][0]]}:${origin[0][1]}` : "";
    tip.replaceChildren(
      h("b", {}, nameOf(model, element)),
      h("span", {}, typeOf(model, element), body && ` on ${body}`),
      where && h("code", {}, where),
    );
    const box = canvas.getBoundingClientRect();
    tip.style.left = `${Math.min(x - box.left + 14, box.width - tip.offsetWidth - 8)}px`;
    tip.style.top = `${Math.min(y - box.top + 14, box.height - tip.offsetHeight - 8)}px`;
  }

  private search(text: string): void {
    const { tree } = this.shown;
    this.frame.tree.replaceChildren(...(text ? tree.search(text) : [tree.root]));
  }

  // -- the page ----------------------------------------------------------------------------------------------------

  open(tab: Tab): void {
    this.frame.panels.open(tab);
  }

  theme(name: string): void {
    document.documentElement.dataset.theme = name;
    try {
      localStorage.setItem("mjcompose-theme", name);
    } catch {
      /* a page from a file may have no storage */
    }
  }

  flipTheme(): void {
    this.theme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
  }

  setPlaying(playing: boolean): void {
    this.time.setPlaying(playing);
    if (playing) {
      this.banner.setStopped(null);
    } else {
      this.stage.rest();
    }
  }

  /** A fault over the last good model, in the words of the terminal; null takes it away. */
  setFault(text: string | null, rows: FaultRow[] = []): void {
    const more = this.world ? "the last good one is shown" : "the page shows it as soon as it builds";
    this.banner.setFault(text, more, rows);
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
