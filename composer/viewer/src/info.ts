// The facts about the element that is selected or under the pointer, and what differs between two models.
import { Color } from "three";
import {
  type Change,
  type Difference,
  type Element,
  type Model,
  type Origin,
  type Place,
  row,
  type Scene,
} from "./data";
import { copy, h } from "./dom";
import { BALL, FREE, HINGE, SLIDE } from "./kinematics";
import { factsOf, touches } from "./mechanics";
import { colourOf } from "./paint";
import { SHAPE_NAMES } from "./shapes";
import { bodyOf, nameOf } from "./tree";
import { host } from "./wire";

export const JOINT_NAMES: Record<number, string> = {
  [FREE]: "free joint",
  [BALL]: "ball joint",
  [SLIDE]: "slide joint",
  [HINGE]: "hinge joint",
};
const LIGHTS = ["spot", "directional", "point", "image"];
const TRANSMISSIONS = ["joint", "joint", "slider-crank", "tendon", "site", "body"];

export const degrees = (angle: number): string => `${neat((angle * 180) / Math.PI, 4)}°`;

/** A number as short as it is still true to some digits. */
export function neat(value: number, digits = 4): string {
  return String(Math.abs(value) < 1e-12 ? 0 : Number(value.toPrecision(digits))).replaceAll("-", "−");
}

const list = (values: number[], unit = ""): string => values.map((each) => neat(each)).join("  ") + unit;

export function typeOf(model: Model, { kind, index }: Element): string {
  const { scene } = model;
  if (kind === "geom") {
    return SHAPE_NAMES[scene.geom.type[index]] ?? "geom";
  }
  if (kind === "joint") {
    return JOINT_NAMES[scene.joint.type[index]];
  }
  if (kind === "light") {
    return `${LIGHTS[scene.light.type[index]] ?? ""} light`;
  }
  return kind;
}

export class Info {
  readonly root = h("div", { className: "info" });

  constructor(
    private readonly model: Model,
    private readonly choose: (element: Element) => void,
  ) {}

  /** Show an element, and the `others` that are selected with it. */
  show(element: Element | null, others: Element[] = []): void {
    this.root.replaceChildren(
      ...(element
        ? [...this.together([...others, element]), ...this.rows(element)]
        : [h("p", { className: "hint" }, "Click something in the picture or in the tree.")]),
    );
  }

  /** The names of several elements, and the mass of their bodies together. */
  private together(elements: Element[]): HTMLElement[] {
    if (elements.length < 2) {
      return [];
    }
    const { body } = this.model.scene;
    const bodies = new Set(
      elements.map((each) => (each.kind === "body" ? each.index : bodyOf(this.model, each))).filter((b) => b >= 0),
    );
    const mass = [...bodies].reduce((sum, b) => sum + body.mass[b], 0);
    const names = elements.flatMap((each, k) => [k ? ", " : "", this.link(each)]);
    return [
      h(
        "p",
        { className: "together" },
        h("b", {}, `${elements.length} selected`),
        `, their bodies have ${neat(mass)} kg: `,
        ...names,
      ),
    ];
  }

  private rows(element: Element): HTMLElement[] {
    const { scene } = this.model;
    const name = nameOf(this.model, element);
    const kind = typeOf(this.model, element);
    const facts = h("dl", {});
    for (const [what, value] of this.facts(element)) {
      facts.append(h("dt", {}, what), h("dd", {}, value));
    }
    const origin: Origin = scene.origins.of[element.kind]?.[element.index] ?? null;
    return [
      h(
        "header",
        {},
        h("h2", { title: "copy the name", onclick: () => copy(name) }, name),
        h("span", { className: "badge" }, kind),
      ),
      facts,
      ...this.mechanics(element),
      ...(origin ? this.origin(origin) : []),
      ...(element.kind === "body" ? this.excluded(element.index) : []),
    ];
  }

