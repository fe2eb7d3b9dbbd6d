// Moves the parts and elements that a recipe places: handles in the picture, numbers next to them, and the recipe's own
// line.
import { Euler, Group, MathUtils, Matrix4, Object3D, Quaternion, Vector3 } from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import type { App } from "./app";
import { type Element, type MoveRow, row, type Scene } from "./data";
import { h } from "./dom";
import { neat } from "./info";
import { FREE, WIDTHS } from "./kinematics";
import { NumberBox } from "./numbers";
import { POINTED, SELECTED } from "./world";

type Ask = (request: Record<string, unknown>) => Promise<any>;
/** Something that can be moved: a target of the recipe, or an element of a source, by an edit. */
interface Choice {
  label: string;
  rows: MoveRow[];
  edit: Element | null;
}
interface Moved {
  kind: string;
  index: number;
  frame: Matrix4;
  mount: number;
  before: Matrix4;
}

const MODES = [null, "translate", "rotate"] as const;
const STEP = 0.005;
const TURN = 5;
const NEAR = 14;
const DRAWN = ["geom", "site"];

export class Gizmo {
  readonly controls: TransformControls;
  /** Its matrix is the frame of the place in the world; the handle in it is the offset that the recipe says. */
  private readonly base = new Group();
  private readonly handle = new Object3D();
  private readonly box = h("div", { className: "gizmo", hidden: true });
  private mode = 0;
  private element: Element | null = null;
  private choices: Choice[] = [];
  private chosen = 0;
  private called = "";
  private moved: Moved[] = [];
  private start = new Matrix4();
  private last = new Matrix4();
  private from = new Vector3();
  private site = -1;
  private marked = -1;
  private snaps = true;
  private scene: Scene | null = null;
  private undo: string | null = null;
  private redo: string | null = null;
  private looks = 0;
  private queue: Promise<any> = Promise.resolve();
  private readonly fields: NumberBox[] = [];
  private readonly words = h("div", { className: "words" });
  /** Resolves when no drag is under way. */
  idle: Promise<void> = Promise.resolve();
  private released: () => void = () => {};
  /** Milliseconds from the last release to the answer of the server. */
  took = 0;

  constructor(
    private readonly app: App,
    private readonly send: Ask,
  ) {
    const { stage } = app;
    this.controls = new TransformControls(stage.camera, stage.canvas);
    this.controls.setRotationSnap(MathUtils.degToRad(TURN));
    this.controls.setSpace("local");
    this.base.matrixAutoUpdate = false;
    this.base.add(this.handle);
    stage.scene.add(this.base, this.controls.getHelper());
    this.controls.addEventListener("change", () => stage.draw());
    this.controls.addEventListener("objectChange", () => this.dragged());
    this.controls.addEventListener("dragging-changed", (event) => {
      stage.controls.enabled = !event.value;
      if (event.value) {
        this.from.copy(this.handle.position);
        this.idle = new Promise((done) => {
          this.released = done;
        });
      } else {
        void this.drop().finally(() => this.released());
      }
    });
    stage.canvas.parentElement!.append(this.box);
  }

  /** Whether a handle is being dragged. */
  get busy(): boolean {
    return this.controls.dragging;
  }

  get writes(): boolean {
    return Boolean(this.app.world?.model.scene.move);
  }

  cycle(): void {
    const { move } = this.app.world.model.scene;
    if (!move || move.why) {
      this.app.notice(move?.why ?? "this page is read-only");
      return;
    }
    this.mode = (this.mode + 1) % MODES.length;
    this.follow(this.app.selection);
  }

