// The model as three.js draws it. Things of one form and material are drawn at once; the pose moves them.
import {
  AmbientLight,
  Box3,
  type BufferGeometry,
  Color,
  DirectionalLight,
  DynamicDrawUsage,
  Group,
  InstancedMesh,
  type Material,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  type MeshPhongMaterial,
  type Object3D,
  type PerspectiveCamera,
  PointLight,
  Quaternion,
  type Raycaster,
  SpotLight,
  Vector3,
} from "three";
import { type Columns, type Element, type Model, row } from "./data";
import { shade, suit } from "./detail";
import { Pose } from "./kinematics";
import { colourOf, Painter } from "./paint";
import { HFIELD, PLANE, shapeOf } from "./shapes";
import { Softs } from "./soft";

type Drawn = "geom" | "site";

interface Batch {
  mesh: InstancedMesh;
  members: number[];
  kind: Drawn;
  group: number;
  collides: boolean;
  /** The colors that the model has. */
  colors: Color[];
}

const GLASS = 0.35;
/** The matrix of a thing that is hidden: nothing is left of it. */
const NOTHING = new Matrix4().makeScale(0, 0, 0);

/** The colors that mark the elements that are selected, and the element under the pointer. */
export const SELECTED = 0x3b82f6;
export const POINTED = 0xffb020;

/** Models with more geoms have rounder things drawn with fewer corners. */
const MANY = 1500;

/** A light of three.js for one of MuJoCo, whose cutoff is in degrees. */
function lamp(type: number, color: Color, cutoff: number, exponent: number): DirectionalLight | SpotLight | PointLight {
  if (type === 1) {
    return new DirectionalLight(color, Math.PI);
  }
  if (type === 0 && cutoff < 90) {
    return new SpotLight(color, Math.PI, 0, (cutoff * Math.PI) / 180, Math.min(1, exponent / 20 + 0.15), 0);
  }
  return new PointLight(color, Math.PI, 0, 0);
}

export class World {
  readonly root = new Group();
  readonly pose: Pose;
  readonly painter: Painter;
  readonly softs: Softs;
  readonly lights: Object3D[] = [];
  private readonly batches: Batch[] = [];
  private readonly forms = new Map<string, BufferGeometry>();
  private readonly local: Record<Drawn, Matrix4[]> = { geom: [], site: [] };
  private readonly bodies: Matrix4[];
  private readonly marks = new Group();
  private readonly marked: { mesh: Mesh; kind: Drawn; index: number }[] = [];
  private readonly tinted: { mesh: Mesh; kind: Drawn; index: number }[] = [];
  private readonly far: number;
  private hidden: ReadonlySet<number> = new Set();
  /** Whether shadows differ from those that were drawn last. */
  isShadowOld = true;
  readonly headlight = new PointLight(0xffffff, 0, 0, 0);
  private readonly followers: { light: PointLight | SpotLight | DirectionalLight; index: number }[] = [];

  /** Surfaces that the model `before` has, too, are taken from there. */
  constructor(
    readonly model: Model,
    private before?: World,
  ) {
    const { scene } = model;
    this.pose = new Pose(scene);
    this.painter = new Painter(model);
    this.softs = new Softs(model, this.painter, this.pose);
    this.bodies = scene.body.name.map(() => new Matrix4());
    this.far = Math.max(12 * scene.look.extent, 10);
    this.root.add(this.marks, this.softs.root);
  }

  async load(): Promise<void> {
    await this.painter.load();
    this.batch("geom", this.model.scene.geom);
    this.batch("site", this.model.scene.site);
    this.before = undefined;
    this.softs.build();
    this.light();
    this.update();
  }

