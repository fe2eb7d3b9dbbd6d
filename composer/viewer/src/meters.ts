// Sensors, joints and controls with their values over time, of which some are plotted.
import type { Model, Seen } from "./data";
import { h, nameSpan } from "./dom";
import { neat } from "./info";
import { HINGE, SLIDE } from "./kinematics";

/** A number over time that can be watched. */
export interface Signal {
  id: string;
  name: string;
  unit: string;
  group: "Sensors" | "Joints" | "Controls";
  kind: string;
  value: (seen: Seen | null) => number;
}

const UNITS: Record<string, string> = {
  touch: "N",
  force: "N",
  accelerometer: "m/s²",
  velocimeter: "m/s",
  gyro: "rad/s",
  torque: "N·m",
  rangefinder: "m",
  clock: "s",
  tendonpos: "m",
  tendonvel: "m/s",
  framepos: "m",
  framelinvel: "m/s",
  frameangvel: "rad/s",
  framelinacc: "m/s²",
  frameangacc: "rad/s²",
  subtreecom: "m",
  subtreelinvel: "m/s",
  geomdist: "m",
  e_potential: "J",
  e_kinetic: "J",
};
/** The names of the numbers of a sensor, by how many it has. */
const COMPONENTS: Record<number, string[] | undefined> = { 3: ["x", "y", "z"], 4: ["w", "x", "y", "z"] };

export function signals(model: Model, qpos: Float64Array, ctrl: number[]): Signal[] {
  const { sensor, joint, actuator } = model.scene;
  const collected: Signal[] = [];
  sensor.name.forEach((own, s) => {
    const name = own || `sensor#${s}`;
    const count = sensor.count[s];
    const kind = sensor.kind[s];
    const ends = COMPONENTS[count];
    for (let k = 0; k < count; k++) {
      collected.push({
        id: `sensor ${name} ${k}`,
        name: count === 1 ? name : `${name} ${ends?.[k] ?? k}`,
        unit: UNITS[kind] ?? "",
        group: "Sensors",
        kind,
        value: (seen) => seen?.sensors[sensor.first[s] + k] ?? NaN,
      });
    }
  });
  joint.name.forEach((own, j) => {
    const name = own || `joint#${j}`;
    const type = joint.type[j];
    const factor = type === HINGE ? 180 / Math.PI : 1;
    if (type >= SLIDE) {
      collected.push({
        id: `joint ${name}`,
        name,
        unit: type === HINGE ? "°" : "m",
        group: "Joints",
        kind: "joint",
        value: () => qpos[joint.qpos[j]] * factor,
      });
    }
  });
  actuator.name.forEach((own, a) => {
    const name = own || `actuator#${a}`;
    collected.push({
      id: `actuator ${name}`,
      name,
      unit: "",
      group: "Controls",
      kind: "control",
      value: () => ctrl[actuator.control[a]],
    });
  });
  return collected;
}

const SECONDS = 10;
const MOST = 4000;
const HEIGHT = 150;
const COLORS = ["#3b82f6", "#ef4444", "#10b981", "#f59e0b", "#8b5cf6", "#ec4899", "#14b8a6", "#84cc16"];

export class Plot {
  readonly root: HTMLElement;
  private readonly canvas = h("canvas", { role: "img", ariaLabel: "chosen values over time" });
  private readonly legend = h("div", { className: "legend" });
  private chosen: Signal[] = [];
  private times: number[] = [];
  private rows: number[][] = [];

  constructor(private readonly changed: () => void) {
    this.root = h("section", { className: "plot", hidden: true }, this.legend);
    new ResizeObserver(() => this.draw()).observe(this.root);
  }

  /** Plot these; earlier plots go on if nothing is new. */
  choose(chosen: Signal[], remove: (signal: Signal) => void): void {
    const same = chosen.map((each) => each.id).join() === this.chosen.map((each) => each.id).join();
    this.chosen = chosen;
    if (!same) {
      this.clear();
    }
    this.root.hidden = !chosen.length;
    if (chosen.length) {
      this.root.append(this.canvas);
    }
    this.legend.replaceChildren(
      ...chosen.map((each, k) =>
        h(
          "span",
          {},
          h("i", { className: "dot", style: `background:${COLORS[k % COLORS.length]}` }),
          each.name,
          h("b", {}),
          h(
            "button",
            {
              title: `stop plotting ${each.name}`,
              ariaLabel: `stop plotting ${each.name}`,
              onclick: () => remove(each),
            },
            "×",
          ),
        ),
      ),
    );
    this.changed();
    this.draw();
  }

  clear(): void {
    this.times = [];
    this.rows = [];
  }

  add(time: number, seen: Seen | null): void {
    if (!this.chosen.length) {
      return;
    }
    if (this.times.length && time < this.times[this.times.length - 1]) {
      this.clear();
    }
    this.times.push(time);
    this.rows.push(this.chosen.map((each) => each.value(seen)));
    while (this.times.length > MOST || this.times[0] < time - SECONDS) {
      this.times.shift();
      this.rows.shift();
    }
    this.draw();
  }

  /** The values as a table, for the tests and to copy. */
  table(): string {
    return [
      ["time", ...this.chosen.map((each) => each.name)].join(","),
      ...this.rows.map((row, k) => [this.times[k], ...row].join(",")),
    ].join("\n");
  }

