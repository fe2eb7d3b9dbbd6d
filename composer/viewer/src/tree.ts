// The composition as a tree: parts, their bodies, and the elements of the bodies; and the places to which a part can be
// attached.
import type { Element, Model } from "./data";
import { copy, h, icon, nameSpan } from "./dom";
import { MESH, SDF, SHAPE_NAMES } from "./shapes";

const LEAVES = ["joint", "geom", "site", "camera", "light"] as const;
const SOFT = ["skin", "flex"] as const;
const MARKS: Record<string, string> = {
  body: "◆",
  joint: "↻",
  geom: "■",
  site: "◎",
  camera: "▣",
  light: "✷",
  part: "▸",
  tendon: "∿",
  skin: "▒",
  flex: "▒",
  actuator: "⚙",
  key: "⚑",
  exclude: "⊘",
};

export class Tree {
  readonly root = h("div", { className: "tree", role: "tree", onkeydown: (event: KeyboardEvent) => this.step(event) });
  private readonly rows = new Map<string, HTMLElement>();
  private readonly children: number[][];
  private readonly on = new Map<number, Element[]>();
  private readonly partOf: number[];
  private selected: HTMLElement | null = null;

  constructor(
    private readonly model: Model,
    private readonly choose: (element: Element, more: boolean) => void,
    private readonly hover: (element: Element | null) => void,
    private readonly mark: (element: Element) => string = () => "",
  ) {
    const { scene } = model;
    this.children = scene.body.name.map(() => []);
    scene.body.parent.forEach((parent: number, b: number) => {
      if (b > 0) {
        this.children[parent].push(b);
      }
    });
    const hang = (b: number, element: Element) => {
      if (!this.on.has(b)) {
        this.on.set(b, []);
      }
      this.on.get(b)!.push(element);
    };
    for (const kind of LEAVES) {
      scene[kind].body.forEach((b: number, index: number) => hang(b, { kind, index }));
    }
    for (const kind of SOFT) {
      scene[kind].forEach((each, index) => hang(each.body, { kind, index }));
    }
    const origins = scene.origins.of.body ?? [];
    this.partOf = [-1];
    // A body that MuJoCo made, such as one for a corner of a cloth, belongs to the part of its parent.
    for (let b = 1; b < scene.body.name.length; b++) {
      this.partOf[b] = origins[b]?.[1] ?? this.partOf[scene.body.parent[b]];
    }
    this.fill();
  }

  private fill(): void {
    const { scene } = this.model;
    const roots = new Map<number, number[]>();
    scene.body.name.forEach((_, b) => {
      if (b > 0 && (scene.body.parent[b] === 0 || this.partOf[b] !== this.partOf[scene.body.parent[b]])) {
        const part = this.partOf[b];
        if (!roots.has(part)) {
          roots.set(part, []);
        }
        roots.get(part)!.push(b);
      }
    });
    const world = this.on.get(0) ?? [];
    this.root.append(
      this.fold(
        "body",
        "world",
        { kind: "body", index: 0 },
        world.length,
        () => world.map((each) => this.leaf(each)),
        false,
      ),
    );
    const own = roots.get(-1)?.map((b) => this.body(b)) ?? [];
    const parts = this.partsIn(-1, roots);
    this.root.append(
      ...(parts.length && own.length ? [this.fold("part", "base", null, own.length, () => own, true)] : own),
    );
    this.root.append(...parts);
    for (const kind of ["tendon", "actuator"] as const) {
      const count = scene[kind].name.length;
      if (count) {
        this.root.append(
          this.fold(
            kind,
            `${kind}s`,
            null,
            count,
            () => Array.from({ length: count }, (_, index) => this.leaf({ kind, index })),
            false,
          ),
        );
      }
    }
    const pairs = scene.exclude.body1.length;
    if (pairs) {
      this.root.append(this.fold("exclude", "excluded contacts", null, pairs, () => this.excludes(), false));
    }
  }

  /** The parts that are in a part, or in none, with their bodies: `roots` has the topmost ones of each. */
  private partsIn(outer: number, roots: Map<number, number[]>): HTMLElement[] {
    const { parts } = this.model.scene.origins;
    return parts.flatMap(([called, , around], part) => {
      if (around !== outer) {
        return [];
      }
      const bodies = roots.get(part) ?? [];
      const inner = this.partsIn(part, roots);
      if (!bodies.length && !inner.length) {
        return [];
      }
      const words = called.replaceAll("`", "");
      const name = words.split(" ")[0];
      const rows = () => [...bodies.map((b) => this.body(b)), ...inner];
      return [this.fold("part", name, null, bodies.length + inner.length, rows, true, words.slice(name.length))];
    });
  }