  /** The values that act on an element, each with the line that wrote it. */
  private *mechanics(element: Element): Generator<HTMLElement> {
    const { scene } = this.model;
    const rows = [...factsOf(scene, element)].flatMap(({ what, value, from, of }) => {
      const owner = of ?? element;
      const places = scene.origins.values?.[owner.kind]?.[owner.index] ?? {};
      const written = from.map((name) => places[name]).find((place) => place);
      return [h("dt", {}, what), h("dd", {}, value, written ? " " : null, this.place(written ?? null, true))];
    });
    if (rows.length) {
      yield h("h3", {}, "Physics");
      yield h("dl", { className: "mechanics" }, ...rows);
    }
    if (element.kind !== "geom") {
      return;
    }
    const { shown, more } = touches(scene, element.index);
    if (shown.length) {
      yield h("h3", {}, "Sliding friction that acts");
      yield h(
        "dl",
        { className: "touches" },
        ...shown.flatMap(({ other, friction, why }) => [
          h("dt", {}, neat(friction)),
          h("dd", {}, this.link({ kind: "geom", index: other }), h("span", { className: "why" }, why && ` ${why}`)),
        ]),
      );
      yield h("p", { className: "hint" }, more ? `and ${more} more geoms` : "");
    }
  }

  /** The bodies that a body is kept from touching, each with the reason, if it has one, and its place. */
  private *excluded(body: number): Generator<HTMLElement> {
    const {
      exclude: { body1, body2 },
      origins,
    } = this.model.scene;
    const rows = body1.flatMap((one, k) => {
      if (one !== body && body2[k] !== body) {
        return [];
      }
      const [place, words, why] = origins.exclude[k];
      const other = this.link({ kind: "body", index: one === body ? body2[k] : one });
      return [h("li", {}, other, h("span", { className: "why" }, ` ${why ?? words} `), this.place(place))];
    });
    if (!rows.length) {
      return;
    }
    yield h("h3", {}, "Contacts that are excluded");
    yield h("ul", { className: "changes" }, ...rows);
  }

  private link(element: Element): HTMLElement {
    return h(
      "a",
      {
        href: "#",
        onclick: (event: Event) => {
          event.preventDefault();
          this.choose(element);
        },
      },
      nameOf(this.model, element),
    );
  }

  private *facts(element: Element): Generator<[string, Node | string]> {
    const { kind, index } = element;
    const { scene } = this.model;
    if (kind === "body") {
      yield* this.bodyFacts(index);
    } else {
      const body = bodyOf(this.model, element);
      if (body >= 0) {
        yield ["body", this.link({ kind: "body", index: body })];
      }
    }
    if (kind === "joint") {
      yield* this.jointFacts(index);
    } else if (kind === "geom" || kind === "site") {
      yield* this.shapeFacts(kind, index);
    } else if (kind === "camera") {
      yield ["field of view", `${neat(scene.camera.fovy[index])}°`];
    } else if (kind === "actuator") {
      yield* this.actuatorFacts(index);
    }
  }

  private *bodyFacts(index: number): Generator<[string, Node | string]> {
    const { body } = this.model.scene;
    if (index > 0) {
      yield ["parent", this.link({ kind: "body", index: body.parent[index] })];
    }
    yield ["mass", `${neat(body.mass[index])} kg`];
    yield ["principal moments", list(row(body.inertia, index, 3), " kg·m²")];
    yield ["center of mass", list(row(body.ipos, index, 3), " m")];
    yield ["position", list(row(body.pos, index, 3), " m")];
    if (body.mocap[index] >= 0) {
      yield ["mocap", "moved by the program"];
    }
  }

  private *jointFacts(index: number): Generator<[string, string]> {
    const { joint } = this.model.scene;
    const isSlide = joint.type[index] === SLIDE;
    const shown = (value: number) => (isSlide ? `${neat(value)} m` : degrees(value));
    if (joint.limited[index]) {
      yield ["range", `${shown(joint.range[2 * index])} … ${shown(joint.range[2 * index + 1])}`];
    }
    if (joint.type[index] >= SLIDE) {
      yield ["axis", list(row(joint.axis, index, 3))];
    }
    yield ["in qpos", `${joint.qpos[index]}`];
  }

