// The distance between two points of the picture, which stay on their bodies.
import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, SphereGeometry, Vector3 } from "three";
import { h } from "./dom";
import { neat } from "./info";
import type { Stage } from "./stage";
import { bodyOf } from "./tree";

export class Ruler {
  readonly label = h("div", { className: "measure", hidden: true });
  isOn = false;
  private points: { body: number; at: Vector3 }[] = [];
  private readonly group = new Group();
  private readonly line: Line;
  private readonly balls: Mesh[];

  constructor(private readonly stage: Stage, private readonly say: (words: string) => void, private readonly changed: () => void) {
    const paint = { color: 0xf59e0b, depthTest: false, transparent: true };
    this.line = new Line(new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(6), 3)), new LineBasicMaterial(paint));
    this.balls = [0, 1].map(() => new Mesh(new SphereGeometry(1, 16, 10), new MeshBasicMaterial(paint)));
    this.line.frustumCulled = false;
    for (const each of [this.line, ...this.balls]) { each.renderOrder = 6; this.group.add(each); }
    stage.scene.add(this.group);
    this.update();
  }

  flip(on = !this.isOn): void {
    this.isOn = on;
    this.points = [];
    if (on) this.say("Click two points to measure between them");
    this.changed();
    this.stage.draw();
  }

  /** A click in the picture; the third click starts again. */
  click(x: number, y: number): void {
    const hit = this.stage.hit(x, y), { world } = this.stage;
    if (!hit || !world) return;
    if (this.points.length === 2) this.points = [];
    const body = Math.max(0, hit.element.kind === "body" ? hit.element.index : bodyOf(world.model, hit.element));
    this.points.push({ body, at: hit.point.clone().applyMatrix4(world.bodyMatrix(body).clone().invert()) });
    this.stage.draw();
  }

  /** The points are of bodies that another model may not have. */
  clear(): void {
    this.points = [];
  }

  update(): void {
    const { world, camera, canvas } = this.stage, isShown = this.isOn && this.points.length > 0 && world !== null;
    this.group.visible = isShown;
    this.label.hidden = !isShown || this.points.length < 2;
    if (!isShown) return;
    const ends = this.points.map(({ body, at }) => at.clone().applyMatrix4(world.bodyMatrix(body)));
    this.balls.forEach((ball, k) => {
      ball.visible = k < ends.length;
      if (k >= ends.length) return;
      ball.position.copy(ends[k]);
      ball.scale.setScalar(0.006 * ends[k].distanceTo(camera.position));
    });
    this.line.visible = ends.length === 2;
    if (ends.length < 2) return;
    const [a, b] = ends, list = this.line.geometry.getAttribute("position");
    list.setXYZ(0, a.x, a.y, a.z);
    list.setXYZ(1, b.x, b.y, b.z);
    list.needsUpdate = true;
    const way = b.clone().sub(a), middle = a.clone().add(b).multiplyScalar(0.5).project(camera);
    this.label.replaceChildren(h("b", {}, `${neat(way.length(), 4)} m`), h("span", {}, `Δ ${way.toArray().map((each) => neat(Number(each.toFixed(4)))).join("  ")}`));
    this.label.style.left = `${(middle.x + 1) / 2 * canvas.clientWidth}px`;
    this.label.style.top = `${(1 - middle.y) / 2 * canvas.clientHeight}px`;
  }
}
