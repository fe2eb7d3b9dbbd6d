// Sliders for joints and controls, and the pose as a keyframe of a recipe.
import { type Model, row } from "./data";
import { colorTo, copy, h, nameSpan } from "./dom";
import { degrees, JOINT_NAMES, neat } from "./info";
import { FREE, HINGE, type Pose, SLIDE, WIDTHS } from "./kinematics";
import { NumberBox, type Quantity } from "./numbers";

/** A number with a slider and a box: its name, its range, and how it is shown, read and changed. */
interface Dial {
  name: string;
  quantity: Quantity;
  range: number[];
  limited: boolean;
  more?: string;
  shown: (value: number) => string;
  get: () => number;
  put: (value: number) => void;
  changed: () => void;
}

const meters = (value: number): string => `${neat(value)} m`;

export class Sliders {
  readonly joints = h("div", { className: "sliders" });
  readonly controls = h("div", { className: "sliders" });
  readonly ctrl: number[];
  private readonly all: (() => void)[] = [];

  constructor(
    private readonly model: Model,
    private readonly pose: Pose,
    private readonly moved: () => void,
    private readonly controlled: () => void,
  ) {
    const { scene } = model;
    const counts = scene.actuator.range.length / 2;
    this.ctrl = new Array(counts).fill(0);
    scene.joint.name.forEach((name, j) => this.joint(name || `joint#${j}`, j));
    scene.actuator.name.forEach((name, a) => this.control(name || `actuator#${a}`, a));
    if (!scene.joint.name.length) {
      this.joints.append(h("p", { className: "hint" }, "The model has no joints."));
    }
    if (!scene.actuator.name.length) {
      this.controls.append(h("p", { className: "hint" }, "The model has no actuators."));
    }
  }

  private joint(name: string, j: number): void {
    const { joint, look, qpos0 } = this.model.scene;
    const type = joint.type[j];
    const q = joint.qpos[j];
    const { qpos } = this.pose;
    if (type >= SLIDE) {
      const limited = joint.limited[j];
      const far = type === HINGE ? Math.PI : Math.max(look.extent, 0.1);
      const range = limited ? row(joint.range, j, 2) : [qpos0[q] - far, qpos0[q] + far];
      this.joints.append(
        this.slider({
          name,
          quantity: type === HINGE ? "angle" : "length",
          range,
          limited: Boolean(limited),
          shown: type === HINGE ? degrees : meters,
          get: () => qpos[q],
          put: (value) => {
            qpos[q] = value;
          },
          changed: this.moved,
        }),
      );
      return;
    }
    const rows: HTMLElement[] = [];
    if (type === FREE) {
      ["x", "y", "z"].forEach((axis, k) => {
        const far = 2 * look.extent;
        rows.push(
          this.slider({
            name: axis,
            quantity: "length",
            range: [qpos0[q + k] - far, qpos0[q + k] + far],
            limited: false,
            shown: meters,
            get: () => qpos[q + k],
            put: (value) => {
              qpos[q + k] = value;
            },
            changed: this.moved,
          }),
        );
      });
    }
    const first = type === FREE ? q + 3 : q;
    ["roll", "pitch", "yaw"].forEach((axis, k) => {
      const half = k === 1 ? Math.PI / 2 : Math.PI;
      rows.push(
        this.slider({
          name: axis,
          quantity: "angle",
          range: [-half, half],
          limited: false,
          shown: degrees,
          get: () => angles(qpos, first)[k],
          put: (value) => {
            const turns = angles(qpos, first);
            turns[k] = value;
            turn(qpos, first, turns);
          },
          changed: this.moved,
        }),
      );
    });
    this.joints.append(
      h(
        "details",
        { open: this.model.scene.joint.name.length < 4 },
        h("summary", { title: JOINT_NAMES[type] }, name, h("span", { className: "badge" }, JOINT_NAMES[type])),
        ...rows,
      ),
    );
  }

  private control(name: string, a: number): void {
    const { actuator, joint, tendon } = this.model.scene;
    const at = actuator.control[a];
    const target = actuator.target[2 * a];
    const kind = actuator.transmission[a];
    let moves = "";
    if (kind <= 1) {
      moves = joint.name[target];
    } else if (kind === 3) {
      moves = tendon.name[target];
    }
    const next = a + 1 < actuator.control.length ? actuator.control[a + 1] : this.ctrl.length;
    for (let k = at; k < Math.max(next, at + 1); k++) {
      const limited = Boolean(actuator.limited[k]);
      const range = limited ? row(actuator.range, k, 2) : [-1, 1];
      this.controls.append(
        this.slider({
          name: next - at > 1 ? `${name} ${k - at}` : name,
          quantity: "plain",
          range,
          limited,
          more: moves && `moves ${moves}`,
          shown: neat,
          get: () => this.ctrl[k],
          put: (value) => {
            this.ctrl[k] = value;
          },
          changed: this.controlled,
        }),
      );
    }
  }