  private *shapeFacts(kind: "geom" | "site", index: number): Generator<[string, Node | string]> {
    const { scene } = this.model;
    const columns = scene[kind];
    if (kind === "geom" && !columns.name[index]) {
      yield ["number", `geom#${index}`];
    }
    if (kind === "site" || scene.geom.data[index] < 0) {
      yield ["size", list(row(columns.size, index, 3), " m")];
    }
    yield ["group", String(columns.group[index])];
    const material = columns.material[index];
    const rgba = colourOf(this.model, row(columns.rgba, index, 4), material);
    const swatch = h("i", {
      className: "swatch",
      style: `background:rgba(${rgba.slice(0, 3).map((each) => Math.round(255 * each))},${rgba[3]})`,
    });
    const color = material >= 0 ? scene.material.name[material] || `material#${material}` : list(rgba);
    yield ["color", h("span", {}, swatch, color)];
    if (kind === "geom") {
      const { contype, conaffinity, body } = scene.geom;
      const collides = contype[index] || conaffinity[index];
      yield ["collides", collides ? `contype ${contype[index]}, conaffinity ${conaffinity[index]}` : "no"];
      yield ["body's mass", `${neat(scene.body.mass[body[index]])} kg`];
    }
  }

  private *actuatorFacts(index: number): Generator<[string, Node | string]> {
    const { actuator } = this.model.scene;
    const target = actuator.target[2 * index];
    const moved = TRANSMISSIONS[actuator.transmission[index]] ?? "";
    if (moved === "joint" || moved === "tendon" || moved === "site" || moved === "body") {
      yield [moved, this.link({ kind: moved, index: target })];
    }
    if (actuator.limited[actuator.control[index]]) {
      yield ["control", `${neat(actuator.range[2 * index])} … ${neat(actuator.range[2 * index + 1])}`];
    }
  }

  /** The place of a line, as a link where an editor can open it; a `short` one has only the name of the file. */
  private place(place: Place | null, short = false): HTMLElement | null {
    if (!place) {
      return null;
    }
    const { files } = this.model.scene.origins;
    const { editor } = this.model.scene;
    const [file, line, column] = place;
    const whole = `${files[file]}:${line}`;
    const text = short ? whole.slice(whole.lastIndexOf("/") + 1) : whole;
    const path = editor?.files[files[file]];
    if (!path) {
      return h("code", { title: `copy ${whole}`, className: "place", onclick: () => copy(whole) }, text);
    }
    if (host) {
      return h(
        "a",
        {
          className: "place",
          href: "#",
          title: `open ${whole} in the editor`,
          onclick: (event: Event) => {
            event.preventDefault();
            host!.open(path, line, column);
          },
        },
        text,
      );
    }
    const href = editor!.template
      .replaceAll("{file}", path.split("/").map(encodeURIComponent).join("/"))
      .replaceAll("{line}", String(line))
      .replaceAll("{column}", String(column));
    return h("a", { className: "place", href, title: `open ${whole} in the editor` }, text);
  }

  private *origin([place, part, words, changes]: NonNullable<Origin>): Generator<HTMLElement> {
    yield h("h3", {}, "Where it comes from");
    yield h("p", {}, words && h("span", {}, `${words} `), this.place(place));
    if (part >= 0) {
      const [what, at] = this.model.scene.origins.parts[part];
      yield h("p", {}, h("span", {}, "part ", ...ticked(what), " "), this.place(at));
    }
    if (changes.length) {
      yield h("h3", {}, "What changed it");
      yield h("ul", { className: "changes" }, ...changes.map((each) => this.change(each)));
    }
  }

