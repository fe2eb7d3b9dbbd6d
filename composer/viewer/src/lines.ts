// Which element the lines around a cursor mean.
import type { Element, Place, Scene } from "./data";

/**
 * The element that is written at the first of `places` that has one: an element's own line, then the entry of a part,
 * which means its first body, then what changed an element. Null where nothing is written at any of them. The
 * selected element stays if it is written there, too: a file that is used twice writes several elements.
 */
export function elementAt(scene: Scene, files: string[], places: [line: number, column: number][], selected: Element | null): Element | null {
  const paths = new Set(files.map(folded)), known = scene.editor?.files ?? {};
  const isThere = scene.origins.files.map((name) => known[name] !== undefined && paths.has(folded(known[name])));
  for (const [line, column] of places) {
    const before = (place: Place | null): number => (place && isThere[place[0]] && place[1] === line && place[2] <= column ? place[2] : 0);
    const found = written(scene, before);
    if (found.length) return found.find((each) => each.kind === selected?.kind && each.index === selected.index) ?? found[0];
  }
  return null;
}

/** Windows has two ways to write the letter of a drive. */
const folded = (path: string): string => path.replace(/^[A-Z]:/, (drive) => drive.toLowerCase()).replaceAll("\\", "/");

function written(scene: Scene, before: (place: Place | null) => number): Element[] {
  const { of, parts } = scene.origins;
  let own: Element[] = [], nearest = 0;
  const ofPart: Element[] = [], changed: Element[] = [], taken = new Set<number>();
  for (const [kind, origins] of Object.entries(of)) {
    origins.forEach((origin, index) => {
      if (!origin) return;
      const [place, part, , changes] = origin, at = before(place);
      if (at > nearest) [own, nearest] = [[], at];
      if (at && at === nearest) own.push({ kind, index });
      if (part >= 0 && !taken.has(part) && before(parts[part][1])) {
        taken.add(part);
        ofPart.push({ kind, index });
      }
      if (changes.some((each) => before(each[4]))) changed.push({ kind, index });
    });
  }
  return own.length ? own : ofPart.length ? ofPart : changed;
}
