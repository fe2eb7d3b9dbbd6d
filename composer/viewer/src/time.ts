// The bar below the picture: run, step, reset, the speed, and the last seconds again.
import { colorTo, h, icon } from "./dom";
import type { Player } from "./player";
import { SPEEDS } from "./player";

const WORDS: Record<number, string> = { 0.25: "¼×", 0.5: "½×" };
const WINDOW = 1000;
/** How far the key for back goes, in seconds. */
const BACK = 0.1;

/** The time of the physics, and how fast it passes. */
class Clock {
  readonly root = h("div", { className: "clock", hidden: true });
  private past: [wall: number, time: number][] = [];

  show(time: number): void {
    const now = performance.now();
    if (this.past.length && time < this.past[this.past.length - 1][1]) {
      this.past = [];
    }
    this.past.push([now, time]);
    while (this.past.length > 2 && this.past[1][0] < now - WINDOW) {
      this.past.shift();
    }
    const [wall, before] = this.past[0];
    const factor = now - wall > 100 ? ((time - before) / (now - wall)) * 1000 : null;
    this.root.hidden = false;
    this.root.textContent = `${time.toFixed(2)} s${factor === null ? "" : ` · ${factor.toFixed(2)}× real time`}`;
  }

  pause(time: number | null): void {
    this.past = [];
    if (time !== null) {
      this.root.hidden = false;
      this.root.textContent = `${time.toFixed(2)} s · paused`;
    }
  }

  reset(): void {
    this.past = [];
    this.root.hidden = true;
  }
}

export class TimeBar {
  readonly root: HTMLElement;
  readonly clock = new Clock();
  isPlaying = false;
  private now: number | null = null;
  private kept: [number, number] | null = null;
  private readonly playButton: HTMLButtonElement;
  private readonly speed: HTMLSelectElement;
  private readonly range: HTMLInputElement;

  constructor(
    private readonly player: () => Player | null,
    reset: () => void,
  ) {
    const button = (name: string, title: string, act: () => void) =>
      h("button", { className: "tool", title, ariaLabel: title, onclick: act }, icon(name));
    this.playButton = button("play", "physics (space)", () => this.player()?.play());
    this.speed = h(
      "select",
      {
        ariaLabel: "speed",
        title: "seconds of physics in a second",
        onchange: () => this.player()?.setSpeed(Number(this.speed.value)),
      },
      ...SPEEDS.map((speed) =>
        h("option", { value: String(speed), selected: speed === 1 }, WORDS[speed] ?? `${speed}×`),
      ),
    );
    this.range = h("input", {
      type: "range",
      step: "any",
      hidden: true,
      ariaLabel: "the last seconds",
      title: "go back over the last seconds",
      oninput: () => this.player()?.back(Number(this.range.value)),
    });
    this.root = h(
      "div",
      { className: "time", role: "group", ariaLabel: "time", hidden: true },
      button("reset", "reset (Backspace)", reset),
      this.playButton,
      button("step", "one step (.)", () => this.player()?.step()),
      this.speed,
      this.range,
    );
  }

  /** The time of the state that is shown, and the times that can be shown again. */
  show(time: number, kept: [number, number] | null | undefined): void {
    this.now = time;
    if (this.isPlaying) {
      this.clock.show(time);
    } else {
      this.clock.pause(time);
    }
    if (kept === undefined) {
      return;
    }
    this.kept = kept;
    this.range.hidden = kept === null || kept[0] === kept[1];
    if (kept && document.activeElement !== this.range) {
      [this.range.min, this.range.max] = kept.map(String);
      this.range.value = String(time);
    }
    colorTo(this.range, time, kept ?? [0, 0]);
  }

  /** Go back a little. */
  back(): void {
    if (this.now !== null && this.kept) {
      this.player()?.back(Math.max(this.kept[0], this.now - BACK));
    }
  }

  setPlaying(playing: boolean): void {
    this.isPlaying = playing;
    if (!playing) {
      this.clock.pause(this.now);
    } else if (document.activeElement === this.range) {
      this.range.blur();
    }
    this.playButton.replaceChildren(icon(playing ? "pause" : "play"));
    this.playButton.classList.toggle("on", playing);
  }

  setSpeed(speed: number): void {
    this.speed.value = String(speed);
  }

  /** Another model, or the time 0. */
  clear(): void {
    this.now = null;
    this.kept = null;
    this.range.hidden = true;
    this.clock.reset();
  }
}
