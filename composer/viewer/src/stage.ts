// The canvas: camera, controls, drawing when something has changed, the picture as an image, and the compass.
import {
  type Box3,
  Color,
  ColorManagement,
  LinearSRGBColorSpace,
  NoToneMapping,
  PCFShadowMap,
  PerspectiveCamera,
  type Quaternion,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { type Element, row } from "./data";
import { h, toast } from "./dom";
import { rotated } from "./kinematics";
import type { World } from "./world";

/** How long the page counts as moving after a change, and the time that a picture may take then, in milliseconds. */
const STILL = 180;
const SLOW = 33;
const QUICK = 14;
/** Cells of a surface for each pixel, and pixels of the picture for each of the screen, at rest and at their least. */
const FINE = 1.5;
const LEAST_FINE = 0.06;
const LEAST_RATIO = 0.4;

// Colors go to the screen as MuJoCo has them.
ColorManagement.enabled = false;

/** How much more or less detail the next picture gets, after one that took this many milliseconds. */
function easing(took: number): number {
  if (took > 3 * SLOW) {
    return -0.3;
  }
  if (took > SLOW) {
    return -0.1;
  }
  return took < QUICK ? 0.05 : 0;
}

export class Stage {
  readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(45, 1, 0.01, 1000);
  readonly controls: OrbitControls;
  world: World | null = null;
  /** The camera of the model through which the page looks. */
  through: number | null = null;
  beforeFrame: (() => void) | null = null;
  private due = false;
  private ease = 0.5;
  private isMoving = false;
  /** When the picture before was drawn, if the page moved then. */
  private drawnAt = 0;
  private took = 0;
  private settling = 0;
  private readonly ratio = Math.min(devicePixelRatio, 2);
  private readonly left: World[] = [];
  frames = 0;

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.toneMapping = NoToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    // Looking for errors waits for each program to be compiled.
    this.renderer.debug.checkShaderErrors = false;
    this.renderer.setPixelRatio(this.ratio);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.move());
    this.controls.addEventListener("start", () => {
      this.through = null;
    });
    canvas.addEventListener("pointerup", () => this.rest());
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
    canvas.addEventListener("webglcontextrestored", () => this.draw());
  }

  /** Show a model instead of the one before; the camera stays unless there was none. */
  show(world: World): void {
    const first = this.world === null;
    const before = this.world;
    if (before) {
      this.scene.remove(before.root, before.headlight);
    }
    this.world = world;
    this.scene.add(world.root, world.headlight);
    const sky = world.painter.sky();
    this.scene.background = sky;
    // The up of three.js is y.
    this.scene.backgroundRotation.set(Math.PI / 2, 0, 0);
    if (first) {
      this.fit();
    }
    if (first) {
      this.move();
    }
    if (before) {
      this.left.push(before);
    }
    this.draw();
  }

  resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement!;
    if (!width || !height) {
      return;
    }
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /**
   * Fit the whole model or a part of it into the picture, seen from the present side or from the side that its author
   * chose.
   */
  fit(box?: Box3): void {
    const { look } = this.world!.model.scene;
    const whole = !box;
    const bounds = box && !box.isEmpty() ? box : this.world!.box();
    const angles = look.azimuth === 90 && look.elevation === -45 ? [135, -22] : [look.azimuth, look.elevation];
    const [azimuth, elevation] = angles.map((each) => (each * Math.PI) / 180);
    const forward = whole
      ? new Vector3(
          Math.cos(elevation) * Math.cos(azimuth),
          Math.cos(elevation) * Math.sin(azimuth),
          Math.sin(elevation),
        )
      : this.camera.getWorldDirection(new Vector3());
    this.camera.fov = look.fovy > 1 && look.fovy < 150 ? look.fovy : 45;
    const right = new Vector3().crossVectors(forward, this.camera.up).normalize();
    const up = new Vector3().crossVectors(right, forward);
    const high = Math.tan((this.camera.fov * Math.PI) / 360) / 1.12;
    const wide = high * this.camera.aspect;
    const target = bounds.getCenter(new Vector3());
    let distance = 0;
    for (let k = 0; k < 8; k++) {
      const corner = new Vector3(
        k & 1 ? bounds.max.x : bounds.min.x,
        k & 2 ? bounds.max.y : bounds.min.y,
        k & 4 ? bounds.max.z : bounds.min.z,
      ).sub(target);
      const depth = corner.dot(forward);
      distance = Math.max(
        distance,
        Math.abs(corner.dot(right)) / wide - depth,
        Math.abs(corner.dot(up)) / high - depth,
      );
    }
    distance = Math.max(distance, 1e-3 * look.extent);
    this.through = null;
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(forward, -distance);
    this.clip();
    this.controls.update();
    this.draw();
  }

  private clip(): void {
    const { extent } = this.world!.model.scene.look;
    const reach = this.world!.box(true);
    const size = reach.getSize(new Vector3()).length();
    const away = this.camera.position.distanceTo(reach.getCenter(new Vector3())) + size + 15 * extent;
    this.camera.near = Math.max(0.002 * extent, 1e-5);
    this.camera.far = Math.max(60 * extent, 4 * away);
    this.camera.updateProjectionMatrix();
  }

  /** Look through a camera of the model, and follow it. */
  lookThrough(index: number): void {
    this.through = index;
    this.follow();
    this.draw();
  }

  private follow(): void {
    if (this.through === null || !this.world) {
      return;
    }
    const { camera, look } = this.world.model.scene;
    const { pose } = this.world;
    const index = this.through;
    const b = camera.body[index];
    const place = rotated(pose.quat, 4 * b, camera.pos, 3 * index).map((each, k) => each + pose.pos[3 * b + k]);
    const turned = (v: number[]) => {
      const own = rotated(row(camera.quat, index, 4), 0, v, 0);
      return new Vector3(...rotated(pose.quat, 4 * b, own, 0));
    };
    this.camera.position.fromArray(place);
    const forward = turned([0, 0, -1]);
    const up = turned([0, 1, 0]);
    const target = camera.target[index];
    if (camera.mode[index] >= 3 && target >= 0) {
      forward
        .fromArray(pose.pos, 3 * target)
        .sub(this.camera.position)
        .normalize();
    }
    this.camera.up.copy(camera.mode[index] >= 3 ? new Vector3(0, 0, 1) : up);
    this.camera.fov = camera.fovy[index];
    this.camera.lookAt(this.camera.position.clone().add(forward));
    this.camera.up.set(0, 0, 1);
    this.controls.target.copy(this.camera.position).addScaledVector(forward, Math.max(0.3 * look.extent, 0.05));
    this.clip();
  }

  pick(x: number, y: number): Element | null {
    return this.hit(x, y)?.element ?? null;
  }

  /** The thing that is drawn at a point of the window, and its place. */
  hit(x: number, y: number): { element: Element; point: Vector3 } | null {
    const ray = new Raycaster();
    ray.setFromCamera(this.place(x, y), this.camera);
    return this.world?.hit(ray) ?? null;
  }

  /** A point of the window as the camera counts: from -1 to 1, up. */
  place(x: number, y: number): Vector2 {
    const box = this.canvas.getBoundingClientRect();
    return new Vector2((2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height);
  }

  /** Look at the same point from a direction. */
  lookFrom(way: Vector3): void {
    const { target } = this.controls;
    const distance = this.camera.position.distanceTo(target);
    this.through = null;
    this.camera.position.copy(target).addScaledVector(way, distance);
    this.controls.update();
    this.draw();
  }

  /** Draw at once with all detail. */
  sharp(): void {
    this.isMoving = false;
    this.now();
  }

  background(color: string | null): void {
    this.scene.background = color === null ? (this.world?.painter.sky() ?? null) : new Color(color);
    this.draw();
  }

  /** Draw a moving model: with less detail if this machine is slow, and once more with all details afterwards. */
  move(): void {
    this.isMoving = true;
    clearTimeout(this.settling);
    this.settling = window.setTimeout(
      () => {
        this.isMoving = false;
        this.draw();
      },
      Math.max(STILL, 3 * this.took),
    );
    this.draw();
  }

  /** Nothing moves any more. */
  rest(): void {
    if (!this.isMoving) {
      return;
    }
    clearTimeout(this.settling);
    this.isMoving = false;
    this.draw();
  }

  draw(): void {
    if (this.due) {
      return;
    }
    this.due = true;
    requestAnimationFrame(() => {
      if (this.due) {
        this.now();
      }
    });
  }

  now(): void {
    this.due = false;
    if (!this.world) {
      return;
    }
    this.follow();
    // `lookAt` leaves the new place with the old direction in the matrix.
    this.camera.updateMatrixWorld();
    this.beforeFrame?.();
    this.world.headlight.position.copy(this.camera.position);
    this.suit(performance.now());
    this.renderer.render(this.scene, this.camera);
    // Only now, because the new model uses the common data again, such as programs of the GPU.
    for (const world of this.left.splice(0)) {
      world.dispose();
    }
    this.frames++;
    document.documentElement.dataset.frames = String(this.frames);
  }

  /** Choose the detail of the next picture by how long the ones before took. */
  private suit(now: number): void {
    if (this.isMoving && this.drawnAt) {
      this.took = Math.min(now - this.drawnAt, 1000);
      this.ease = Math.min(1, Math.max(0, this.ease + easing(this.took)));
    }
    this.drawnAt = this.isMoving ? now : 0;
    const share = this.isMoving ? this.ease : 1;
    const ratio = this.ratio * Math.max(LEAST_RATIO, share);
    if (this.renderer.getPixelRatio() !== ratio) {
      this.renderer.setPixelRatio(ratio);
    }
    this.world!.suit(this.camera, this.canvas.clientHeight * this.ratio, FINE * (LEAST_FINE / FINE) ** (1 - share));
    this.renderer.shadowMap.needsUpdate ||= this.world!.isShadowOld;
    this.world!.isShadowOld = false;
  }
}