  private change([what, before, after, words, place]: Change): HTMLElement {
    const shown = what ? h("span", {}, h("b", {}, what), ` ${before ?? "unset"} → ${after ?? "unset"} `) : null;
    return h("li", {}, shown, h("span", { className: "why" }, ...ticked(words), " "), this.place(place));
  }
}

/** Words with names between backticks. */
export const ticked = (text: string): Node[] =>
  text.split("`").map((each, k) => (k % 2 ? h("code", {}, each) : document.createTextNode(each)));

export const WHATS = ["added", "removed", "changed", "moved"] as const;
export type What = (typeof WHATS)[number];
const COLORS: Record<What, number> = { added: 0x2fbf5b, removed: 0xe5484d, changed: 0xf5a524, moved: 0x8b5cf6 };

/** The differences of the elements of one of the two models. */
export class Contrast {
  private readonly names: Record<What, Set<string>>;
  private readonly scene: Scene;

  constructor(
    private readonly model: Model,
    private readonly difference: Difference,
    readonly at: number,
  ) {
    this.scene = model.scene;
    const names = at ? difference.after : difference.before;
    this.names = Object.fromEntries(WHATS.map((what) => [what, new Set(names[what] ?? [])])) as unknown as Record<
      What,
      Set<string>
    >;
  }

  /**
   * The change of an element, by itself, by its parts or by the body that holds it; null if it is as in the other
   * model.
   */
  of({ kind, index }: Element): What | null {
    const columns = (this.scene as any)[kind];
    const above = [`${kind} ${index}`];
    const made = [`${kind} ${index}`];
    const body = kind === "body" ? this.scene.body.parent[index] : (columns?.body?.[index] ?? 0);
    for (let b = body; b > 0; b = this.scene.body.parent[b]) {
      above.push(`body ${b}`);
    }
    if (kind === "geom") {
      made.push(
        `material ${columns.material[index]}`,
        `mesh ${columns.data[index]}`,
        `hfield ${columns.data[index]}`,
        `body ${body}`,
      );
      this.scene.joint.body.forEach((b: number, j: number) => {
        if (b === body) {
          made.push(`joint ${j}`);
        }
      });
    }
    const has = (what: What, names: string[]) => names.some((name) => this.names[what].has(name));
    return (
      (["added", "removed", "moved"] as const).find((what) => has(what, above)) ??
      (has("changed", made) ? "changed" : null)
    );
  }

  readonly color = (kind: string, index: number): Color | null => {
    const what = this.of({ kind, index });
    return what && new Color(COLORS[what]);
  };

  /** The text of the comparison, below what each color means. */
  panel(choose: (element: Element) => void): HTMLElement {
    const legend = WHATS.filter((what) => this.names[what].size).map((what) => {
      const rows = [...this.names[what]].flatMap((each) => this.link(each, choose));
      return h(
        "details",
        {},
        h(
          "summary",
          {},
          h("i", { className: `dot ${what}` }),
          what,
          h("span", { className: "more" }, String(rows.length)),
        ),
        ...rows,
      );
    });
    const lines = this.difference.text.split("\n").map((line) =>
      h(
        "span",
        {
          className:
            /^ *(\+|−|-) /
              .exec(line)?.[1]
              .replace("+", "plus")
              .replace(/^[−-]$/, "minus") ?? "",
        },
        `${line}\n`,
      ),
    );
    return h("div", { className: "difference" }, ...legend, h("pre", {}, ...lines));
  }

  private link(element: string, choose: (element: Element) => void): HTMLElement[] {
    const [kind, number] = element.split(" ");
    const index = Number(number);
    const columns = (this.scene as any)[kind];
    if (!columns?.name || kind === "material") {
      return [];
    }
    return [
      h(
        "a",
        {
          href: "#",
          onclick: (event: Event) => {
            event.preventDefault();
            choose({ kind, index });
          },
        },
        `${kind} ${nameOf(this.model, { kind, index })}`,
      ),
    ];
  }
}