  /** An element is selected, or the model is a new one. `panel` shows the element. */
  follow(element: Element | null, panel?: HTMLElement): void {
    const scene = this.app.world.model.scene;
    const { move } = scene;
    const before = this.choices[this.chosen];
    this.scene = scene;
    this.element = element;
    this.controls.detach();
    this.moved = [];
    this.box.hidden = !MODES[this.mode] || !move;
    this.choices = move && !move.why && element ? this.choicesFor(element) : [];
    // In a new model, the same element is selected again, and the same thing moves with it.
    const called = element ? `${element.kind} ${(scene as any)[element.kind].name?.[element.index]}` : "";
    this.chosen =
      called === this.called
        ? Math.max(
            0,
            this.choices.findIndex((each) => each.label === before?.label),
          )
        : 0;
    this.called = called;
    if (panel && element && move && !move.why) {
      panel.append(h("div", { className: "acts" }, ...this.acts(element)));
    }
    if (!this.box.hidden) {
      void this.look();
    }
  }

  /** The pose is another one. */
  placed(): void {
    const target = this.choices[this.chosen]?.rows[0];
    if (!this.controls.object || !target?.frame) {
      return;
    }
    this.base.matrix.multiplyMatrices(this.app.world.bodyMatrix(target.mount), matrix(target.frame));
    this.base.updateMatrixWorld(true);
  }

  /** A button that saves the pose as a keyframe of the recipe. */
  saver(): HTMLElement | null {
    return this.writes && !this.scene?.move?.why
      ? h("button", { className: "wide", onclick: () => this.save() }, "Save this pose in the recipe…")
      : null;
  }

  // -- movable things ---------------------------------------------------------------------------------------------

  /** The things that move with an element, the nearest first. */
  private choicesFor({ kind, index }: Element): Choice[] {
    const { move, body } = this.app.world.model.scene;
    const columns = (this.app.world.model.scene as any)[kind];
    const places: [string, number][] = [[kind, index]];
    let b = kind === "body" ? index : (columns?.body?.[index] ?? -1);
    for (; b > 0; b = body.parent[b]) {
      places.push(["body", b]);
    }
    const choices: Choice[] = [];
    for (const [what, number] of places) {
      for (const target of move!.targets) {
        if (target.moved[what]?.includes(number) && !choices.some((known) => same(known.rows[0], target))) {
          choices.push({
            label: target.label,
            rows: [target, ...move!.targets.filter((other) => other !== target && same(other, target))],
            edit: null,
          });
        }
      }
    }
    const isElsewhere = (choice: Choice) => Number(choice.rows[0].at[0] !== 0);
    choices.sort((one, other) => isElsewhere(one) - isElsewhere(other));
    const name = columns?.name?.[index];
    if (
      ["site", "camera", "body"].includes(kind) &&
      name &&
      !move!.framed[kind]?.includes(index) &&
      !choices.some((each) => each.rows[0].moved[kind]?.includes(index)) &&
      (kind !== "body" || index > 0)
    ) {
      const own = { kind, index };
      const edit = { label: `${name}, by an edit`, rows: [] as MoveRow[], edit: own };
      if (kind === "site" || kind === "camera") {
        choices.push(edit);
      } else if (!this.free(index)) {
        choices.push(edit);
      }
    }
    return choices;
  }

  private free(b: number): number {
    const { joint } = this.app.world.model.scene;
    return joint.body.findIndex((on: number, j: number) => on === b && joint.type[j] === FREE) + 1;
  }

  private acts(element: Element): HTMLElement[] {
    const acts = [
      h(
        "button",
        {
          className: "small wide",
          onclick: () => {
            if (!this.mode) {
              this.cycle();
            }
          },
        },
        "Move (M)",
      ),
    ];
    if (element.kind === "site" && this.scene!.site.name[element.index]) {
      acts.push(
        h("button", { className: "small wide", onclick: () => void this.attach(element.index) }, "Attach here…"),
      );
    }
    return acts;
  }

