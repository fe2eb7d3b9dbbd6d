// The axes of the world in a corner; a click looks along one.
import { Vector3, type Quaternion } from "three";
import type { Stage } from "./stage";

const AXES = [["X", [1, 0, 0], "#e5484d"], ["Y", [0, 1, 0], "#30a46c"], ["Z", [0, 0, 1], "#3b82f6"]] as const;
const SIZE = 76, REACH = 26, SPACE = "http://www.w3.org/2000/svg";

export class Compass {
  readonly root = document.createElementNS(SPACE, "svg");
  private readonly ends: { group: SVGGElement; line: SVGLineElement; way: Vector3 }[] = [];

  constructor(private readonly stage: Stage) {
    this.root.setAttribute("class", "compass");
    this.root.setAttribute("viewBox", `${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`);
    for (const [name, way, color] of AXES) for (const sign of [1, -1]) this.end(name, new Vector3(...way).multiplyScalar(sign), color, sign > 0);
  }

  private end(name: string, way: Vector3, color: string, positive: boolean): void {
    const make = <K extends keyof SVGElementTagNameMap>(tag: K, set: Record<string, string>): SVGElementTagNameMap[K] => {
      const made = document.createElementNS(SPACE, tag);
      for (const [key, value] of Object.entries(set)) made.setAttribute(key, value);
      return made;
    };
    const words = `look from ${positive ? "+" : "−"}${name}`, group = make("g", { role: "button", tabindex: "0", "aria-label": words });
    const line = make("line", { stroke: color, "stroke-width": positive ? "2" : "0" });
    const title = make("title", {});
    title.textContent = words;
    group.append(title, make("circle", { r: positive ? "8.5" : "5.5", fill: color, "fill-opacity": positive ? "1" : ".35", stroke: "none" }));
    if (positive) {
      const text = make("text", { "text-anchor": "middle", "dominant-baseline": "central", fill: "#fff", stroke: "none", "font-size": "10", "font-weight": "700" });
      text.textContent = name;
      group.append(text);
    }
    const look = () => this.stage.lookFrom(way);
    group.addEventListener("click", look);
    group.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); event.stopPropagation(); look(); } });
    this.root.append(line, group);
    this.ends.push({ group, line, way });
  }

  update(): void {
    const back = (this.stage.camera.quaternion.clone() as Quaternion).invert();
    const seen = this.ends.map((each) => ({ ...each, at: each.way.clone().applyQuaternion(back) }));
    for (const { group, line, at } of seen) {
      group.setAttribute("transform", `translate(${(at.x * REACH).toFixed(1)} ${(-at.y * REACH).toFixed(1)})`);
      line.setAttribute("x2", (at.x * REACH).toFixed(1));
      line.setAttribute("y2", (-at.y * REACH).toFixed(1));
    }
    // Only if the order changes: moving an element takes the focus away.
    const order = seen.sort((a, b) => a.at.z - b.at.z).map((each) => each.group), now = [...this.root.querySelectorAll("g")];
    if (order.some((each, k) => each !== now[k]) && !this.root.contains(document.activeElement)) this.root.append(...order);
  }
}
