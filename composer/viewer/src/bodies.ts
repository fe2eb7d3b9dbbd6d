// The look of bodies: hidden or alone, like glass, as wires, and colored by the part or the file that they come from.
import { Color } from "three";
import type { Element, Model } from "./data";
import { check, h } from "./dom";
import { bodyOf, nameOf, numberOf } from "./tree";
import type { World } from "./world";

export const COLORINGS = ["model", "part", "file"] as const;
export type Coloring = (typeof COLORINGS)[number];

const COLORING_WORDS: Record<Coloring, string> = {
  model: "colors of the model",
  part: "a color for each part",
  file: "a color for each source file",
};
/** Apart in hue and in lightness, even for people who confuse red and green. */
const PALETTE = [0x4477aa, 0xee6677, 0x228833, 0xccbb44, 0x66ccee, 0xaa3377, 0xee8866, 0x44bb99, 0x99ddff, 0xbbbbbb];
const NOWHERE = 0x777777;

interface HiddenThing {
  kind: "body" | "geom";
  name: string;
}

interface Owner {
  name: string;
  color: Color;
}

export class Bodies {
  readonly panel = h("div", {});
  /** The bodies and geoms that are hidden, by kind and name: another build of the model hides them again. */
  private hidden: HiddenThing[] = [];
  private isGlass = false;
  private isWire = false;
  private coloring: Coloring = "model";
  private world!: World;

  constructor(private readonly changed: () => void) {}

  use(world: World): void {
    this.world = world;
    this.apply();
  }

  /** Hide some elements; without any, show everything again. */
  hide(selected: Element[]): void {
    this.hidden = selected.length ? [...this.hidden, ...this.named(selected)] : [];
    this.apply();
  }

  /** Hide everything else; if something is hidden already, show everything again. */
  isolate(selected: Element[]): void {
    const { scene } = this.world.model;
    if (this.hidden.length || !selected.length) {
      this.hidden = [];
    } else {
      const kept = new Set(this.geoms(this.named(selected)));
      const others = scene.geom.body.flatMap((_: number, index: number) => (kept.has(index) ? [] : [index]));
      this.hidden = this.named(others.map((index: number) => ({ kind: "geom", index })));
    }
    this.apply();
  }

  /** The bodies and geoms of elements: a joint or a site stands for its body. */
  private named(elements: Element[]): HiddenThing[] {
    const { model } = this.world;
    return elements.flatMap((element): HiddenThing[] => {
      if (element.kind === "geom") {
        return [{ kind: "geom", name: keyOf(model, element.index) }];
      }
      const index = element.kind === "body" ? element.index : bodyOf(model, element);
      return index < 0 ? [] : [{ kind: "body", name: nameOf(model, { kind: "body", index }) }];
    });
  }

  private geoms(named: HiddenThing[]): number[] {
    if (!named.length) {
      return [];
    }
    const { model } = this.world;
    const { geom } = model.scene;
    const keys = new Map<string, number>(geom.body.map((_: number, index: number) => [keyOf(model, index), index]));
    return named.flatMap(({ kind, name }) => {
      if (kind === "geom") {
        const index = keys.get(name);
        return index === undefined ? [] : [index];
      }
      const body = name === "world" ? 0 : numberOf(model, "body", name);
      return geom.body.flatMap((on: number, index: number) => (on === body ? [index] : []));
    });
  }

  private apply(): void {
    const { world } = this;
    const geoms = this.geoms(this.hidden);
    world.setHidden(new Set(geoms));
    world.setStyle(this.isGlass, this.isWire);
    if (!world.model.scene.difference) {
      world.recolour((kind, index) => this.ownerOf(kind, index)?.color ?? null);
    }
    this.fill(geoms.length);
    this.changed();
  }

  /** The part or the file of an element, with its color. */
  private ownerOf(kind: string, index: number): Owner | null {
    const { origins } = this.world.model.scene;
    if (this.coloring === "model") {
      return null;
    }
    const origin = origins.of[kind]?.[index];
    const number = (this.coloring === "part" ? origin?.[1] : origin?.[0]?.[0]) ?? -1;
    if (number < 0) {
      return { name: this.coloring === "part" ? "no part" : "no file", color: new Color(NOWHERE) };
    }
    const name = this.coloring === "part" ? this.partName(number) : origins.files[number];
    return { name, color: new Color(PALETTE[number % PALETTE.length]) };
  }

  /** The prefixes of a part and of the parts around it. */
  private partName(part: number): string {
    const [words, , outer] = this.world.model.scene.origins.parts[part];
    const own = words.replaceAll("`", "").split(" ")[0];
    return outer < 0 ? own : this.partName(outer) + own;
  }

  private legend(): HTMLElement[] {
    const owners = new Map<string, string>();
    for (let index = 0; index < this.world.model.scene.geom.body.length; index++) {
      const owner = this.ownerOf("geom", index);
      if (owner) {
        owners.set(owner.name, `#${owner.color.getHexString()}`);
      }
    }
    return [...owners].map(([name, color]) =>
      h("div", { className: "owner" }, h("i", { className: "dot", style: `background:${color}` }), name),
    );
  }

  /** Show the settings, and the number of hidden geoms. */
  private fill(count: number): void {
    const select = h(
      "select",
      {
        ariaLabel: "colors",
        onchange: () => {
          this.coloring = select.value as Coloring;
          this.apply();
        },
      },
      ...COLORINGS.map((each) => h("option", { value: each, selected: each === this.coloring }, COLORING_WORDS[each])),
    );
    this.panel.replaceChildren(
      h("h3", {}, "Bodies"),
      check("transparent", this.isGlass, (on) => {
        this.isGlass = on;
        this.apply();
      }),
      check("wireframe", this.isWire, (on) => {
        this.isWire = on;
        this.apply();
      }),
      ...(this.world.model.scene.difference ? [] : [select, ...this.legend()]),
      ...(count
        ? [
            h(
              "p",
              { className: "hint" },
              `${count} geoms are hidden. `,
              h("button", { className: "small wide", onclick: () => this.hide([]) }, "Show all"),
            ),
          ]
        : []),
    );
  }
}

/** A name for any geom: its own, or its number on its body. */
function keyOf(model: Model, index: number): string {
  const { name, body } = model.scene.geom;
  if (name[index]) {
    return name[index];
  }
  const first = body.indexOf(body[index]);
  return `${nameOf(model, { kind: "body", index: body[index] })} #${index - first}`;
}