  /** Ask the server where the choice is, and put the handle there. */
  private async look(): Promise<void> {
    const choice = this.choices[this.chosen];
    const number = ++this.looks;
    if (!choice) {
      return this.show("Select a part, or something that the recipe adds.");
    }
    const pose = choice.edit
      ? placeInBody(this.scene!, choice.edit)
      : await this.ask({ kind: "look", at: this.at(choice.rows[0]) });
    if (number !== this.looks || choice !== this.choices[this.chosen]) {
      return;
    }
    if (!choice.edit && !choice.rows[0].frame) {
      pose.refused = "this place has no frame in the model that could be shown";
    }
    if (pose.refused) {
      return this.show(pose.refused, pose.parameters);
    }
    this.start = matrix([...pose.pos, ...pose.quat]);
    this.last.copy(this.start);
    const rows = choice.edit ? [edited(this.scene!, choice.edit)] : choice.rows;
    this.moved = rows.flatMap(({ moved, frame, mount }) =>
      frame
        ? Object.entries(moved).flatMap(([kind, indices]) =>
            indices.map((index) => ({ kind, index, mount, frame: matrix(frame), before: this.local(kind, index) })),
          )
        : [],
    );
    if (choice.edit) {
      choice.rows = rows;
    }
    this.start.decompose(this.handle.position, this.handle.quaternion, new Vector3());
    this.controls.attach(this.handle);
    this.placed();
    this.controls.setMode(MODES[this.mode] ?? "translate");
    this.show([pose.where, pose.also].filter(Boolean).join(" · "));
    this.app.stage.draw();
  }

  private at(each: MoveRow): [string, number, number] {
    return [this.scene!.move!.files[each.at[0]], each.at[1], each.at[2]];
  }

  // -- dragging ----------------------------------------------------------------------------------------------------

  private dragged(): void {
    const { position } = this.handle;
    this.site = -1;
    if (this.snaps && MODES[this.mode] === "translate") {
      for (const axis of ["x", "y", "z"] as const) {
        if (Math.abs(position[axis] - this.from[axis]) > 1e-9) {
          position[axis] = Math.round(position[axis] / STEP) * STEP;
        }
      }
      if (this.controls.axis === "XYZ") {
        this.toSite();
      }
    }
    this.preview();
  }

  /** A part whose middle is dragged near a site is put on it. */
  private toSite(): void {
    const choice = this.choices[this.chosen];
    const { scene } = this.app.world.model;
    const { camera, canvas } = this.app.stage;
    if (choice.edit || choice.rows[0].kind !== "part") {
      return;
    }
    const own = new Set(this.moved.filter(({ kind }) => kind === "body").map(({ index }) => index));
    scene.body.parent.forEach((parent: number, b: number) => {
      if (b && own.has(parent)) {
        own.add(b);
      }
    });
    const screen = (point: Vector3) => {
      const at = point.project(camera);
      return [((at.x + 1) * canvas.clientWidth) / 2, ((1 - at.y) * canvas.clientHeight) / 2, at.z];
    };
    this.handle.updateMatrixWorld(true);
    const [x, y] = screen(new Vector3().setFromMatrixPosition(this.handle.matrixWorld));
    let nearest = NEAR;
    scene.site.name.forEach((name, index) => {
      if (!name || own.has(scene.site.body[index])) {
        return;
      }
      const place = this.placeOf(index);
      const [sx, sy, sz] = screen(new Vector3().setFromMatrixPosition(place));
      const far = Math.hypot(sx - x, sy - y);
      if (sz > 1 || far >= nearest) {
        return;
      }
      nearest = far;
      this.site = index;
    });
    if (this.site < 0) {
      return;
    }
    this.base.matrixWorld
      .clone()
      .invert()
      .multiply(this.placeOf(this.site))
      .decompose(this.handle.position, this.handle.quaternion, new Vector3());
  }

  private placeOf(site: number): Matrix4 {
    const { scene } = this.app.world.model;
    return this.app.world.bodyMatrix(scene.site.body[site]).clone().multiply(this.local("site", site));
  }

  private get now(): Matrix4 {
    return new Matrix4().compose(this.handle.position, this.handle.quaternion, new Vector3(1, 1, 1));
  }

