// Sensors, joints and controls with their values, of which some are plotted.
import type { Model } from "./data";
import { h } from "./dom";
import { neat } from "./info";
import { COLORS, Plot } from "./plot";
import { signals, type Seen, type Signal } from "./seen";

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
    for (const id of this.chosen) if (!ids.has(id)) this.chosen.delete(id);
    this.cells = [];
    const sections = GROUPS.flatMap((group) => {
      const some = this.all.filter((each) => each.group === group);
      return some.length ? [h("h3", {}, group), ...some.map((each) => this.row(each))] : [];
    });
    this.panel.replaceChildren(h("p", { className: "hint" }, "Check a value to plot it while the physics run."), ...(model.scene.sensor.name.length ? [] : [h("p", { className: "hint" }, "The model has no sensors.")]), ...sections);
    this.plotted();
  }

  private row(signal: Signal): HTMLElement {
    const box = h("input", { type: "checkbox", checked: this.chosen.has(signal.id), onchange: () => this.flip(signal, box.checked) });
    const value = h("span", { className: "value" });
    this.cells.push({ signal, value, box });
    return h("label", { className: "check", title: `${signal.kind} ${signal.name}` }, box, h("span", { className: "name" }, signal.name), value);
  }

  private flip(signal: Signal, on: boolean): void {
    if (on) this.chosen.add(signal.id);
    else this.chosen.delete(signal.id);
    this.plotted();
  }

  private plotted(): void {
    this.plot.choose(this.all.filter((each) => this.chosen.has(each.id)), (each) => this.flip(each, false));
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
    if (time !== null) this.plot.add(time, seen);
    if (!this.panel.offsetParent) return;
    for (const { signal, value } of this.cells) {
      const found = signal.value(seen), number = Math.abs(found) < 1e-9 ? 0 : found;
      value.textContent = Number.isFinite(number) ? `${neat(number, 4)}${signal.unit === "°" ? "°" : signal.unit && ` ${signal.unit}`}` : "–";
    }
  }

  /** The panel has become visible. */
  open(): void {
    this.show(this.seen, null);
  }
}