export async function copyPicture(stage: Stage, name: string): Promise<void> {
  const blob = await picture(stage);
  try {
    await navigator.clipboard.write([new ClipboardItem({ "image/png": blob })]);
    toast("copied the picture");
  } catch {
    const link = h("a", { href: URL.createObjectURL(blob), download: `${name}.png` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    toast(`saved the picture as ${name}.png, because the browser keeps its clipboard closed`);
  }
}

/** The canvas on the page's background, which it does not have itself. */
export function picture(stage: Stage): Promise<Blob> {
  stage.sharp();
  const { canvas } = stage;
  const made = h("canvas", { width: canvas.width, height: canvas.height });
  const pen = made.getContext("2d")!;
  const style = getComputedStyle(document.documentElement);
  const ground = pen.createRadialGradient(
    0.5 * made.width,
    0.35 * made.height,
    0,
    0.5 * made.width,
    0.35 * made.height,
    0.75 * Math.max(made.width, made.height),
  );
  ground.addColorStop(0, style.getPropertyValue("--ground").trim());
  ground.addColorStop(1, style.getPropertyValue("--ground2").trim());
  pen.fillStyle = ground;
  pen.fillRect(0, 0, made.width, made.height);
  pen.drawImage(canvas, 0, 0);
  const names = canvas.parentElement!.querySelector<HTMLCanvasElement>("canvas.labels");
  if (names && !names.hidden) {
    pen.drawImage(names, 0, 0, made.width, made.height);
  }
  return new Promise((done, failed) =>
    made.toBlob((blob) => (blob ? done(blob) : failed(new Error("the browser makes no picture"))), "image/png"),
  );
}

const AXES = [
  ["X", [1, 0, 0], "#e5484d"],
  ["Y", [0, 1, 0], "#30a46c"],
  ["Z", [0, 0, 1], "#3b82f6"],
] as const;
const SIZE = 76;
const REACH = 26;
const SPACE = "http://www.w3.org/2000/svg";

export class Compass {
  readonly root = document.createElementNS(SPACE, "svg");
  private readonly ends: { group: SVGGElement; line: SVGLineElement; way: Vector3 }[] = [];

  constructor(private readonly stage: Stage) {
    this.root.setAttribute("class", "compass");
    this.root.setAttribute("viewBox", `${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`);
    for (const [name, way, color] of AXES) {
      for (const sign of [1, -1]) {
        this.end(name, new Vector3(...way).multiplyScalar(sign), color, sign > 0);
      }
    }
  }

  private end(name: string, way: Vector3, color: string, positive: boolean): void {
    const make = <K extends keyof SVGElementTagNameMap>(
      tag: K,
      set: Record<string, string>,
    ): SVGElementTagNameMap[K] => {
      const made = document.createElementNS(SPACE, tag);
      for (const [key, value] of Object.entries(set)) {
        made.setAttribute(key, value);
      }
      return made;
    };
    const words = `look from ${positive ? "+" : "−"}${name}`;
    const group = make("g", { role: "button", tabindex: "0", "aria-label": words });
    const line = make("line", { stroke: color, "stroke-width": positive ? "2" : "0" });
    const title = make("title", {});
    title.textContent = words;
    group.append(
      title,
      make("circle", {
        r: positive ? "8.5" : "5.5",
        fill: color,
        "fill-opacity": positive ? "1" : ".35",
        stroke: "none",
      }),
    );
    if (positive) {
      const text = make("text", {
        "text-anchor": "middle",
        "dominant-baseline": "central",
        fill: "#fff",
        stroke: "none",
        "font-size": "10",
        "font-weight": "700",
      });
      text.textContent = name;
      group.append(text);
    }
    const look = () => this.stage.lookFrom(way);
    group.addEventListener("click", look);
    group.addEventListener("keydown", (event) => {
      if (event.key === "Enter" || event.key === " ") {
        event.preventDefault();
        event.stopPropagation();
        look();
      }
    });
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
    const order = seen.sort((a, b) => a.at.z - b.at.z).map((each) => each.group);
    const now = [...this.root.querySelectorAll("g")];
    if (order.some((each, k) => each !== now[k]) && !this.root.contains(document.activeElement)) {
      this.root.append(...order);
    }
  }
}