  /** The model follows the handle, as the recipe will have it. */
  private preview(): void {
    const { world } = this.app;
    const { scene } = world.model;
    const change = this.now.multiply(this.start.clone().invert());
    for (const { kind, index, frame, before } of this.moved) {
      const to = frame.clone().multiply(change).multiply(frame.clone().invert()).multiply(before);
      const p = new Vector3();
      const q = new Quaternion();
      to.decompose(p, q, new Vector3());
      const pos = p.toArray();
      const quat = [q.w, q.x, q.y, q.z];
      const columns = (scene as any)[kind];
      pos.forEach((value, k) => {
        columns.pos[3 * index + k] = value;
      });
      quat.forEach((value, k) => {
        columns.quat[4 * index + k] = value;
      });
      const free = kind === "body" ? this.free(index) - 1 : -1;
      const mocap = kind === "body" ? scene.body.mocap[index] : -1;
      if (free >= 0) {
        [...pos, ...quat].forEach((value, k) => {
          world.pose.qpos[scene.joint.qpos[free] + k] = value;
        });
      }
      if (mocap >= 0) {
        world.pose.mpos.set(pos, 3 * mocap);
        world.pose.mquat.set(quat, 4 * mocap);
      }
      if (DRAWN.includes(kind)) {
        world.place(kind as "geom" | "site", index);
      }
    }
    world.pose.update();
    this.app.posed();
    if (this.busy) {
      this.app.stage.move();
    }
    this.numbers();
    if (this.site >= 0) {
      this.tell(`on ${scene.site.name[this.site]}`);
    }
    if (this.site === this.marked) {
      return;
    }
    this.marked = this.site;
    if (this.site >= 0) {
      world.mark([{ kind: "site", index: this.site }], POINTED);
    } else {
      world.mark(this.element ? [this.element] : [], SELECTED);
    }
  }

  private local(kind: string, index: number): Matrix4 {
    const { world } = this.app;
    const { scene } = world.model;
    const free = kind === "body" ? this.free(index) - 1 : -1;
    const first = free >= 0 ? scene.joint.qpos[free] : 0;
    if (free >= 0) {
      return matrix(Array.from(world.pose.qpos.slice(first, first + 7)));
    }
    const columns = (scene as any)[kind];
    return matrix([...row(columns.pos, index, 3), ...row(columns.quat, index, 4)]);
  }

  private async drop(): Promise<void> {
    const choice = this.choices[this.chosen];
    const { key } = this.app.poses;
    const now = this.now;
    if (!choice || now.equals(this.last)) {
      return;
    }
    const begun = performance.now();
    const { position: p, quaternion: q } = this.handle;
    const pose = { pos: p.toArray(), quat: [q.w, q.x, q.y, q.z] };
    const free =
      this.moved.map(({ kind, index }) => (kind === "body" ? this.free(index) - 1 : -1)).find((j) => j >= 0) ?? -1;
    let request: Record<string, unknown> = {
      kind: "place",
      at: choice.edit ? null : this.at(choice.rows[0]),
      ...pose,
      ...(this.site >= 0 ? { site: this.site } : {}),
    };
    if (choice.edit) {
      request = { kind: "edit", of: choice.edit.kind, index: choice.edit.index, ...pose };
      const offer = await this.ask(request);
      if (
        offer.refused ||
        (offer.offer &&
          !(await confirm(`A source says this place. Write into ${offer.where}:`, offer.offer, ["Write it"])))
      ) {
        return this.revert(offer.refused ?? "nothing was written");
      }
      request.confirmed = true;
    } else if (free >= 0 && key >= 0) {
      const name = this.scene!.key.name[key];
      const first = this.scene!.joint.qpos[free];
      const answer = await confirm("It moves freely, so a keyframe can have a place of its own for it.", "", [
        "Write the place",
        `Write keyframe ${name}`,
      ]);
      if (!answer) {
        return this.revert("nothing was written");
      }
      if (answer === 2) {
        request = {
          kind: "free",
          key: name,
          joint: free,
          qpos: Array.from(this.app.world.pose.qpos.slice(first, first + 7)),
        };
      }
    }
    const answer = await this.ask(request);
    this.took = performance.now() - begun;
    if (answer.refused) {
      return this.revert(answer.refused);
    }
    this.last.copy(now);
    this.app.notice(answer.said);
  }

