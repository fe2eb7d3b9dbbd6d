// Two models in one page: what differs, in color and in words.
import { Color } from "three";
import type { Element, Difference, Model, Scene } from "./data";
import { h } from "./dom";
import { nameOf } from "./tree";

export const WHATS = ["added", "removed", "changed", "moved"] as const;
export type What = (typeof WHATS)[number];
const COLORS: Record<What, number> = { added: 0x2fbf5b, removed: 0xe5484d, changed: 0xf5a524, moved: 0x8b5cf6 };

/** The differences of the elements of one of the two models. */
export class Contrast {
  private readonly names: Record<What, Set<string>>;
  private readonly scene: Scene;

  constructor(private readonly model: Model, private readonly difference: Difference, readonly at: number) {
    this.scene = model.scene;
    const names = at ? difference.after : difference.before;
    this.names = Object.fromEntries(WHATS.map((what) => [what, new Set(names[what] ?? [])])) as unknown as Record<What, Set<string>>;
  }

  /** The change of an element, by itself, by its parts or by the body that holds it; null if it is as in the other model. */
  of({ kind, index }: Element): What | null {
    const columns = (this.scene as any)[kind], above = [`${kind} ${index}`], made = [`${kind} ${index}`];
    const body = kind === "body" ? this.scene.body.parent[index] : columns?.body?.[index] ?? 0;
    for (let b = body; b > 0; b = this.scene.body.parent[b]) above.push(`body ${b}`);
    if (kind === "geom") {
      made.push(`material ${columns.material[index]}`, `mesh ${columns.data[index]}`, `hfield ${columns.data[index]}`, `body ${body}`);
      this.scene.joint.body.forEach((b: number, j: number) => { if (b === body) made.push(`joint ${j}`); });
    }
    const has = (what: What, names: string[]) => names.some((name) => this.names[what].has(name));
    return (["added", "removed", "moved"] as const).find((what) => has(what, above)) ?? (has("changed", made) ? "changed" : null);
  }

  readonly color = (kind: string, index: number): Color | null => {
    const what = this.of({ kind, index });
    return what && new Color(COLORS[what]);
  };

  /** The text of the comparison, below what each color means. */
  panel(choose: (element: Element) => void): HTMLElement {
    const legend = WHATS.filter((what) => this.names[what].size).map((what) => {
      const rows = [...this.names[what]].flatMap((each) => this.link(each, choose));
      return h("details", {}, h("summary", {}, h("i", { className: `dot ${what}` }), what, h("span", { className: "more" }, String(rows.length))), ...rows);
    });
    const lines = this.difference.text.split("\n").map((line) => h("span", { className: /^ *(\+|−|-) /.exec(line)?.[1].replace("+", "plus").replace(/^[−-]$/, "minus") ?? "" }, `${line}\n`));
    return h("div", { className: "difference" }, ...legend, h("pre", {}, ...lines));
  }

  private link(element: string, choose: (element: Element) => void): HTMLElement[] {
    const [kind, index] = [element.split(" ")[0], Number(element.split(" ")[1])];
    const columns = (this.scene as any)[kind];
    if (!columns?.name || kind === "material") return [];
    return [h("a", { href: "#", onclick: (event: Event) => { event.preventDefault(); choose({ kind, index }); } }, `${kind} ${nameOf(this.model, { kind, index })}`)];
  }
}
