// The model as the server or the file has it: `composer/mjcompose/mujoco/scene.py` describes it.

export interface Columns {
  name: string[];
  /** Flat lists, with a few numbers for each element. */
  [column: string]: any[];
}

export type Place = [file: number, line: number, column: number];
/** A part: its name and its place in words, the place of its entry, and the number of the part around it, or -1. */
export type Part = [words: string, place: Place | null, outer: number];
export type Change = [what: string, before: string | null, after: string | null, words: string, place: Place | null];
export type Origin = [place: Place | null, part: number, words: string, changes: Change[]] | null;

/**
 * The facts about a state beyond the poses of bodies. A contact has its two geoms, its position, its normal, and the
 * force on the second geom.
 */
export interface Seen {
  contacts: number[][];
  tendons: number[][];
  sensors: number[];
}

/** A pull at a point of a body, in its frame, to a point of the world. */
export interface Pull {
  body: number;
  at: number[];
  to: number[];
}

/** Where a pair of bodies is excluded from contact, and why, if `exclude: auto` found it. */
export type Excluded = [place: Place | null, words: string, why: string | null];

export interface Texture {
  blob: string;
  kind: "2d" | "cube" | "skybox";
  width: number;
  height: number;
}
export interface HeightField {
  blob: string;
  rows: number;
  columns: number;
  size: number[];
}
export interface Skin {
  name: string;
  body: number;
  blob: string;
  count: number;
  triangles: number;
  mapped: boolean;
  material: number;
  rgba: number[];
  group: number;
  inflate: number;
  bones: number[];
  moved: number[];
  pos: number[];
  quat: number[];
}
export interface Flex {
  name: string;
  body: number;
  blob: string;
  count: number;
  dimensions: number;
  triangles: number;
  edges: number;
  radius: number;
  material: number;
  rgba: number[];
  group: number;
}
export interface Look {
  center: number[];
  extent: number;
  azimuth: number;
  elevation: number;
  fovy: number;
  jointwidth: number;
  framewidth: number;
  stiffness: number;
  meansize: number;
  haze: number[];
  headlight: { active: boolean; ambient: number[]; diffuse: number[]; specular: number[] };
}
export interface Difference {
  text: string;
  before: Record<string, string[]>;
  after: Record<string, string[]>;
  label: string;
}
/** A number that a recipe declares; `standard` is its default. */
export interface Parameter {
  name: string;
  value: number;
  standard: number;
  low: number | null;
  high: number | null;
  whole: boolean;
  unit: string;
  doc: string;
}
export interface Choice {
  name: string;
  label: string;
  values: string[];
  value: string | null;
}

/**
 * Something that a recipe places: the place of its line, the frame of its place in a body, and the elements that move.
 */
export interface MoveRow {
  at: [file: number, line: number, column: number];
  label: string;
  kind: string;
  mount: number;
  frame: number[] | null;
  moved: Record<string, number[]>;
}
/** The things that a page may move, or the reason why there are none. */
export interface Move {
  why?: string;
  version: number;
  files: string[];
  targets: MoveRow[];
  framed: Record<string, number[]>;
}

export interface Scene {
  format: number;
  title: string;
  made: string;
  body: Columns;
  joint: Columns;
  geom: Columns;
  site: Columns;
  camera: Columns;
  light: Columns;
  material: Columns;
  tendon: Columns;
  sensor: Columns;
  actuator: Columns;
  key: Columns;
  exclude: { body1: number[]; body2: number[] };
  pair: Record<"one" | "other" | "friction" | "condim", number[]>;
  filterparent: boolean;
  mesh: string[];
  meshes?: string[];
  hfield: HeightField[];
  texture: Texture[];
  skin: Skin[];
  flex: Flex[];
  wrap: { type: number[]; object: number[]; parameter: number[] };
  poses: Seen[];
  qpos0: number[];
  timestep: number;
  look: Look;
  origins: {
    files: string[];
    parts: Part[];
    of: Record<string, Origin[]>;
    values: Record<string, Record<string, Place>[]>;
    exclude: Excluded[];
  };
  editor?: { template: string; files: Record<string, string> };
  key_named?: string | null;
  choices?: Choice[];
  params?: Parameter[];
  difference?: Difference;
  move?: Move;
}

export interface Model {
  scene: Scene;
  blobs: Map<string, ArrayBuffer>;
}

/** One element of a model: its kind, and its row among the elements of the kind. */
export interface Element {
  kind: string;
  index: number;
}

export async function unpacked(element: globalThis.Element): Promise<Model> {
  const text = atob((element.textContent ?? "").replace(/\s/g, ""));
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) {
    bytes[k] = text.charCodeAt(k);
  }
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const whole = await new Response(stream).arrayBuffer();
  const all = new Uint8Array(whole);
  const end = all.indexOf(10);
  const read = new TextDecoder();
  const [size, sizes] = JSON.parse(read.decode(all.subarray(0, end))) as [number, [string, number][]];
  let at = end + 1;
  const scene = JSON.parse(read.decode(all.subarray(at, at + size))) as Scene;
  at += size;
  const blobs = new Map<string, ArrayBuffer>();
  for (const [name, length] of sizes) {
    blobs.set(name, whole.slice(at, at + length));
    at += length;
  }
  return { scene, blobs };
}

/** The models that the page itself contains. */
export async function embedded(): Promise<Model[]> {
  const models = await Promise.all([...document.querySelectorAll("script.model")].map(unpacked));
  // The page contains the common data of both models once.
  const blobs = new Map(models.flatMap((each) => [...each.blobs]));
  return models.map(({ scene }) => ({ scene, blobs }));
}

export const row = (list: any[], index: number, width: number): number[] =>
  list.slice(index * width, (index + 1) * width);
