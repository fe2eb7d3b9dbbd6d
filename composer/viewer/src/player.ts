// The requests to the physics, which run in the page or on its server, and their answers.
import type { Pull, Seen } from "./data";

export interface Player {
  /** Run, or pause. */
  play(): void;
  /** One step, and pause. */
  step(): void;
  /** Time 0 of a keyframe, -1 for the reference; a simulation that runs goes on running. */
  reset(key: number): void;
  /** Pause at a time of the last seconds, without running again. */
  back(time: number): void;
  /** Seconds of physics in a second. */
  setSpeed(speed: number): void;
  /** The pose or the controls of the page have changed. */
  pose(): void;
  /** Ask for contacts and sensors of the pose. */
  look(): void;
  pull(pull: Pull | null): void;
  choose(name: string, value: string | number): void;
}

/** A state of the physics. `kept` is the range of times that can be shown again. */
export interface Shot {
  qpos: ArrayLike<number>;
  seen: Seen | null;
  time: number;
  ctrl?: ArrayLike<number>;
  kept?: [number, number] | null;
}

export const SPEEDS = [0.25, 0.5, 1, 2, 4];