  private draw(): void {
    if (this.root.hidden || !this.root.clientWidth) {
      return;
    }
    const ratio = devicePixelRatio;
    const width = this.root.clientWidth;
    const pen = this.canvas.getContext("2d")!;
    const style = getComputedStyle(this.root);
    this.canvas.width = width * ratio;
    this.canvas.height = HEIGHT * ratio;
    pen.scale(ratio, ratio);
    const last = this.times[this.times.length - 1] ?? 0;
    const first = Math.max(0, last - SECONDS);
    const values = this.rows.flat().filter(Number.isFinite);
    let low = values.length ? Math.min(...values) : 0;
    let high = values.length ? Math.max(...values) : 1;
    if (high - low < 1e-9 * Math.max(1, Math.abs(high))) {
      low -= 0.5;
      high += 0.5;
    }
    const left = 52;
    const right = width - 14;
    const top = 8;
    const bottom = HEIGHT - 20;
    const x = (time: number) => left + ((time - first) / Math.max(last - first, 1)) * (right - left);
    const y = (value: number) => bottom - ((value - low) / (high - low)) * (bottom - top);
    pen.font = "11px system-ui, sans-serif";
    pen.fillStyle = style.getPropertyValue("--soft");
    pen.strokeStyle = style.getPropertyValue("--line");
    pen.textAlign = "right";
    for (const value of [low, (low + high) / 2, high]) {
      pen.beginPath();
      pen.moveTo(left, y(value));
      pen.lineTo(right, y(value));
      pen.stroke();
      pen.fillText(neat(value, 3), left - 6, y(value) + 4);
    }
    pen.textAlign = "center";
    for (let second = Math.ceil(first); second <= Math.max(last, first + 1); second += last - first > 5 ? 2 : 1) {
      pen.fillText(`${second} s`, x(second), HEIGHT - 6);
    }
    this.chosen.forEach((_, k) => {
      pen.strokeStyle = COLORS[k % COLORS.length];
      pen.lineWidth = 1.6;
      pen.beginPath();
      this.rows.forEach((row, at) => pen.lineTo(x(this.times[at]), y(row[k])));
      pen.stroke();
    });
    const newest = this.rows[this.rows.length - 1];
    [...this.legend.children].forEach((entry, k) => {
      entry.querySelector("b")!.textContent = newest ? ` ${neat(newest[k], 4)} ${this.chosen[k].unit}` : "";
    });
    if (!this.rows.length) {
      pen.fillStyle = style.getPropertyValue("--soft");
      pen.fillText("Start the physics (space) to see these over time.", (left + right) / 2, (top + bottom) / 2 - 6);
    }
  }
}

const GROUPS = ["Sensors", "Joints", "Controls"] as const;

export class Meters {
  readonly panel = h("div", { className: "show meters" });
  readonly plot = new Plot(() => this.mark());
  private all: Signal[] = [];
  private readonly chosen = new Set<string>();
  private cells: { signal: Signal; value: HTMLElement; box: HTMLInputElement }[] = [];
  private seen: Seen | null = null;

  /** Show another model. Plots go on if the model still has their values. */
  use(model: Model, qpos: Float64Array, ctrl: number[]): void {
    this.all = signals(model, qpos, ctrl);
    const ids = new Set(this.all.map((each) => each.id));
    for (const id of this.chosen) {
      if (!ids.has(id)) {
        this.chosen.delete(id);
      }
    }
    this.cells = [];
    const sections = GROUPS.flatMap((group) => {
      const some = this.all.filter((each) => each.group === group);
      return some.length ? [h("h3", {}, group), ...some.map((each) => this.row(each))] : [];
    });
    this.panel.replaceChildren(
      h("p", { className: "hint" }, "Check a value to plot it while the physics run."),
      ...(model.scene.sensor.name.length ? [] : [h("p", { className: "hint" }, "The model has no sensors.")]),
      ...sections,
    );
    this.plotted();
  }

  private row(signal: Signal): HTMLElement {
    const box = h("input", {
      type: "checkbox",
      checked: this.chosen.has(signal.id),
      onchange: () => this.flip(signal, box.checked),
    });
    const value = h("span", { className: "value" });
    this.cells.push({ signal, value, box });
    return h(
      "label",
      { className: "check", title: `${signal.kind} ${signal.name}` },
      box,
      nameSpan(signal.name),
      value,
    );
  }

  private flip(signal: Signal, on: boolean): void {
    if (on) {
      this.chosen.add(signal.id);
    } else {
      this.chosen.delete(signal.id);
    }
    this.plotted();
  }

  private plotted(): void {
    this.plot.choose(
      this.all.filter((each) => this.chosen.has(each.id)),
      (each) => this.flip(each, false),
    );
  }

  private mark(): void {
    let k = 0;
    for (const { signal, box } of this.cells) {
      box.checked = this.chosen.has(signal.id);
      box.style.accentColor = box.checked ? COLORS[k++ % COLORS.length] : "";
    }
    this.show(this.seen, null);
  }

  /** A state, and its time if physics run. */
  show(seen: Seen | null, time: number | null): void {
    this.seen = seen;
    if (time !== null) {
      this.plot.add(time, seen);
    }
    if (!this.panel.offsetParent) {
      return;
    }
    for (const { signal, value } of this.cells) {
      const exact = signal.value(seen);
      const number = Math.abs(exact) < 1e-9 ? 0 : exact;
      value.textContent = Number.isFinite(number)
        ? `${neat(number, 4)}${signal.unit === "°" ? "°" : signal.unit && ` ${signal.unit}`}`
        : "–";
    }
  }

  /** The panel has become visible. */
  open(): void {
    this.show(this.seen, null);
  }
}
