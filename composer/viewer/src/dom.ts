// Elements of the page, made in one call.

type Child = Node | string | null | undefined | false;

export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  set: Record<string, any> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(set)) {
    if (name.startsWith("on")) {
      made.addEventListener(name.slice(2), value);
    } else if (name in made && name !== "list") {
      (made as any)[name] = value;
    } else if (value !== undefined && value !== null && value !== false) {
      made.setAttribute(name, String(value));
    }
  }
  made.append(...children.filter((each): each is Node | string => Boolean(each)));
  return made;
}

/** A box to check, with its words. */
export function check(words: string, on: boolean, set: (on: boolean) => void, ...more: Child[]): HTMLElement {
  const box = h("input", { type: "checkbox", checked: on, onchange: () => set(box.checked) });
  return h("label", { className: "check" }, box, h("span", {}, words), ...more);
}

/** Color a slider from its start to a value. */
export function colorTo(slider: HTMLInputElement, value: number, [low, high]: number[]): void {
  const share = (value - low) / (high - low || 1);
  slider.style.setProperty("--at", `${100 * Math.min(1, Math.max(0, share))}%`);
}

const LONG = 18;
const TAIL = 12;

/** A name that loses its middle where there is no room: names of a model mostly differ at their ends. */
export function nameSpan(name: string): HTMLElement {
  const pieces = name.length > LONG ? [name.slice(0, -TAIL), name.slice(-TAIL)] : [name];
  const classes = ["head", "tail"];
  return h("span", { className: "name" }, ...pieces.map((piece, k) => h("span", { className: classes[k] }, piece)));
}

const PATHS: Record<string, string> = {
  fit: "M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5",
  theme: "M12 3a9 9 0 1 0 9 9 7 7 0 0 1-9-9z",
  help: "M9.5 9a2.5 2.5 0 1 1 3.6 2.3c-.8.4-1.1 1-1.1 1.7M12 17h.01M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18z",
  tree: "M5 4v14h5M5 10h5M14 8h6v4h-6zM14 16h6v4h-6z",
  panel: "M4 6h10M18 6h2M4 12h2M10 12h10M4 18h8M16 18h4M14 4v4M6 10v4M12 16v4",
  play: "M7 4l13 8-13 8z",
  pause: "M8 5v14M16 5v14",
  reset: "M4 4v6h6M4.6 10A8 8 0 1 1 4 14",
  step: "M5 5l9 7-9 7zM18 5v14",
  move:
    "M12 3v18M3 12h18M12 3l-2.5 2.5M12 3l2.5 2.5M12 21l-2.5-2.5M12 21l2.5-2.5" +
    "M3 12l2.5-2.5M3 12l2.5 2.5M21 12l-2.5-2.5M21 12l-2.5 2.5",
  ruler: "M3 16L16 3l5 5L8 21zM7 12l2 2M10 9l3 3M13 6l2 2",
  camera: "M4 7h4l2-3h4l2 3h4v13H4zM12 16.5a3.5 3.5 0 1 0 0-7 3.5 3.5 0 0 0 0 7z",
  ghost: "M5 21V11a7 7 0 0 1 14 0v10l-3-2-2 2-2-2-2 2-2-2zM9.5 11h.01M14.5 11h.01",
  copy: "M9 9h11v11H9zM5 15H4V4h11v1",
};

export function icon(name: keyof typeof PATHS | string): SVGSVGElement {
  const space = "http://www.w3.org/2000/svg";
  const made = document.createElementNS(space, "svg");
  made.setAttribute("viewBox", "0 0 24 24");
  const path = document.createElementNS(space, "path");
  path.setAttribute("d", PATHS[name]);
  made.append(path);
  return made;
}

/** Put a text where it can be pasted from, and say so for a moment. */
export async function copy(text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = h("textarea", { value: text, style: "position:fixed;opacity:0" });
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  toast(`copied: ${text.length > 60 ? `${text.slice(0, 57)}…` : text}`);
}

let standing: HTMLElement | null = null;

export function toast(words: string): void {
  standing?.remove();
  const made = h("div", { className: "toast", role: "status" }, words.split("\n")[0]);
  document.body.append(made);
  standing = made;
  setTimeout(() => made.remove(), 2200);
}