  private batch(kind: Drawn, columns: Columns): void {
    const { scene } = this.model;
    const fine = columns.name.length < MANY;
    const groups = new Map<
      string,
      { members: number[]; make: () => InstancedMesh; batch: Omit<Batch, "mesh" | "members" | "colors"> }
    >();
    const colors: Color[] = [];
    columns.type.forEach((type: number, index: number) => {
      const size = row(columns.size, index, 3);
      const material = columns.material[index];
      const data = kind === "geom" ? columns.data[index] : -1;
      const shape = shapeOf(this.model, type, size, data, this.far, fine);
      const rgba = colourOf(this.model, row(columns.rgba, index, 4), material);
      const [w, x, y, z] = row(columns.quat, index, 4);
      this.local[kind].push(
        new Matrix4().compose(
          new Vector3(...(row(columns.pos, index, 3) as [number, number, number])),
          new Quaternion(x, y, z, w),
          new Vector3(...shape.scale),
        ),
      );
      colors.push(new Color().setRGB(rgba[0], rgba[1], rgba[2]));
      const textured = material >= 0 && scene.material.texture[material] >= 0;
      const endless = shape.key === "endless";
      const mapped = data >= 0 && textured && this.form(shape).hasAttribute("uv");
      // The values on which a texture depends if the surface has no coordinates of its own.
      let measure: number[] | null = null;
      if (endless) {
        measure = [0, 0, this.far];
      } else if (textured && !mapped) {
        measure = data >= 0 ? meshSize(this.form(shape)) : size;
      }
      const collides = kind === "geom" && (columns.contype[index] > 0 || columns.conaffinity[index] > 0);
      const batch = { kind, group: columns.group[index], collides };
      const key = [shape.key, material, rgba[3], measure, ...Object.values(batch)].join("|");
      if (!groups.has(key)) {
        groups.set(key, {
          members: [],
          batch,
          make: () => {
            const paint = this.painter.material(material, rgba[3], measure, endless);
            paint.flatShading = !this.form(shape).hasAttribute("normal");
            const mesh = new InstancedMesh(this.form(shape), paint, groups.get(key)!.members.length);
            mesh.castShadow = rgba[3] >= 1 && type !== PLANE;
            mesh.receiveShadow = true;
            shade(mesh);
            mesh.visible = rgba[3] > 0;
            mesh.renderOrder = rgba[3] < 1 ? 1 : 0;
            return mesh;
          },
        });
      }
      groups.get(key)!.members.push(index);
    });
    for (const { members, make, batch } of groups.values()) {
      const mesh = make();
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      mesh.frustumCulled = false;
      members.forEach((index, at) => mesh.setColorAt(at, colors[index]));
      this.batches.push({ mesh, members, colors: members.map((index) => colors[index]), ...batch });
      this.root.add(mesh);
    }
  }

  private form(shape: { key: string; make: () => BufferGeometry }): BufferGeometry {
    let form = this.forms.get(shape.key);
    if (!form) {
      form = this.before?.give(shape.key) ?? shape.make();
      this.forms.set(shape.key, form);
    }
    return form;
  }

  /** Only of a mesh the key says all, the hash of its bytes. */
  private give(key: string): BufferGeometry | undefined {
    const form = key.startsWith("mesh ") ? this.forms.get(key) : undefined;
    if (form) {
      this.forms.delete(key);
    }
    return form;
  }

