// The physics of one element: each value that acts on it, with its unit, and the attribute that gives it.
import type { Element, Scene } from "./data";
import { row } from "./data";
import { degrees, neat } from "./info";
import { BALL, FREE, HINGE, SLIDE } from "./kinematics";

/** A value in words, and the attributes of MJCF from which it comes. */
export interface Fact {
  what: string;
  value: string;
  from: string[];
  /** The element that has the attributes, if it is another one. */
  of?: Element;
}

const TRANSMISSION_OF_JOINT = [0, 1];
const MOST_PARTNERS = 12;
const SPRING_UNITS = { angle: "N·m/rad", length: "N/m" };
const DAMPING_UNITS = { angle: "N·m·s/rad", length: "N·s/m" };
const FORCE_UNITS = { angle: "N·m", length: "N" };

const span = (low: number, high: number, unit: string): string =>
  low === -high ? `± ${neat(high)} ${unit}` : `${neat(low)} … ${neat(high)} ${unit}`;

/** `solref` in the words of its two forms. */
function solrefOf([first, second]: number[]): string {
  return first > 0
    ? `time constant ${neat(first)} s, damping ratio ${neat(second)}`
    : `stiffness ${neat(-first)} 1/s², damping ${neat(-second)} 1/s`;
}

const solimpOf = ([low, high, width]: number[]): string =>
  low === high ? `impedance ${neat(low)}` : `impedance ${neat(low)} … ${neat(high)} over ${neat(width)} m`;

export function* factsOf(scene: Scene, { kind, index }: Element): Generator<Fact> {
  if (kind === "body") {
    yield* bodyFacts(scene, index);
  } else if (kind === "joint") {
    yield* jointFacts(scene, index);
  } else if (kind === "geom") {
    yield* geomFacts(scene, index);
  } else if (kind === "actuator") {
    yield* actuatorFacts(scene, index);
  }
}

function* bodyFacts({ body }: Scene, index: number): Generator<Fact> {
  const within = new Set([index]);
  let total = 0;
  body.parent.forEach((parent: number, b: number) => {
    if (b > 0 && within.has(parent)) {
      within.add(b);
    }
    total += within.has(b) ? body.mass[b] : 0;
  });
  if (within.size > 1) {
    yield { what: "with all below", value: `${neat(total)} kg`, from: [] };
  }
  if (body.gravcomp[index]) {
    yield { what: "gravity lifted", value: `${neat(100 * body.gravcomp[index])} %`, from: ["gravcomp"] };
  }
}

function* jointFacts(scene: Scene, index: number): Generator<Fact> {
  const { joint } = scene;
  const type = joint.type[index];
  const quantity = type === SLIDE ? "length" : "angle";
  const unit = type === FREE ? "SI" : DAMPING_UNITS[quantity];
  yield { what: "damping", value: `${neat(joint.damping[index])} ${unit}`, from: ["damping"] };
  const heavy = type === SLIDE ? "kg" : "kg·m²";
  yield {
    what: "armature",
    value: `${neat(joint.armature[index])} ${type === FREE ? "SI" : heavy}`,
    from: ["armature"],
  };
  const force = type === FREE ? "SI" : FORCE_UNITS[quantity];
  yield { what: "dry friction", value: `${neat(joint.frictionloss[index])} ${force}`, from: ["frictionloss"] };
  if (joint.stiffness[index]) {
    const rest = type === HINGE ? degrees(joint.rest[index]) : `${neat(joint.rest[index])} m`;
    const at = type === FREE || type === BALL ? "" : `, at rest at ${rest}`;
    yield {
      what: "spring",
      value: `${neat(joint.stiffness[index])} ${SPRING_UNITS[quantity]}${at}`,
      from: ["stiffness", "springref"],
    };
  }
  if (joint.forcelimited[index]) {
    const [low, high] = row(joint.forcerange, index, 2);
    yield { what: "effort", value: span(low, high, FORCE_UNITS[quantity]), from: ["actuatorfrcrange"] };
  }
  if (joint.limited[index]) {
    yield { what: "limit", value: solrefOf(row(joint.solref, index, 2)), from: ["solreflimit"] };
    yield { what: "", value: solimpOf(row(joint.solimp, index, 5)), from: ["solimplimit"] };
  }
  for (const [actuator, target] of targetsOf(scene)) {
    if (target === index) {
      const name = scene.actuator.name[actuator] || `actuator#${actuator}`;
      for (const fact of atJoint(scene, actuator, `by ${name}`)) {
        yield { ...fact, of: { kind: "actuator", index: actuator } };
      }
    }
  }
}

/** The actuators on joints, each with its joint. */
function* targetsOf({ actuator }: Scene): Generator<[actuator: number, joint: number]> {
  for (const [index, kind] of actuator.transmission.entries()) {
    if (TRANSMISSION_OF_JOINT.includes(kind)) {
      yield [index, actuator.target[2 * index]];
    }
  }
}

/**
 * The gains of an actuator as they act at its joint: a gear multiplies a gain by its square, and a force by itself.
 * `ending` are the last words of each value.
 */