  private slider(dial: Dial): HTMLElement {
    const { name, shown, limited, more = "" } = dial;
    const [low, high] = dial.range;
    const range = h("input", { type: "range", min: String(low), max: String(high), step: "any", ariaLabel: name });
    const change = (value: number) => {
      dial.put(value);
      show();
      dial.changed();
    };
    const number = new NumberBox(`${name}, value`, dial.quantity, () => shown(dial.get()), change);
    const show = () => {
      const value = dial.get();
      range.value = String(value);
      colorTo(range, value, dial.range);
      number.show();
      number.root.classList.toggle("outside", limited && (value < low - 1e-9 || value > high + 1e-9));
    };
    range.addEventListener("input", () => change(Number(range.value)));
    this.all.push(show);
    show();
    const ends = h(
      "span",
      { className: limited ? "ends" : "ends open" },
      h("span", {}, limited ? shown(low) : ""),
      h("span", { className: "more" }, more),
      h("span", {}, limited ? shown(high) : ""),
    );
    return h("div", { className: "slider", title: name }, h("label", {}, nameSpan(name)), number.root, range, ends);
  }

  /** Show the pose as it is now. */
  refresh(): void {
    for (const show of this.all) {
      show();
    }
  }

  setControls(values: number[]): void {
    values.forEach((value, k) => {
      this.ctrl[k] = value;
    });
    this.refresh();
  }

  /** The pose as an entry of `keyframe`, by name, as far as it is not the reference. */
  snippet(): string {
    const { joint, actuator, qpos0, body } = this.model.scene;
    const { qpos, mpos, mquat } = this.pose;
    const lines = ["keyframe:", "  pose:"];
    const moved: string[] = [];
    const controls: string[] = [];
    const mocap: string[] = [];
    joint.name.forEach((name, j) => {
      const q = joint.qpos[j];
      const width = WIDTHS[joint.type[j]];
      const values = Array.from(qpos.slice(q, q + width));
      if (values.every((value, k) => Math.abs(value - qpos0[q + k]) < 1e-9)) {
        return;
      }
      if (!name) {
        moved.push(`      # joint#${j} has no name: ${values.map(exact).join(" ")}`);
      } else if (joint.type[j] === HINGE) {
        moved.push(`      ${name}: ${exact((values[0] * 180) / Math.PI)}deg`);
      } else {
        moved.push(`      ${name}: ${width === 1 ? exact(values[0]) : `[${values.map(exact).join(", ")}]`}`);
      }
    });
    if (moved.length) {
      lines.push("    qpos:", ...moved);
    }
    actuator.name.forEach((name, a) => {
      const value = this.ctrl[actuator.control[a]];
      if (name && value) {
        controls.push(`      ${name}: ${exact(value)}${this.isAngle(a) ? "rad" : ""}`);
      }
    });
    if (controls.length) {
      lines.push("    ctrl:", ...controls);
    }
    body.mocap.forEach((number: number, b: number) => {
      if (number < 0 || !body.name[b]) {
        return;
      }
      const place = Array.from(mpos.slice(3 * number, 3 * number + 3));
      const turned = Array.from(mquat.slice(4 * number, 4 * number + 4));
      if (place.some((value, k) => Math.abs(value - body.pos[3 * b + k]) > 1e-9)) {
        mocap.push(`    mpos: {${body.name[b]}: [${place.map(exact).join(", ")}]}`);
      }
      if (turned.some((value, k) => Math.abs(value - body.quat[4 * b + k]) > 1e-9)) {
        mocap.push(`    mquat: {${body.name[b]}: [${turned.map(exact).join(", ")}]}`);
      }
    });
    lines.push(...mocap);
    if (lines.length === 2) {
      lines[1] = "  pose: {}";
    }
    return `${lines.join("\n")}\n`;
  }

  /** Whether a control has the unit of the hinge that it moves. */
  private isAngle(a: number): boolean {
    const { actuator, joint } = this.model.scene;
    return Boolean(actuator.angle?.[a]) && joint.type[actuator.target[2 * a]] === HINGE;
  }

  copyPose = (): Promise<void> => copy(this.snippet());
}

const exact = (value: number): string => String(Number(value.toFixed(6)));

/** Roll, pitch and yaw of a quaternion w x y z. */
function angles(q: Float64Array, i: number): [number, number, number] {
  const [w, x, y, z] = [q[i], q[i + 1], q[i + 2], q[i + 3]];
  const sine = Math.max(-1, Math.min(1, 2 * (w * y - z * x)));
  return [
    Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    Math.asin(sine),
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  ];
}

function turn(q: Float64Array, i: number, [roll, pitch, yaw]: [number, number, number]): void {
  const [cr, sr, cp, sp, cy, sy] = [
    Math.cos(roll / 2),
    Math.sin(roll / 2),
    Math.cos(pitch / 2),
    Math.sin(pitch / 2),
    Math.cos(yaw / 2),
    Math.sin(yaw / 2),
  ];
  q[i] = cr * cp * cy + sr * sp * sy;
  q[i + 1] = sr * cp * cy - cr * sp * sy;
  q[i + 2] = cr * sp * cy + sr * cp * sy;
  q[i + 3] = cr * cp * sy - sr * sp * cy;
}
