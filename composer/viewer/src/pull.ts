// Pulling a body with Ctrl and the mouse while physics run.
import { ArrowHelper, Plane, Raycaster, Vector3 } from "three";
import type { Pull } from "./seen";
import type { Stage } from "./stage";
import { bodyOf } from "./tree";

export class Puller {
  private now: Pull | null = null;
  private readonly arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 1, 0xf43f5e);

  constructor(private readonly stage: Stage, private readonly isPlaying: () => boolean, private readonly pull: (pull: Pull | null) => void, private readonly say: (words: string) => void) {
    this.arrow.visible = false;
    for (const each of [this.arrow.line, this.arrow.cone]) {
      (each.material as any).depthTest = false;
      each.renderOrder = 6;
      each.frustumCulled = false;
    }
    stage.scene.add(this.arrow);
    const { canvas } = stage;
    // Before the camera's own controls, for which Ctrl means to move it.
    canvas.parentElement!.addEventListener("pointerdown", (event) => {
      if (event.target === canvas && event.button === 0 && (event.ctrlKey || event.metaKey)) this.begin(event);
    }, true);
  }

  private begin(event: PointerEvent): void {
    event.stopPropagation();
    event.preventDefault();
    if (!this.isPlaying()) return this.say("Start the physics (space) to pull a body");
    const hit = this.stage.hit(event.clientX, event.clientY), world = this.stage.world!, body = hit ? bodyOf(world.model, hit.element) : 0;
    if (!hit || body <= 0) return this.say("Pull something that moves");
    const { canvas, camera } = this.stage, plane = new Plane().setFromNormalAndCoplanarPoint(camera.getWorldDirection(new Vector3()), hit.point);
    const at = hit.point.clone().applyMatrix4(world.bodyMatrix(body).clone().invert()).toArray();
    const to = (each: PointerEvent) => {
      const ray = new Raycaster(), found = new Vector3();
      ray.setFromCamera(this.stage.place(each.clientX, each.clientY), camera);
      if (ray.ray.intersectPlane(plane, found)) this.set({ body, at, to: found.toArray() });
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
    if (!pull && !this.now) return;
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
    if (!this.now || !world) return;
    const from = new Vector3(...this.now.at).applyMatrix4(world.bodyMatrix(this.now.body)), way = new Vector3(...this.now.to).sub(from), length = way.length();
    this.arrow.position.copy(from);
    this.arrow.setDirection(way.normalize());
    this.arrow.setLength(Math.max(length, 1e-6), Math.min(0.25 * length, 0.05 * from.distanceTo(this.stage.camera.position)), 0.02 * from.distanceTo(this.stage.camera.position));
  }
}