function* atJoint({ actuator, joint }: Scene, index: number, ending: string): Generator<Fact> {
  const gear = actuator.gear[6 * index];
  const quantity = joint.type[actuator.target[2 * index]] === SLIDE ? "length" : "angle";
  const { kp, kv, gain } = actuator;
  if (kp[index] !== null) {
    const value = `${neat(kp[index] * gear ** 2)} ${SPRING_UNITS[quantity]}`;
    yield { what: "stiffness", value: `${value} ${ending}`, from: ["kp", "gainprm", "gear"] };
  }
  if (kv[index]) {
    const value = `${neat(kv[index] * gear ** 2)} ${DAMPING_UNITS[quantity]}`;
    yield { what: "servo damping", value: `${value} ${ending}`, from: ["kv", "biasprm", "gear"] };
  }
  if (gain[index] !== null) {
    const value = `${neat(gain[index] * gear)} ${FORCE_UNITS[quantity]} for a control of 1`;
    yield { what: "motor", value: `${value} ${ending}`, from: ["gainprm", "gear"] };
  }
  if (actuator.forcelimited[index]) {
    const ends = row(actuator.forcerange, index, 2).map((each) => each * gear);
    const value = span(Math.min(...ends), Math.max(...ends), FORCE_UNITS[quantity]);
    yield { what: "effort", value: `${value} ${ending}`, from: ["forcerange", "gear"] };
  }
}

function* actuatorFacts(scene: Scene, index: number): Generator<Fact> {
  const { actuator } = scene;
  const gear = row(actuator.gear, index, 6);
  while (gear.length > 1 && gear[gear.length - 1] === 0) {
    gear.pop();
  }
  yield { what: "gear", value: gear.map((each) => neat(each)).join("  "), from: ["gear"] };
  if (actuator.forcelimited[index]) {
    const [low, high] = row(actuator.forcerange, index, 2);
    yield { what: "force", value: `${neat(low)} … ${neat(high)}`, from: ["forcerange"] };
  }
  if (TRANSMISSION_OF_JOINT.includes(actuator.transmission[index])) {
    yield* atJoint(scene, index, "at the joint");
  }
}

function* geomFacts(scene: Scene, index: number): Generator<Fact> {
  const { geom } = scene;
  if (!geom.contype[index] && !geom.conaffinity[index]) {
    return;
  }
  const [slide, spin, roll] = row(geom.friction, index, 3);
  yield { what: "friction", value: `sliding ${neat(slide)}`, from: ["friction"] };
  yield { what: "", value: `torsion ${neat(spin)} m, rolling ${neat(roll)} m`, from: ["friction"] };
  yield { what: "condim", value: String(geom.condim[index]), from: ["condim"] };
  if (geom.priority[index]) {
    yield { what: "priority", value: String(geom.priority[index]), from: ["priority"] };
  }
  yield { what: "contact", value: solrefOf(row(geom.solref, index, 2)), from: ["solref"] };
  yield { what: "", value: solimpOf(row(geom.solimp, index, 5)), from: ["solimp"] };
  if (geom.margin[index] || geom.gap[index]) {
    const value = `${neat(geom.margin[index])} m, gap ${neat(geom.gap[index])} m`;
    yield { what: "margin", value, from: ["margin", "gap"] };
  }
}

/** The friction of a geom with another one, and the reason for it. */
export interface Touch {
  other: number;
  friction: number;
  why: string;
}

/** The geoms that can touch a geom, with the sliding friction that acts. A `<pair>` has a friction of its own. */
export function touches(scene: Scene, index: number): { shown: Touch[]; more: number } {
  const { geom, pair } = scene;
  const paired = new Map<number, number>();
  pair.one.forEach((one: number, k: number) => {
    if (one === index || pair.other[k] === index) {
      paired.set(one === index ? pair.other[k] : one, pair.friction[5 * k]);
    }
  });
  const all: Touch[] = [...paired].map(([other, friction]) => ({ other, friction, why: "by a pair" }));
  const excluded = new Set<string>();
  scene.exclude.body1.forEach((one, k) => {
    excluded.add(`${one} ${scene.exclude.body2[k]}`).add(`${scene.exclude.body2[k]} ${one}`);
  });
  for (let other = 0; other < geom.body.length; other++) {
    if (paired.has(other) || !collide(scene, index, other, excluded)) {
      continue;
    }
    const [mine, theirs] = [geom.friction[3 * index], geom.friction[3 * other]];
    const [own, its] = [geom.priority[index], geom.priority[other]];
    if (own !== its) {
      all.push({ other, friction: own > its ? mine : theirs, why: "by priority" });
    } else {
      all.push({ other, friction: Math.max(mine, theirs), why: mine < theirs ? "its own is larger" : "" });
    }
  }
  return { shown: all.slice(0, MOST_PARTNERS), more: Math.max(0, all.length - MOST_PARTNERS) };
}

/** Whether MuJoCo looks for contacts of two geoms: `mj_collision` of MuJoCo 3.3 and 4.0 filters the pairs like this. */
function collide(scene: Scene, one: number, other: number, excluded: Set<string>): boolean {
  const { geom, body, filterparent } = scene;
  const fits = geom.contype[one] & geom.conaffinity[other] || geom.contype[other] & geom.conaffinity[one];
  const [first, second] = [geom.body[one], geom.body[other]];
  if (one === other || !fits || excluded.has(`${first} ${second}`)) {
    return false;
  }
  const [a, b] = [body.weld[first], body.weld[second]];
  const [up, down] = [body.weld[body.parent[a]], body.weld[body.parent[b]]];
  const isFamily = filterparent && a !== 0 && b !== 0 && (a === down || b === up);
  return a !== b && !isFamily;
}
