// The actions of the mouse in the picture: measure a distance, and pull a body.
import {
  ArrowHelper,
  BufferAttribute,
  BufferGeometry,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshBasicMaterial,
  Plane,
  Raycaster,
  SphereGeometry,
  Vector3,
} from "three";
import type { Pull } from "./data";
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

  constructor(
    private readonly stage: Stage,
    private readonly say: (words: string) => void,
    private readonly changed: () => void,
  ) {
    const paint = { color: 0xf59e0b, depthTest: false, transparent: true };
    this.line = new Line(
      new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(6), 3)),
      new LineBasicMaterial(paint),
    );
    this.balls = [0, 1].map(() => new Mesh(new SphereGeometry(1, 16, 10), new MeshBasicMaterial(paint)));
    this.line.frustumCulled = false;
    for (const object of [this.line, ...this.balls]) {
      object.renderOrder = 6;
      this.group.add(object);
    }
    stage.scene.add(this.group);
    this.update();
  }

  flip(on = !this.isOn): void {
    this.isOn = on;
    this.points = [];
    if (on) {
      this.say("Click two points to measure between them");
    }
    this.changed();
    this.stage.draw();
  }

  /** A click in the picture; the third click starts again. */
  click(x: number, y: number): void {
    const hit = this.stage.hit(x, y);
    const { world } = this.stage;
    if (!hit || !world) {
      return;
    }
    if (this.points.length === 2) {
      this.points = [];
    }
    const body = Math.max(0, hit.element.kind === "body" ? hit.element.index : bodyOf(world.model, hit.element));
    this.points.push({ body, at: hit.point.clone().applyMatrix4(world.bodyMatrix(body).clone().invert()) });
    this.stage.draw();
  }

  /** The points are of bodies that another model may not have. */
  clear(): void {
    this.points = [];
  }

  update(): void {
    const { world, camera, canvas } = this.stage;
    const isShown = this.isOn && this.points.length > 0 && world !== null;
    this.group.visible = isShown;
    this.label.hidden = !isShown || this.points.length < 2;
    if (!isShown) {
      return;
    }
    const ends = this.points.map(({ body, at }) => at.clone().applyMatrix4(world.bodyMatrix(body)));
    this.balls.forEach((ball, k) => {
      ball.visible = k < ends.length;
      if (k >= ends.length) {
        return;
      }
      ball.position.copy(ends[k]);
      ball.scale.setScalar(0.006 * ends[k].distanceTo(camera.position));
    });
    this.line.visible = ends.length === 2;
    if (ends.length < 2) {
      return;
    }
    const [a, b] = ends;
    const list = this.line.geometry.getAttribute("position");
    list.setXYZ(0, a.x, a.y, a.z);
    list.setXYZ(1, b.x, b.y, b.z);
    list.needsUpdate = true;
    const way = b.clone().sub(a);
    const middle = a.clone().add(b).multiplyScalar(0.5).project(camera);
    this.label.replaceChildren(
      h("b", {}, `${neat(way.length(), 4)} m`),
      h(
        "span",
        {},
        `Δ ${way
          .toArray()
          .map((each) => neat(Number(each.toFixed(4))))
          .join("  ")}`,
      ),
    );
    this.label.style.left = `${((middle.x + 1) / 2) * canvas.clientWidth}px`;
    this.label.style.top = `${((1 - middle.y) / 2) * canvas.clientHeight}px`;
  }
}

export class Puller {
  private now: Pull | null = null;
  private readonly arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 1, 0xf43f5e);

  constructor(
    private readonly stage: Stage,
    private readonly isPlaying: () => boolean,
    private readonly pull: (pull: Pull | null) => void,
    private readonly say: (words: string) => void,
  ) {
    this.arrow.visible = false;
    for (const object of [this.arrow.line, this.arrow.cone]) {
      (object.material as any).depthTest = false;
      object.renderOrder = 6;
      object.frustumCulled = false;
    }
    stage.scene.add(this.arrow);
    const { canvas } = stage;
    // Before the camera's own controls, for which Ctrl means to move it.
    canvas.parentElement!.addEventListener(
      "pointerdown",
      (event) => {
        if (event.target === canvas && event.button === 0 && (event.ctrlKey || event.metaKey)) {
          this.begin(event);
        }
      },
      true,
    );
  }

  private begin(event: PointerEvent): void {
    event.stopPropagation();
    event.preventDefault();
    if (!this.isPlaying()) {
      this.say("Start the physics (space) to pull a body");
      return;
    }
    const hit = this.stage.hit(event.clientX, event.clientY);
    const world = this.stage.world!;
    const body = hit ? bodyOf(world.model, hit.element) : 0;
    if (!hit || body <= 0) {
      this.say("Pull something that moves");
      return;
    }
    const { canvas, camera } = this.stage;
    const plane = new Plane().setFromNormalAndCoplanarPoint(camera.getWorldDirection(new Vector3()), hit.point);
    const at = hit.point.clone().applyMatrix4(world.bodyMatrix(body).clone().invert()).toArray();
    const to = (each: PointerEvent) => {
      const ray = new Raycaster();
      const target = new Vector3();
      ray.setFromCamera(this.stage.place(each.clientX, each.clientY), camera);
      if (ray.ray.intersectPlane(plane, target)) {
        this.set({ body, at, to: target.toArray() });
      }
    };
    const end = () => {
      canvas.removeEventListener("pointermove", to);
      this.set(null);
    };
    canvas.setPointerCapture(event.pointerId);
    canvas.addEventListener("pointermove", to);
    canvas.addEventListener("pointerup", end, { once: true });
    canvas.addEventListener("lostpointercapture", end, { once: true });
    to(event);
  }

  private set(pull: Pull | null): void {
    if (!pull && !this.now) {
      return;
    }
    this.now = pull;
    this.pull(pull);
    this.stage.draw();
  }

  get isPulling(): boolean {
    return this.now !== null;
  }

  update(): void {
    const { world } = this.stage;
    this.arrow.visible = this.now !== null && world !== null;
    if (!this.now || !world) {
      return;
    }
    const from = new Vector3(...this.now.at).applyMatrix4(world.bodyMatrix(this.now.body));
    const way = new Vector3(...this.now.to).sub(from);
    const length = way.length();
    this.arrow.position.copy(from);
    this.arrow.setDirection(way.normalize());
    this.arrow.setLength(
      Math.max(length, 1e-6),
      Math.min(0.25 * length, 0.05 * from.distanceTo(this.stage.camera.position)),
      0.02 * from.distanceTo(this.stage.camera.position),
    );
  }
}