  /** Everything goes back to where the recipe has it. */
  private revert(words: string): void {
    this.last.decompose(this.handle.position, this.handle.quaternion, new Vector3());
    this.site = -1;
    this.preview();
    this.app.notice(words);
    this.tell(words);
  }

  // -- asking ------------------------------------------------------------------------------------------------------

  /** Requests, one after the other, each with its model. */
  private ask(request: Record<string, unknown>): Promise<any> {
    const version = this.scene?.move?.version;
    this.queue = this.queue.then(() => this.answer({ version, ...request }));
    return this.queue;
  }

  private async answer(request: Record<string, unknown>): Promise<any> {
    try {
      const answer = await this.send(request);
      if ("undo" in answer) {
        this.undo = answer.undo;
        this.redo = answer.redo;
      }
      return answer;
    } catch (error) {
      return { refused: `the server did not accept this: ${error instanceof Error ? error.message : error}` };
    }
  }

  async back(kind: "undo" | "redo"): Promise<void> {
    if (this.app.world && !this.writes) {
      return;
    }
    const answer = await this.ask({ kind });
    this.app.notice(answer.refused ?? answer.said);
    if (!this.box.hidden) {
      this.show(this.words.textContent ?? "");
    }
  }

  /** Write the default of a parameter. */
  async setParameter(name: string, value: number): Promise<void> {
    const answer = await this.ask({ kind: "parameter", name, value });
    this.app.notice(answer.refused ?? answer.said);
  }

  /** Carry out the fix of a diagnostic. */
  async fix(text: string): Promise<void> {
    const answer = await this.ask({ kind: "fix", text });
    this.app.notice(answer.refused ?? answer.said);
  }

  private save(): void {
    const name = h("input", { type: "text", value: "pose", ariaLabel: "name of the keyframe" });
    const { actuator, joint, body, qpos0 } = this.scene!;
    const hold = h("input", { type: "checkbox", checked: true });
    const { qpos, mpos, mquat } = this.app.world.pose;
    const differ = (now: number[], still: number[]) => now.some((value, k) => Math.abs(value - still[k]) > 1e-9);
    const joints = joint.type
      .map(
        (type: number, j: number) =>
          [j, Array.from(qpos.slice(joint.qpos[j], joint.qpos[j] + WIDTHS[type]))] as [number, number[]],
      )
      .filter(([j, now]) => differ(now, qpos0.slice(joint.qpos[j])));
    const mocap = (values: Float64Array, width: number, still: number[]) =>
      body.mocap
        .map(
          (m: number, b: number) => [b, Array.from(values.slice(width * m, width * m + width))] as [number, number[]],
        )
        .filter(([b, now]) => body.mocap[b] >= 0 && differ(now, row(still, b, width)));
    const named = joints.filter(([j]) => joint.name[j]);
    const lost = joints.length - named.length;
    ask(
      "Save this pose in the recipe",
      [
        h("label", {}, "Name ", name),
        actuator.name.length
          ? h("label", { className: "check" }, hold, "the actuators hold the pose (ctrl: hold)")
          : null,
        lost ? h("p", { className: "hint" }, `${lost} joints without a name keep their reference.`) : null,
      ],
      "Save",
      async () => {
        const answer = await this.ask({
          kind: "keyframe",
          name: name.value.trim(),
          qpos: named,
          mpos: mocap(mpos, 3, body.pos),
          mquat: mocap(mquat, 4, body.quat),
          hold: hold.checked,
        });
        return this.told(answer, "saved: ");
      },
    );
  }

