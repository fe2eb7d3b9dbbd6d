// The states of the last seconds, which the page can show again.
import type { Seen } from "./data";

export interface State {
  qpos: Float64Array;
  qvel: Float64Array;
  act: Float64Array;
  ctrl: Float64Array;
  time: number;
  seen: Seen;
}

const MOST_SECONDS = 10;
const MOST_BYTES = 50e6;
const NUMBER = 8;

function sizeOf({ qpos, qvel, act, ctrl, seen }: State): number {
  const { contacts, tendons, sensors } = seen;
  const lists: ArrayLike<number>[] = [qpos, qvel, act, ctrl, sensors, ...contacts, ...tendons];
  return NUMBER * lists.reduce((sum, each) => sum + each.length, 0);
}

export class Past {
  private states: State[] = [];
  private bytes = 0;

  /** Keep a state. Later states are forgotten: the physics went on from an earlier one. */
  add(state: State): void {
    while (this.states.length && this.states[this.states.length - 1].time >= state.time) {
      this.bytes -= sizeOf(this.states.pop()!);
    }
    this.states.push(state);
    this.bytes += sizeOf(state);
    while (this.states.length > 1 && (state.time - this.states[0].time > MOST_SECONDS || this.bytes > MOST_BYTES)) {
      this.bytes -= sizeOf(this.states.shift()!);
    }
  }

  /** The last state that is not after a time, or the first one. */
  at(time: number): State | null {
    const later = this.states.findIndex((state) => state.time > time + 1e-9);
    const number = later < 0 ? this.states.length - 1 : Math.max(0, later - 1);
    return this.states[number] ?? null;
  }

  get range(): [number, number] | null {
    return this.states.length ? [this.states[0].time, this.states[this.states.length - 1].time] : null;
  }

  clear(): void {
    this.states = [];
    this.bytes = 0;
  }
}
