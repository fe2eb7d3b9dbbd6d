// How a live page reaches its server: by itself, or through the editor that shows it; and which element the lines
// around the cursor mean.
import type { Element, Place, Scene } from "./data";

export interface Wire {
  get(path: string): Promise<ArrayBuffer>;
  post(path: string, data: unknown): Promise<void>;
  /** Posts, and gives the answer. An editor that is older than the page has none. */
  ask?(path: string, data: unknown): Promise<any>;
  /** Calls `event` with each event of the server, and `lost` when there is no answer. */
  listen(event: (name: string, data: any) => void, lost: () => void): void;
}

/** An editor around the page. It gives the page `mjcomposeHost` before the page begins. */
export interface Host extends Wire {
  theme: string;
  open(file: string, line: number, column: number): void;
  /**
   * Calls `theme` when the editor looks different, and `reveal` with the places around the cursor, the innermost first.
   */
  follow(
    theme: (name: string) => void,
    reveal: (files: string[], places: [line: number, column: number][]) => void,
  ): void;
}

export const host: Host | null = (window as any).mjcomposeHost ?? null;

const EVENTS = ["model", "fault", "state"];

export class Http implements Wire {
  async get(path: string): Promise<ArrayBuffer> {
    const answer = await fetch(path);
    if (!answer.ok) {
      throw new Error(`${path}: ${answer.status}`);
    }
    return answer.arrayBuffer();
  }

  async post(path: string, data: unknown): Promise<void> {
    await fetch(path, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(data) });
  }

  async ask(path: string, data: unknown): Promise<any> {
    const answer = await fetch(path, {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify(data),
    });
    if (!answer.ok) {
      throw new Error(answer.statusText);
    }
    return answer.json();
  }

  listen(event: (name: string, data: any) => void, lost: () => void): void {
    const events = new EventSource("events");
    for (const name of EVENTS) {
      events.addEventListener(name, (message) => event(name, JSON.parse((message as MessageEvent).data)));
    }
    events.addEventListener("error", lost);
  }
}

/**
 * The element that is written at the first of `places` that has one: an element's own line, then the entry of a part,
 * which means its first body, then what changed an element. Null where nothing is written at any of them. The
 * selected element stays if it is written there, too: a file that is used twice writes several elements.
 */
export function elementAt(
  scene: Scene,
  files: string[],
  places: [line: number, column: number][],
  selected: Element | null,
): Element | null {
  const paths = new Set(files.map(folded));
  const known = scene.editor?.files ?? {};
  const isThere = scene.origins.files.map((name) => known[name] !== undefined && paths.has(folded(known[name])));
  for (const [line, column] of places) {
    const before = (place: Place | null): number =>
      place && isThere[place[0]] && place[1] === line && place[2] <= column ? place[2] : 0;
    const elements = written(scene, before);
    if (elements.length) {
      return elements.find((each) => each.kind === selected?.kind && each.index === selected.index) ?? elements[0];
    }
  }
  return null;
}

/** Windows has two ways to write the letter of a drive. */
const folded = (path: string): string => path.replace(/^[A-Z]:/, (drive) => drive.toLowerCase()).replaceAll("\\", "/");

function written(scene: Scene, before: (place: Place | null) => number): Element[] {
  const { of, parts } = scene.origins;
  let own: Element[] = [];
  let nearest = 0;
  const ofPart: Element[] = [];
  const changed: Element[] = [];
  const taken = new Set<number>();
  for (const [kind, origins] of Object.entries(of)) {
    origins.forEach((origin, index) => {
      if (!origin) {
        return;
      }
      const [place, part, , changes] = origin;
      const at = before(place);
      if (at > nearest) {
        own = [];
        nearest = at;
      }
      if (at && at === nearest) {
        own.push({ kind, index });
      }
      if (part >= 0 && !taken.has(part) && before(parts[part][1])) {
        taken.add(part);
        ofPart.push({ kind, index });
      }
      if (changes.some((each) => before(each[4]))) {
        changed.push({ kind, index });
      }
    });
  }
  return [own, ofPart].find((elements) => elements.length) ?? changed;
}