  private async attach(site: number): Promise<void> {
    const { models, refused } = await this.ask({ kind: "models" });
    if (refused) {
      return this.app.notice(refused);
    }
    const prefix = h("input", { type: "text", value: "tool", ariaLabel: "name of the part" });
    const model = h("select", { ariaLabel: "model", size: 8 });
    const search = h("input", {
      type: "search",
      placeholder: "Search files, packages and robots",
      ariaLabel: "search models",
      oninput: () => fill(),
    });
    const fill = () => {
      const words = search.value.toLowerCase().split(/\s+/);
      const fitting = models.filter((each: string) => words.every((word) => each.toLowerCase().includes(word)));
      model.replaceChildren(...fitting.map((each: string) => h("option", { value: each, title: each }, each)));
      model.selectedIndex = 0;
    };
    fill();
    ask(
      `Attach at ${this.scene!.site.name[site]}`,
      [h("label", {}, "Name ", prefix), h("label", {}, "Model ", search), model],
      "Attach",
      async () => {
        const answer = await this.ask({ kind: "attach", prefix: prefix.value.trim(), model: model.value, site });
        return this.told(answer);
      },
    );
  }

  /** Show the words of an answer, or return its refusal. */
  private told(answer: any, before = ""): string | null {
    if (answer.refused) {
      return answer.refused;
    }
    this.app.notice(before + answer.said);
    return null;
  }

  // -- the box -----------------------------------------------------------------------------------------------------

  private show(words: string, parameters: [string, string][] = []): void {
    const { controls } = this;
    const mode = MODES[this.mode];
    const button = (text: string, on: boolean, act: () => void, title = "") =>
      h(
        "button",
        {
          className: on ? "chip on" : "chip",
          title,
          onclick: () => {
            act();
            this.show(this.words.textContent ?? "", parameters);
          },
        },
        text,
      );
    const set = (to: number) => {
      this.mode = to;
      controls.setMode(MODES[to]!);
    };
    const check = h("input", {
      type: "checkbox",
      checked: this.snaps,
      onchange: () => {
        this.snaps = check.checked;
        controls.setRotationSnap(check.checked ? MathUtils.degToRad(TURN) : null);
      },
    });
    const select = h(
      "select",
      {
        ariaLabel: "what moves",
        onchange: () => {
          this.chosen = Number(select.value);
          controls.detach();
          void this.look();
        },
      },
      ...this.choices.map((each, k) => h("option", { value: String(k), selected: k === this.chosen }, each.label)),
    );
    this.words.textContent = words;
    this.fields.length = 0;
    this.box.replaceChildren(
      ...[
        h(
          "div",
          { className: "line" },
          this.choices.length ? select : null,
          button("Move", mode === "translate", () => set(1), "M"),
          button("Turn", mode === "rotate", () => set(2), "M"),
          button(
            controls.space === "local" ? "own axes" : "world axes",
            false,
            () => controls.setSpace(controls.space === "local" ? "world" : "local"),
            "the axes of the handles",
          ),
          h("label", { className: "check", title: `${1000 * STEP} mm and ${TURN}°` }, check, "snap"),
        ),
        controls.object
          ? h(
              "div",
              { className: "numbers" },
              ...["x", "y", "z", "roll", "pitch", "yaw"].map((name, k) => this.field(name, k)),
            )
          : null,
        this.words,
        ...parameters.map(([name, value]) => this.parameter(name, value)),
        h(
          "div",
          { className: "line" },
          h(
            "button",
            {
              className: "small wide",
              disabled: !this.undo,
              title: this.undo ?? "",
              onclick: () => void this.back("undo"),
            },
            "Undo",
          ),
          h(
            "button",
            {
              className: "small wide",
              disabled: !this.redo,
              title: this.redo ?? "",
              onclick: () => void this.back("redo"),
            },
            "Redo",
          ),
          ...(this.element ? this.acts(this.element).slice(1) : []),
        ),
      ].filter((each): each is HTMLElement => each !== null),
    );
    this.numbers();
  }

  private tell(words: string): void {
    this.words.textContent = words;
  }