  /** Lights of the model and the light at the camera, which is bright enough alone. */
  private light(): void {
    const { light, look } = this.model.scene;
    const ambient = new Color(0, 0, 0);
    let shadows = 0;
    let lit = false;
    light.type.forEach((type: number, index: number) => {
      if (!light.active[index]) {
        return;
      }
      const three = (name: string) => row(light[name], index, 3) as [number, number, number];
      ambient.add(new Color().setRGB(...three("ambient")));
      const color = new Color().setRGB(...three("diffuse"));
      if (color.r + color.g + color.b === 0) {
        return;
      }
      lit = true;
      const made = lamp(type, color, light.cutoff[index], light.exponent[index]);
      if (light.shadow[index] && shadows < 2 && !(made instanceof PointLight)) {
        shadows++;
        made.castShadow = true;
        made.shadow.mapSize.set(2048, 2048);
        made.shadow.bias = -0.0005;
        made.shadow.normalBias = 0.02 * look.meansize;
        if (made instanceof DirectionalLight) {
          const r = 1.5 * look.extent;
          const lens = made.shadow.camera;
          lens.left = lens.bottom = -r;
          lens.right = lens.top = r;
          lens.near = 0.01 * look.extent;
          lens.far = 12 * look.extent;
        } else {
          made.shadow.camera.near = 0.05 * look.extent;
          made.shadow.camera.far = 20 * look.extent;
        }
      }
      this.followers.push({ light: made, index });
      this.root.add(made);
      if (!(made instanceof PointLight)) {
        this.root.add(made.target);
      }
    });
    const { headlight } = look;
    const color = new Color().setRGB(...(headlight.diffuse as [number, number, number]));
    const around = new Color().setRGB(...(headlight.ambient as [number, number, number]));
    if (headlight.active) {
      ambient.add(around);
    }
    this.headlight.intensity = headlight.active ? Math.PI : 0;
    if (!lit) {
      color.setRGB(Math.max(color.r, 0.6), Math.max(color.g, 0.6), Math.max(color.b, 0.6));
      ambient.setRGB(Math.max(ambient.r, 0.3), Math.max(ambient.g, 0.3), Math.max(ambient.b, 0.3));
      this.headlight.intensity = Math.PI;
    }
    this.headlight.color.copy(color);
    this.root.add(new AmbientLight(ambient, Math.PI));
  }

  /** Put everything where the pose has it. */
  update(): void {
    const { pose } = this;
    const place = new Vector3();
    const turn = new Quaternion();
    const one = new Vector3(1, 1, 1);
    this.bodies.forEach((body, b) => {
      place.fromArray(pose.pos, 3 * b);
      turn.set(pose.quat[4 * b + 1], pose.quat[4 * b + 2], pose.quat[4 * b + 3], pose.quat[4 * b]);
      body.compose(place, turn, one);
    });
    const matrix = new Matrix4();
    for (const { mesh, members, kind } of this.batches) {
      const on = this.model.scene[kind].body;
      members.forEach((index, at) => {
        mesh.setMatrixAt(
          at,
          this.isHidden(kind, index)
            ? NOTHING
            : matrix.multiplyMatrices(this.bodies[on[index]], this.local[kind][index]),
        );
      });
      mesh.instanceMatrix.needsUpdate = true;
      mesh.boundingSphere = null;
    }
    for (const { mesh, kind, index } of [...this.marked, ...this.tinted]) {
      this.matrixOf(kind, index, mesh.matrix);
    }
    for (const { light, index } of this.followers) {
      this.follow(light, index);
    }
    this.softs.update();
    this.isShadowOld = true;
  }

  private follow(light: PointLight | SpotLight | DirectionalLight, index: number): void {
    const { light: columns, look } = this.model.scene;
    const on = this.bodies[columns.body[index]];
    light.position.fromArray(columns.pos, 3 * index).applyMatrix4(on);
    if (light instanceof PointLight) {
      return;
    }
    const along = new Vector3().fromArray(columns.dir, 3 * index).transformDirection(on);
    if (light instanceof DirectionalLight) {
      // It comes from everywhere: its shadows shall be where the model is.
      const middle = new Vector3().fromArray(look.center);
      light.position.copy(middle).addScaledVector(along, -4 * look.extent);
      light.target.position.copy(middle);
    } else {
      light.target.position.copy(light.position).add(along);
    }
  }

  /** A geom or a site has another place in its body. */
  place(kind: Drawn, index: number): void {
    const { pos, quat } = this.model.scene[kind];
    const [w, x, y, z] = row(quat, index, 4);
    const size = new Vector3();
    this.local[kind][index].decompose(new Vector3(), new Quaternion(), size);
    this.local[kind][index].compose(new Vector3().fromArray(pos, 3 * index), new Quaternion(x, y, z, w), size);
  }

  bodyMatrix(body: number): Matrix4 {
    return this.bodies[body];
  }

  matrixOf(kind: Drawn, index: number, into = new Matrix4()): Matrix4 {
    return into.multiplyMatrices(this.bodies[this.model.scene[kind].body[index]], this.local[kind][index]);
  }