  /** The pairs of bodies that do not touch, each with the reason, if it has one. */
  private excludes(): HTMLElement[] {
    const {
      exclude: { body1, body2 },
      origins,
    } = this.model.scene;
    return body1.map((one, k) => {
      const [first, second] = [one, body2[k]].map((index) => nameOf(this.model, { kind: "body", index }));
      const [, words, why] = origins.exclude[k];
      const line = this.line("exclude", `${first} – ${second}`, null, null, why ?? words);
      line.title += ` ${why ?? words}`;
      line.addEventListener("click", (event) => this.choose({ kind: "body", index: one }, event.shiftKey));
      line.addEventListener("keydown", (event) => {
        if (event.key === "Enter") {
          line.click();
        }
      });
      return line;
    });
  }

  private body(b: number): HTMLElement {
    const inside = this.on.get(b) ?? [];
    const below = this.children[b].filter((each) => this.partOf[each] === this.partOf[b]);
    const rows = () => [...inside.map((each) => this.leaf(each)), ...below.map((each) => this.body(each))];
    return this.fold(
      "body",
      nameOf(this.model, { kind: "body", index: b }),
      { kind: "body", index: b },
      inside.length + below.length,
      rows,
      false,
    );
  }

  private fold(
    kind: string,
    name: string,
    element: Element | null,
    count: number,
    rows: () => HTMLElement[],
    open: boolean,
    more = "",
  ): HTMLElement {
    const list = h("div", { className: "below", role: "group" });
    const toggle = h(
      "button",
      {
        className: "toggle",
        tabIndex: -1,
        ariaLabel: "fold",
        onclick: (event: Event) => {
          event.stopPropagation();
          flip();
        },
      },
      count ? "›" : "",
    );
    const line = this.line(kind, name, element, toggle, more);
    const whole = h("div", { className: "fold", role: "treeitem", ariaExpanded: "false" }, line, list);
    const flip = (to = !whole.classList.contains("open")) => {
      if (to && !list.hasChildNodes()) {
        list.append(...rows());
      }
      whole.classList.toggle("open", to);
      whole.ariaExpanded = String(to);
    };
    (whole as any).flip = flip;
    line.addEventListener("keydown", (event) => {
      if (event.key === "ArrowRight" || event.key === "ArrowLeft" || (!element && event.key === "Enter")) {
        flip(event.key === "Enter" ? undefined : event.key === "ArrowRight");
      }
    });
    if (!element) {
      line.addEventListener("click", () => flip());
    } else {
      line.addEventListener("dblclick", () => flip());
    }
    if (open) {
      flip(true);
    }
    return whole;
  }

  private leaf(element: Element): HTMLElement {
    return this.line(element.kind, nameOf(this.model, element), element, null);
  }

  private line(
    kind: string,
    name: string,
    element: Element | null,
    toggle: HTMLElement | null,
    more = "",
  ): HTMLElement {
    const line = h(
      "div",
      { className: `row ${kind} ${element ? this.mark(element) : ""}`, tabIndex: 0, title: `${kind} ${name}` },
      toggle ?? h("span", { className: "toggle" }),
      h("span", { className: "mark" }, MARKS[kind]),
      nameSpan(name),
      more && h("span", { className: "more" }, more),
    );
    if (element) {
      this.rows.set(`${element.kind} ${element.index}`, line);
      line.addEventListener("click", (event) => this.choose(element, event.shiftKey));
      line.addEventListener("keydown", (event) => {
        if (event.key === "Enter") {
          this.choose(element, event.shiftKey);
        }
      });
      line.addEventListener("focus", () => this.hover(element));
      line.addEventListener("pointerenter", () => this.hover(element));
      line.addEventListener("pointerleave", () => this.hover(null));
    }
    return line;
  }

  /** Open the tree as far as an element, and mark it. */
  select(element: Element | null): void {
    this.selected?.classList.remove("selected");
    this.selected = null;
    if (!element) {
      return;
    }
    const { scene } = this.model;
    const list: number[] = [];
    let b = element.kind === "body" ? scene.body.parent[element.index] : bodyOf(this.model, element);
    if (element.kind === "body" && element.index === 0) {
      b = -1;
    }
    for (; b > 0; b = scene.body.parent[b]) {
      list.unshift(b);
    }
    if (b === 0 && element.kind !== "body" && !list.length) {
      list.unshift(0);
    }
    for (const item of list) {
      (this.rows.get(`body ${item}`)?.parentElement as any)?.flip?.(true);
    }
    const line = this.rows.get(`${element.kind} ${element.index}`);
    if (!line) {
      return;
    }
    line.classList.add("selected");
    line.scrollIntoView({ block: "nearest" });
    this.selected = line;
  }