  private parameter(name: string, value: string): HTMLElement {
    let now = value;
    const box = new NumberBox(
      `parameter ${name}`,
      "plain",
      () => now,
      (number) => {
        now = neat(number, 6);
        void this.setParameter(name, number);
      },
    );
    return h("label", { className: "line" }, `params: ${name} `, box.root);
  }

  /** Three meters and three degrees, relative to the place. */
  private field(name: string, k: number): HTMLElement {
    const box = new NumberBox(
      `${name}, relative to its place`,
      k < 3 ? "length" : "angle",
      () => this.shown(k),
      (value) => {
        if (k < 3) {
          this.handle.position.setComponent(k, value);
        } else {
          const turned = this.angles();
          turned[k - 3] = value;
          this.handle.quaternion.setFromEuler(new Euler(...turned, "XYZ"));
        }
        this.site = -1;
        this.preview();
        void this.drop();
      },
    );
    this.fields.push(box);
    return h("label", {}, name, box.root);
  }

  private shown(k: number): string {
    const value = k < 3 ? this.handle.position.getComponent(k) : MathUtils.radToDeg(this.angles()[k - 3]);
    return neat(Math.abs(value) < 1e-6 ? 0 : value, 5) + (k < 3 ? " m" : "°");
  }

  private angles(): [number, number, number] {
    const { x, y, z } = new Euler().setFromQuaternion(this.handle.quaternion, "XYZ");
    return [x, y, z];
  }

  private numbers(): void {
    for (const field of this.fields) {
      field.show();
    }
  }
}

function same(a: MoveRow | undefined, b: MoveRow): boolean {
  return a !== undefined && a.at.join() === b.at.join();
}

function matrix([x, y, z, w, a, b, c]: number[]): Matrix4 {
  return new Matrix4().compose(new Vector3(x, y, z), new Quaternion(a, b, c, w), new Vector3(1, 1, 1));
}

/** The place of an element of a source in its body. */
function placeInBody(scene: Scene, { kind, index }: Element): any {
  const columns = (scene as any)[kind];
  return { pos: row(columns.pos, index, 3), quat: row(columns.quat, index, 4), where: "" };
}

function edited(scene: Scene, { kind, index }: Element): MoveRow {
  const mount = kind === "body" ? scene.body.parent[index] : (scene as any)[kind].body[index];
  return { at: [-1, 0, 0], label: "", kind, mount, frame: [0, 0, 0, 1, 0, 0, 0], moved: { [kind]: [index] } };
}

/** Ask something with several answers; gives the number of the answer, or 0. */
function confirm(words: string, code: string, answers: string[]): Promise<number> {
  return new Promise((done) => {
    const dialog = h(
      "dialog",
      {},
      h("p", {}, words),
      code && h("pre", {}, code),
      ...answers.map((each, k) =>
        h(
          "button",
          {
            onclick: () => {
              dialog.close(String(k + 1));
            },
          },
          each,
        ),
      ),
      h("button", { onclick: () => dialog.close("") }, "Cancel"),
    );
    dialog.addEventListener("close", () => {
      dialog.remove();
      done(Number(dialog.returnValue || 0));
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}

/** Ask for some fields. `act` returns null, or the reason why nothing was done, which the dialog shows. */
function ask(title: string, fields: (HTMLElement | null)[], word: string, act: () => Promise<string | null>): void {
  const refused = h("p", { className: "refused", role: "alert", hidden: true });
  const form = h(
    "form",
    { method: "dialog" },
    h("h2", {}, title),
    ...fields,
    refused,
    h("button", { type: "submit" }, word),
    h("button", { type: "button", onclick: () => dialog.close() }, "Cancel"),
  );
  const dialog = h("dialog", { className: "asks", onclose: () => dialog.remove() }, form);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    void act().then((reason) => {
      refused.hidden = reason === null;
      refused.textContent = reason ?? "";
      if (reason === null) {
        dialog.close();
      }
    });
  });
  document.body.append(dialog);
  dialog.showModal();
}