  /**
   * The box around all geoms, or also all sites; the ground, planes and height fields, counts only if all is ground.
   */
  box(sites = false): Box3 {
    const bounds = new Box3();
    const planes = new Box3();
    for (const { mesh, members, kind } of this.batches) {
      if (!mesh.visible || (kind !== "geom" && !sites)) {
        continue;
      }
      mesh.geometry.computeBoundingBox();
      members.forEach((index) => {
        if (this.isHidden(kind, index)) {
          return;
        }
        const box = mesh.geometry.boundingBox!.clone().applyMatrix4(this.matrixOf(kind, index));
        const type = kind === "geom" ? this.model.scene.geom.type[index] : -1;
        if (type !== PLANE && type !== HFIELD) {
          bounds.union(box);
        } else if (type === HFIELD || this.model.scene.geom.size[3 * index] > 0) {
          planes.union(box);
        }
      });
    }
    bounds.union(this.softs.box());
    if (!bounds.isEmpty()) {
      return bounds;
    }
    return planes.isEmpty() ? new Box3(new Vector3(-1, -1, 0), new Vector3(1, 1, 1)) : planes;
  }

  boxOf(element: Element): Box3 {
    const bounds = new Box3();
    const drawn = this.drawnOf(element);
    for (const { kind, index } of drawn) {
      const geometry = this.geometryOf(kind, index);
      geometry.computeBoundingBox();
      bounds.union(geometry.boundingBox!.clone().applyMatrix4(this.matrixOf(kind, index)));
    }
    return bounds;
  }

  /** Leave out triangles that nobody sees. */
  suit(camera: PerspectiveCamera, pixels: number, fine: number): void {
    for (const { mesh } of this.batches) {
      if (mesh.visible) {
        suit(mesh, camera, pixels, fine);
      }
    }
  }

  show(visible: (kind: Drawn, group: number, collides: boolean) => boolean): void {
    for (const batch of this.batches) {
      const material = batch.mesh.material as Material;
      batch.mesh.visible = material.opacity > 0 && visible(batch.kind, batch.group, batch.collides);
    }
    this.isShadowOld = true;
  }

  /** Draw the model without some geoms. */
  setHidden(geoms: ReadonlySet<number>): void {
    this.hidden = geoms;
    this.update();
  }

  private isHidden(kind: Drawn, index: number): boolean {
    return kind === "geom" && this.hidden.has(index);
  }

  /** Draw all surfaces like glass, or as wires. */
  setStyle(glass: boolean, wires: boolean): void {
    for (const { mesh, kind } of this.batches) {
      const paint = mesh.material as MeshPhongMaterial;
      mesh.userData.paint ??= {
        opacity: paint.opacity,
        transparent: paint.transparent,
        depthWrite: paint.depthWrite,
      };
      const own = mesh.userData.paint;
      const isGlass = glass && kind === "geom";
      paint.opacity = isGlass ? Math.min(GLASS, own.opacity) : own.opacity;
      paint.transparent = isGlass || own.transparent;
      paint.depthWrite = isGlass ? false : own.depthWrite;
      paint.wireframe = wires && kind === "geom";
      paint.needsUpdate = true;
    }
  }

  /** The geoms that are drawn at once, with their places on their bodies. */
  *surfaces(): Generator<{ mesh: InstancedMesh; members: number[]; matrices: Matrix4[] }> {
    for (const { mesh, members, kind } of this.batches) {
      if (kind === "geom") {
        yield { mesh, members, matrices: this.local.geom };
      }
    }
  }

  hit(ray: Raycaster): { element: Element; point: Vector3 } | null {
    const hits = ray.intersectObjects(
      [...this.batches.filter(({ mesh }) => mesh.visible).map(({ mesh }) => mesh), ...this.softs.targets()],
      false,
    );
    const batchOf = (object: Object3D) => this.batches.find(({ mesh }) => mesh === object);
    const hit = hits.find(({ object, instanceId }) => {
      const batch = batchOf(object);
      return !batch || !this.isHidden(batch.kind, batch.members[instanceId!]);
    });
    if (!hit) {
      return null;
    }
    const batch = batchOf(hit.object);
    const element = batch
      ? { kind: batch.kind, index: batch.members[hit.instanceId!] }
      : this.softs.element(hit.object, hit.instanceId);
    return element && { element, point: hit.point };
  }

