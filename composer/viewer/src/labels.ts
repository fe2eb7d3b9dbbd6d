// Names in the picture, pushed apart, each with a line to its thing; nothing of the model hides them. `render --labels`
// does the same: `composer/mjcompose/mujoco/labels.py`.
import { Vector3 } from "three";
import { h } from "./dom";
import type { Stage } from "./stage";
import { nameOf } from "./tree";
import type { World } from "./world";

export const NAMED = ["body", "joint", "site", "contact"] as const;
export type Named = (typeof NAMED)[number];

const COLORS: Record<Named, string> = { body: "#3b82f6", joint: "#e8872b", site: "#29a85a", contact: "#ff3b6b" };
const FONT = "11px system-ui, sans-serif";
const HIGH = 15;
const WAYS = 16;
const RINGS = 24;
const GAP = 2;

export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

interface Label {
  kind: Named;
  name: string;
  x: number;
  y: number;
  width: number;
}

function common(a: Box, b: Box): number {
  const width = Math.min(a.right, b.right) - Math.max(a.left, b.left) + GAP;
  const height = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) + GAP;
  return width > 0 && height > 0 ? width * height : 0;
}

/** A box near a point, on larger and larger rings. */
function around({ x, y, width }: Label, place: number, room: { width: number; height: number }): Box {
  const ring = Math.floor(place / WAYS);
  const angle = (2 * Math.PI * (place % WAYS)) / WAYS - Math.PI / 2;
  const middle = x + Math.cos(angle) * (width / 2 + HIGH * (0.5 + ring));
  const level = y + Math.sin(angle) * HIGH * (1.2 + ring);
  const left = Math.min(Math.max(middle - width / 2, 0), Math.max(0, room.width - width));
  const top = Math.min(Math.max(level - HIGH / 2, 0), Math.max(0, room.height - HIGH));
  return { left, top, right: left + width, bottom: top + HIGH };
}

export class Labels {
  readonly canvas = h("canvas", { className: "labels" });
  readonly shown = new Set<Named>();
  /** The boxes that were drawn last, by kind and name. */
  boxes = new Map<string, Box>();
  /** The last place of each label around its point: labels stay there while the view turns. */
  private readonly places = new Map<string, number>();
  private readonly widths = new Map<string, number>();

  constructor(private readonly stage: Stage) {}

  set(kind: Named, on: boolean): void {
    if (on) {
      this.shown.add(kind);
    } else {
      this.shown.delete(kind);
    }
    this.places.clear();
  }

  update(): void {
    const { world, canvas: picture } = this.stage;
    const { canvas } = this;
    canvas.hidden = !this.shown.size || !world;
    if (canvas.hidden || !world) {
      return;
    }
    if (!canvas.isConnected) {
      picture.after(canvas);
    }
    const width = picture.clientWidth;
    const height = picture.clientHeight;
    const ratio = Math.min(devicePixelRatio, 2);
    if (canvas.width !== width * ratio || canvas.height !== height * ratio) {
      canvas.width = width * ratio;
      canvas.height = height * ratio;
    }
    const pen = canvas.getContext("2d")!;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = FONT;
    pen.textBaseline = "middle";
    this.draw(pen, this.labels(world, pen, width, height), { width, height });
  }

  private labels(world: World, pen: CanvasRenderingContext2D, width: number, height: number): Label[] {
    const { camera } = this.stage;
    const labels: Label[] = [];
    for (const kind of NAMED.filter((each) => this.shown.has(each))) {
      for (const [name, point] of pointsOf(world, kind)) {
        const { x, y, z } = point.project(camera);
        if (Math.abs(x) <= 1 && Math.abs(y) <= 1 && Math.abs(z) < 1) {
          const wide = this.widths.get(name) ?? pen.measureText(name).width + 10;
          this.widths.set(name, wide);
          labels.push({ kind, name, x: ((x + 1) / 2) * width, y: ((1 - y) / 2) * height, width: wide });
        }
      }
    }
    return labels;
  }

  private draw(pen: CanvasRenderingContext2D, labels: Label[], room: { width: number; height: number }): void {
    this.boxes = new Map();
    const style = getComputedStyle(document.documentElement);
    for (const label of labels) {
      this.boxes.set(`${label.kind} ${label.name}`, this.free(label, room));
    }
    for (const { kind, name, x, y } of labels) {
      const box = this.boxes.get(`${kind} ${name}`)!;
      pen.strokeStyle = pen.fillStyle = COLORS[kind];
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(Math.min(Math.max(x, box.left), box.right), Math.min(Math.max(y, box.top), box.bottom));
      pen.stroke();
      pen.fillRect(x - 1.5, y - 1.5, 3, 3);
    }
    for (const { kind, name } of labels) {
      const box = this.boxes.get(`${kind} ${name}`)!;
      pen.fillStyle = style.getPropertyValue("--paper");
      pen.globalAlpha = 0.88;
      pen.fillRect(box.left, box.top, box.right - box.left, HIGH);
      pen.globalAlpha = 1;
      pen.fillStyle = COLORS[kind];
      pen.fillRect(box.left, box.top, 2, HIGH);
      pen.fillStyle = style.getPropertyValue("--ink");
      pen.fillText(name, box.left + 6, box.top + HIGH / 2 + 0.5);
    }
  }

  /** The first box near the point that covers no other box, or else the box that covers the least. */
  private free(label: Label, room: { width: number; height: number }): Box {
    const key = `${label.kind} ${label.name}`;
    const taken = [...this.boxes.values()];
    const before = this.places.get(key);
    const order = before === undefined ? [] : [before];
    let least = Infinity;
    let best = around(label, 0, room);
    for (let place = 0; place < WAYS * RINGS + order.length; place++) {
      const number = place < order.length ? order[place] : place - order.length;
      const box = around(label, number, room);
      let covered = 0;
      for (const other of taken) {
        covered += common(box, other);
        if (covered >= least) {
          break;
        }
      }
      if (covered < least) {
        least = covered;
        best = box;
        this.places.set(key, number);
      }
      if (!covered) {
        break;
      }
    }
    return best;
  }
}

/** The things of a kind that have a name, and where they are. */
function* pointsOf(world: World, kind: Named): Generator<[string, Vector3]> {
  const { model, pose } = world;
  const { scene } = model;
  if (kind === "contact") {
    yield* contactsOf(world);
    return;
  }
  for (const [index, name] of scene[kind].name.entries()) {
    if (!name || (kind === "body" && index === 0)) {
      continue;
    }
    if (kind === "joint") {
      yield [name, new Vector3().fromArray(pose.anchor, 3 * index)];
    } else if (kind === "site") {
      yield [name, new Vector3().setFromMatrixPosition(world.matrixOf("site", index))];
    } else {
      yield [name, new Vector3().fromArray(scene.body.ipos, 3 * index).applyMatrix4(world.bodyMatrix(index))];
    }
  }
}

/** One name for all contacts of two geoms, in their middle. */
function* contactsOf({ model, softs }: World): Generator<[string, Vector3]> {
  const pairs = new Map<string, Vector3[]>();
  for (const [one, two, ...at] of softs.seen?.contacts ?? []) {
    const called = [one, two].map((index) => (index < 0 ? "flex" : nameOf(model, { kind: "geom", index })));
    const key = called.join(" – ");
    pairs.set(key, [...(pairs.get(key) ?? []), new Vector3(at[0], at[1], at[2])]);
  }
  for (const [name, points] of pairs) {
    const middle = points.reduce((sum, each) => sum.add(each), new Vector3()).divideScalar(points.length);
    yield [points.length > 1 ? `${name} (${points.length})` : name, middle];
  }
}
