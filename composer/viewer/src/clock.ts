// The time of the physics, and how fast it passes.
import { h } from "./dom";

const WINDOW = 1000;

export class Clock {
  readonly root = h("div", { className: "clock", hidden: true });
  private past: [wall: number, time: number][] = [];

  show(time: number): void {
    const now = performance.now();
    if (this.past.length && time < this.past[this.past.length - 1][1]) this.past = [];
    this.past.push([now, time]);
    while (this.past.length > 2 && this.past[1][0] < now - WINDOW) this.past.shift();
    const [wall, before] = this.past[0], factor = now - wall > 100 ? (time - before) / (now - wall) * 1000 : null;
    this.root.hidden = false;
    this.root.textContent = `${time.toFixed(2)} s${factor === null ? "" : ` · ${factor.toFixed(2)}× real time`}`;
  }

  pause(): void {
    this.past = [];
    this.root.textContent = this.root.textContent!.replace(/ · .*/, " · paused");
  }

  reset(): void {
    this.past = [];
    this.root.hidden = true;
  }
}
