// The facts about a state beyond the poses of bodies: contacts, paths of tendons, and values of sensors.
import { SLIDE, HINGE } from "./kinematics";
import type { Model } from "./data";

/** A contact has its two geoms, its position, its normal, and the force on the second geom. */
export interface Seen { contacts: number[][]; tendons: number[][]; sensors: number[] }

/** A pull at a point of a body, in its frame, to a point of the world. */
export interface Pull { body: number; at: number[]; to: number[] }

/** A number over time that can be watched. */
export interface Signal { id: string; name: string; unit: string; group: "Sensors" | "Joints" | "Controls"; kind: string; value: (seen: Seen | null) => number }

const UNITS: Record<string, string> = {
  touch: "N", force: "N", accelerometer: "m/s²", velocimeter: "m/s", gyro: "rad/s", torque: "N·m", rangefinder: "m", clock: "s", tendonpos: "m", tendonvel: "m/s",
  framepos: "m", framelinvel: "m/s", frameangvel: "rad/s", framelinacc: "m/s²", frameangacc: "rad/s²", subtreecom: "m", subtreelinvel: "m/s", geomdist: "m", e_potential: "J", e_kinetic: "J",
};
const ENDS = ["x", "y", "z"], TURN = ["w", "x", "y", "z"];

export function signals(model: Model, qpos: Float64Array, ctrl: number[]): Signal[] {
  const { sensor, joint, actuator } = model.scene, found: Signal[] = [];
  sensor.name.forEach((own, s) => {
    const name = own || `sensor#${s}`, count = sensor.count[s], kind = sensor.kind[s], ends = count === 3 ? ENDS : count === 4 ? TURN : null;
    for (let k = 0; k < count; k++) {
      found.push({ id: `sensor ${name} ${k}`, name: count === 1 ? name : `${name} ${ends?.[k] ?? k}`, unit: UNITS[kind] ?? "", group: "Sensors", kind, value: (seen) => seen?.sensors[sensor.first[s] + k] ?? NaN });
    }
  });
  joint.name.forEach((own, j) => {
    const name = own || `joint#${j}`, type = joint.type[j], factor = type === HINGE ? 180 / Math.PI : 1;
    if (type >= SLIDE) found.push({ id: `joint ${name}`, name, unit: type === HINGE ? "°" : "m", group: "Joints", kind: "joint", value: () => qpos[joint.qpos[j]] * factor });
  });
  actuator.name.forEach((own, a) => {
    const name = own || `actuator#${a}`;
    found.push({ id: `actuator ${name}`, name, unit: "", group: "Controls", kind: "control", value: () => ctrl[actuator.control[a]] });
  });
  return found;
}
