// Chosen numbers over the last seconds of physics, as lines below the picture.
import { h } from "./dom";
import { neat } from "./info";
import type { Seen, Signal } from "./seen";

const SECONDS = 10, MOST = 4000, HEIGHT = 150;
export const COLORS = ["#3b82f6", "#ef4444", "#10b981", "#f59e0b", "#8b5cf6", "#ec4899", "#14b8a6", "#84cc16"];

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
  choose(signals: Signal[], remove: (signal: Signal) => void): void {
    const same = signals.map((each) => each.id).join() === this.chosen.map((each) => each.id).join();
    this.chosen = signals;
    if (!same) this.clear();
    this.root.hidden = !signals.length;
    if (signals.length) this.root.append(this.canvas);
    this.legend.replaceChildren(...signals.map((each, k) =>
      h("span", {}, h("i", { className: "dot", style: `background:${COLORS[k % COLORS.length]}` }), each.name, h("b", {}), h("button", { title: `stop plotting ${each.name}`, ariaLabel: `stop plotting ${each.name}`, onclick: () => remove(each) }, "×"))));
    this.changed();
    this.draw();
  }

  clear(): void {
    this.times = [];
    this.rows = [];
  }

  add(time: number, seen: Seen | null): void {
    if (!this.chosen.length) return;
    if (this.times.length && time < this.times[this.times.length - 1]) this.clear();
    this.times.push(time);
    this.rows.push(this.chosen.map((each) => each.value(seen)));
    while (this.times.length > MOST || this.times[0] < time - SECONDS) { this.times.shift(); this.rows.shift(); }
    this.draw();
  }

  /** The values as a table, for the tests and to copy. */
  table(): string {
    return [["time", ...this.chosen.map((each) => each.name)].join(","), ...this.rows.map((row, k) => [this.times[k], ...row].join(","))].join("\n");
  }

  private draw(): void {
    if (this.root.hidden || !this.root.clientWidth) return;
    const ratio = devicePixelRatio, width = this.root.clientWidth, pen = this.canvas.getContext("2d")!, style = getComputedStyle(this.root);
    this.canvas.width = width * ratio; this.canvas.height = HEIGHT * ratio;
    pen.scale(ratio, ratio);
    const last = this.times[this.times.length - 1] ?? 0, first = Math.max(0, last - SECONDS), values = this.rows.flat().filter(Number.isFinite);
    let low = values.length ? Math.min(...values) : 0, high = values.length ? Math.max(...values) : 1;
    if (high - low < 1e-9 * Math.max(1, Math.abs(high))) { low -= 0.5; high += 0.5; }
    const left = 52, right = width - 14, top = 8, bottom = HEIGHT - 20;
    const x = (time: number) => left + (time - first) / Math.max(last - first, 1) * (right - left), y = (value: number) => bottom - (value - low) / (high - low) * (bottom - top);
    pen.font = "11px system-ui, sans-serif";
    pen.fillStyle = style.getPropertyValue("--soft");
    pen.strokeStyle = style.getPropertyValue("--line");
    pen.textAlign = "right";
    for (const value of [low, (low + high) / 2, high]) {
      pen.beginPath(); pen.moveTo(left, y(value)); pen.lineTo(right, y(value)); pen.stroke();
      pen.fillText(neat(value, 3), left - 6, y(value) + 4);
    }
    pen.textAlign = "center";
    for (let second = Math.ceil(first); second <= Math.max(last, first + 1); second += last - first > 5 ? 2 : 1) pen.fillText(`${second} s`, x(second), HEIGHT - 6);
    this.chosen.forEach((_, k) => {
      pen.strokeStyle = COLORS[k % COLORS.length];
      pen.lineWidth = 1.6;
      pen.beginPath();
      this.rows.forEach((row, at) => pen.lineTo(x(this.times[at]), y(row[k])));
      pen.stroke();
    });
    const row = this.rows[this.rows.length - 1];
    [...this.legend.children].forEach((each, k) => { each.querySelector("b")!.textContent = row ? ` ${neat(row[k], 4)} ${this.chosen[k].unit}` : ""; });
    if (!this.rows.length) { pen.fillStyle = style.getPropertyValue("--soft"); pen.fillText("Start the physics (space) to see these over time.", (left + right) / 2, (top + bottom) / 2 - 6); }
  }
}
