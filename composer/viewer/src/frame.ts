// The parts of the page around the picture: the bar, the tree, the tabs, and the tip over the picture.
import { h, icon } from "./dom";

export const TABS = ["Changes", "Info", "Params", "Joints", "Controls", "Sensors", "Show", "Attach"] as const;
export type Tab = (typeof TABS)[number];

/** A button of the bar. */
export function tool(name: string, title: string, act: () => void, className = "tool"): HTMLButtonElement {
  return h("button", { className, title, ariaLabel: title, onclick: act }, icon(name));
}

/** The tabs on the right, each with its panel. */
export class Panels {
  readonly root: HTMLElement;
  readonly of: Record<Tab, HTMLElement>;
  private readonly tabs: Record<Tab, HTMLElement>;

  constructor(private readonly opened: (tab: Tab) => void) {
    const all = <T>(make: (tab: Tab) => T) => Object.fromEntries(TABS.map((tab) => [tab, make(tab)])) as Record<Tab, T>;
    this.of = all(() => h("div", { className: "scroll", hidden: true }));
    this.tabs = all((tab) =>
      h(
        "button",
        { role: "tab", onclick: () => this.open(tab), onkeydown: (event: KeyboardEvent) => this.next(event) },
        tab,
      ),
    );
    this.root = h(
      "aside",
      { className: "right" },
      h("div", { className: "tabs", role: "tablist" }, ...TABS.map((tab) => this.tabs[tab])),
      ...TABS.map((tab) => this.of[tab]),
    );
  }

  open(tab: Tab): void {
    for (const name of TABS) {
      this.of[name].hidden = name !== tab;
      this.tabs[name].ariaSelected = String(name === tab);
      this.tabs[name].tabIndex = name === tab ? 0 : -1;
    }
    this.opened(tab);
  }

  /** Only two models that are compared have changes, and nothing is attached to them. */
  setCompared(isCompared: boolean): void {
    this.tabs.Changes.hidden = !isCompared;
    this.tabs.Attach.hidden = isCompared;
  }

  setParams(hasParams: boolean): void {
    this.tabs.Params.hidden = !hasParams;
    if (!hasParams && !this.of.Params.hidden) {
      this.open("Info");
    }
  }

  /** The arrows go from tab to tab. */
  private next(event: KeyboardEvent): void {
    const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key] ?? 0;
    const shown = TABS.filter((tab) => !this.tabs[tab].hidden);
    if (!way) {
      return;
    }
    const next = shown[(shown.findIndex((tab) => this.tabs[tab] === event.target) + way + shown.length) % shown.length];
    this.open(next);
    this.tabs[next].focus();
  }
}

/** The contents of the bar and of the picture, and the actions of the frame. */
interface Contents {
  menus: Node[];
  tools: Node[];
  over: Node[];
  camera: (index: number) => void;
  move: () => void;
  search: (text: string) => void;
  opened: (tab: Tab) => void;
}

export class Frame {
  readonly canvas = h("canvas", { tabIndex: 0, ariaLabel: "the model" });
  readonly title = h("h1", {});
  readonly choices = h("span", { className: "choices" });
  readonly searchBox: HTMLInputElement;
  readonly tree = h("div", { className: "scroll" });
  readonly panels: Panels;
  readonly tip = h("div", { className: "tip", hidden: true });
  readonly status = h("div", { className: "status" });
  readonly view: HTMLElement;
  readonly cameras: HTMLSelectElement;
  readonly moveButton: HTMLButtonElement;

  constructor(root: HTMLElement, { menus, tools, over, camera, move, search, opened }: Contents) {
    this.cameras = h("select", {
      ariaLabel: "camera",
      title: "camera",
      onchange: () => camera(Number(this.cameras.value)),
    });
    this.moveButton = tool("move", "move (M)", move);
    this.searchBox = h("input", {
      type: "search",
      placeholder: "Search names  /",
      ariaLabel: "search names",
      oninput: () => search(this.searchBox.value.trim()),
    });
    this.panels = new Panels(opened);
    this.view = h("main", {}, this.canvas, ...over, this.tip);
    const drawer = (side: string) => {
      root.classList.toggle(`show-${side}`);
      root.classList.remove(side === "left" ? "show-right" : "show-left");
    };
    root.append(
      h(
        "header",
        { className: "bar" },
        tool("tree", "the composition", () => drawer("left"), "tool narrow"),
        this.title,
        this.choices,
        h("span", { className: "gap" }),
        ...menus,
        this.cameras,
        this.moveButton,
        ...tools,
        tool("panel", "joints and more", () => drawer("right"), "tool narrow"),
      ),
      h("aside", { className: "left" }, this.searchBox, this.tree),
      this.view,
      this.panels.root,
    );
  }
}