  /** Color elements in another way than the model does. The color is drawn over a texture. */
  recolour(colors: (kind: string, index: number) => Color | null): void {
    this.uncover(this.tinted);
    const { scene } = this.model;
    const paints = new Map<number, MeshBasicMaterial>();
    for (const { mesh, members, kind, colors: own } of this.batches) {
      const columns = scene[kind];
      members.forEach((index, at) => {
        mesh.setColorAt(at, own[at]);
        const color = colors(kind, index);
        if (!color) {
          return;
        }
        mesh.setColorAt(at, color);
        const material = columns.material[index];
        if (material < 0 || scene.material.texture[material] < 0) {
          return;
        }
        const paint = paints.get(color.getHex()) ?? overlay(color.getHex(), 0.6);
        paints.set(color.getHex(), paint);
        this.cover(this.tinted, kind, index, paint);
      });
      if (mesh.instanceColor) {
        mesh.instanceColor.needsUpdate = true;
      }
    }
  }

  /** Mark what is selected. */
  mark(elements: Element[], color: number): void {
    this.uncover(this.marked);
    const paint = overlay(color, 0.42);
    for (const { kind, index } of elements.flatMap((element) => this.drawnOf(element))) {
      if (!this.isHidden(kind, index)) {
        this.cover(this.marked, kind, index, paint);
      }
    }
  }

  private cover(list: typeof this.marked, kind: Drawn, index: number, paint: MeshBasicMaterial): void {
    const mesh = new Mesh(this.geometryOf(kind, index), paint);
    mesh.matrixAutoUpdate = false;
    mesh.renderOrder = 3;
    this.matrixOf(kind, index, mesh.matrix);
    this.marks.add(mesh);
    list.push({ mesh, kind, index });
  }

  private uncover(list: typeof this.marked): void {
    for (const { mesh } of list) {
      this.marks.remove(mesh);
    }
    list.length = 0;
  }

  private drawnOf({ kind, index }: Element): { kind: Drawn; index: number }[] {
    const { scene } = this.model;
    if (kind === "geom" || kind === "site") {
      return [{ kind, index }];
    }
    let body = -1;
    if (kind === "body") {
      body = index;
    } else if (kind === "joint") {
      body = scene.joint.body[index];
    }
    if (body <= 0) {
      return [];
    }
    const geoms: { kind: Drawn; index: number }[] = [];
    for (const { mesh, members, kind: drawn } of this.batches) {
      if (!mesh.visible || drawn !== "geom") {
        continue;
      }
      for (const geom of members) {
        if (scene.geom.body[geom] === body) {
          geoms.push({ kind: drawn, index: geom });
        }
      }
    }
    return geoms;
  }

  private geometryOf(kind: Drawn, index: number): BufferGeometry {
    return this.batches.find((each) => each.kind === kind && each.members.includes(index))!.mesh.geometry;
  }

  dispose(): void {
    for (const form of this.forms.values()) {
      form.dispose();
    }
    for (const { mesh } of this.batches) {
      (mesh.material as Material).dispose();
      mesh.dispose();
    }
    this.softs.dispose();
    this.painter.dispose();
    this.root.traverse((each) => {
      if (each instanceof SpotLight || each instanceof DirectionalLight) {
        each.shadow.map?.dispose();
      }
    });
  }
}

function overlay(color: number, opacity: number): MeshBasicMaterial {
  return new MeshBasicMaterial({
    color,
    transparent: true,
    opacity,
    depthWrite: false,
    polygonOffset: true,
    polygonOffsetFactor: -2,
    polygonOffsetUnits: -2,
  });
}

function meshSize(geometry: BufferGeometry): number[] {
  geometry.computeBoundingBox();
  const size = geometry.boundingBox!.getSize(new Vector3());
  return [size.x / 2, size.y / 2, size.z / 2];
}
