// The places to which a part can be attached, with the text for a recipe.
import type { Element, Model } from "./data";
import { copy, h, icon } from "./dom";

export function places(model: Model, choose: (element: Element) => void, hover: (element: Element | null) => void): HTMLElement {
  const { scene } = model;
  const entry = (kind: "site" | "body", index: number, name: string): HTMLElement => {
    const text = `attach:\n  tool:\n    model: ./tool.xml\n    ${kind}: ${name}\n`;
    return h("div", { className: "place-row", tabIndex: 0, onkeydown: (event: KeyboardEvent) => { if (event.key === "Enter" && event.target === event.currentTarget) choose({ kind, index }); }, onclick: () => choose({ kind, index }), onpointerenter: () => hover({ kind, index }), onpointerleave: () => hover(null) },
      h("span", { className: "name" }, name),
      h("button", { className: "small", title: "copy the name", onclick: (event: Event) => { event.stopPropagation(); void copy(name); } }, icon("copy")),
      h("button", { className: "small wide", title: "copy an entry of `attach`", onclick: (event: Event) => { event.stopPropagation(); void copy(text); } }, "attach:"));
  };
  const named = (kind: "site" | "body"): HTMLElement[] =>
    scene[kind].name.flatMap((name, index) => (name && !(kind === "body" && index === 0) ? [entry(kind, index, name)] : []));
  const sites = named("site"), bodies = named("body");
  return h("div", { className: "places" },
    h("p", { className: "hint" }, "Attach a part by the name of a site or a body. Without one, the part is in the world."),
    h("h3", {}, `Sites (${sites.length})`), ...sites,
    h("h3", {}, `Bodies (${bodies.length})`), ...bodies);
}