  /** The arrows go from row to row. */
  private step(event: KeyboardEvent): void {
    const way = { ArrowDown: 1, ArrowUp: -1 }[event.key] ?? 0;
    const rows = [...this.root.querySelectorAll<HTMLElement>(".row")].filter((row) => row.offsetParent);
    const next = rows[rows.indexOf(event.target as HTMLElement) + way];
    if (!way || !next) {
      return;
    }
    event.preventDefault();
    next.focus();
  }

  /** Show only items with a text in their names. */
  search(text: string): HTMLElement[] {
    const lines: HTMLElement[] = [];
    const query = text.toLowerCase();
    for (const kind of ["body", ...LEAVES, ...SOFT, "tendon", "actuator"] as const) {
      const columns = this.model.scene[kind];
      const count = Array.isArray(columns) ? columns.length : columns.name.length;
      Array.from({ length: count }, (_, index) => nameOf(this.model, { kind, index })).forEach((name, index) => {
        if (lines.length < 200 && name.toLowerCase().includes(query)) {
          const line = this.line(kind, name, null, null);
          line.addEventListener("click", (event) => this.choose({ kind, index }, event.shiftKey));
          lines.push(line);
        }
      });
    }
    return lines;
  }
}

/** The body that an element is on, or -1. */
export function bodyOf({ scene }: Model, { kind, index }: Element): number {
  const columns = (scene as any)[kind];
  return (Array.isArray(columns) ? columns[index].body : columns?.body?.[index]) ?? -1;
}

/** An element's name; a geom without one is called by its mesh or type, anything else by its kind and number. */
export function nameOf(model: Model, { kind, index }: Element): string {
  const columns = (model.scene as any)[kind];
  const name = Array.isArray(columns) ? columns[index].name : columns.name[index];
  if (name || kind !== "geom") {
    return name || (kind === "body" && index === 0 ? "world" : `${kind}#${index}`);
  }
  const { type, data } = model.scene.geom;
  const mesh = type[index] === MESH || type[index] === SDF ? model.scene.meshes?.[data[index]] : null;
  return mesh ? `mesh ${mesh}` : (SHAPE_NAMES[type[index]] ?? "geom");
}

/** The element of a kind with a name, or -1. */
export function numberOf({ scene }: Model, kind: string, name: string): number {
  const columns = (scene as any)[kind];
  return Array.isArray(columns) ? columns.findIndex((each) => each.name === name) : (columns.name?.indexOf(name) ?? -1);
}

export function places(
  model: Model,
  choose: (element: Element) => void,
  hover: (element: Element | null) => void,
): HTMLElement {
  const { scene } = model;
  const entry = (kind: "site" | "body", index: number, name: string): HTMLElement => {
    const text = `attach:\n  tool:\n    model: ./tool.xml\n    ${kind}: ${name}\n`;
    return h(
      "div",
      {
        className: "place-row",
        tabIndex: 0,
        onkeydown: (event: KeyboardEvent) => {
          if (event.key === "Enter" && event.target === event.currentTarget) {
            choose({ kind, index });
          }
        },
        onclick: () => choose({ kind, index }),
        onpointerenter: () => hover({ kind, index }),
        onpointerleave: () => hover(null),
      },
      nameSpan(name),
      h(
        "button",
        {
          className: "small",
          title: "copy the name",
          onclick: (event: Event) => {
            event.stopPropagation();
            void copy(name);
          },
        },
        icon("copy"),
      ),
      h(
        "button",
        {
          className: "small wide",
          title: "copy an entry of `attach`",
          onclick: (event: Event) => {
            event.stopPropagation();
            void copy(text);
          },
        },
        "attach:",
      ),
    );
  };
  const named = (kind: "site" | "body"): HTMLElement[] =>
    scene[kind].name.flatMap((name, index) =>
      name && !(kind === "body" && index === 0) ? [entry(kind, index, name)] : [],
    );
  const sites = named("site");
  const bodies = named("body");
  return h(
    "div",
    { className: "places" },
    h(
      "p",
      { className: "hint" },
      "Attach a part by the name of a site or a body. Without one, the part is in the world.",
    ),
    h("h3", {}, `Sites (${sites.length})`),
    ...sites,
    h("h3", {}, `Bodies (${bodies.length})`),
    ...bodies,
  );
}
