// Messages over the picture: the faults of the model in the words of the terminal, and why the physics stopped.
import { h } from "./dom";
import { host } from "./wire";

/** The lines of a diagnostic, by the class of their color. */
const LINES: [string, RegExp][] = [
  ["error", /(^|: )error\[/],
  ["warning", /(^|: )warning\[/],
  ["help", /^ *= help/],
  ["source", /^ *\d* *\|/],
];

/** One diagnostic. Its text begins with its place, which `href` opens; `fix` is the name of its fix. */
export interface FaultRow {
  text: string;
  place: string;
  path?: string;
  line?: number;
  column?: number;
  href?: string;
  fix: string | null;
}

function lineOf(line: string, more: (Node | null)[] = []): HTMLElement {
  const hang = line.length - line.trimStart().length + (/^ *= /.test(line) ? 2 : 0);
  return h(
    "span",
    { style: `--hang:${hang}ch`, className: LINES.find(([, pattern]) => pattern.test(line))?.[0] ?? "" },
    ...more,
    more.length ? null : line || "\u200b",
  );
}

function shown(text: string): HTMLElement[] {
  return text
    .trimEnd()
    .split("\n")
    .map((line) => lineOf(line));
}

/** The place of a diagnostic, as a link to the editor. */
function placeOf({ place, path, line, column, href }: FaultRow): HTMLElement {
  const link = h("a", { className: "place", href: href ?? "#", title: "open in the editor" }, place);
  if (host && path) {
    link.addEventListener("click", (event) => {
      event.preventDefault();
      host!.open(path, line ?? 1, column ?? 1);
    });
  }
  return link;
}

export class Banner {
  readonly root = h("div", { className: "fault", hidden: true, role: "alert" });
  /** Stays as long as the server does not answer: nothing on the page is new then. */
  readonly lost = h(
    "div",
    { className: "lost", hidden: true, role: "status" },
    "The server does not answer, so this page shows nothing new. Start `mjcompose view` again, and open its address.",
  );

  /** Carries out the fix of a diagnostic; only a page that may write has one. */
  fix: ((row: FaultRow) => void) | null = null;

  /** A fault; null takes it away. `more` names the model that the page shows instead. */
  setFault(text: string | null, more: string, rows: FaultRow[] = []): void {
    this.set(text, "The model has a fault", more, rows);
  }

  /** Why the physics cannot go on, below `head`; null takes it away. */
  setStopped(text: string | null, head = "The simulation has stopped"): void {
    if (text !== null || this.root.classList.contains("stopped")) {
      this.set(text, head, "");
    }
    this.root.classList.toggle("stopped", text !== null);
  }

  /** The warnings of MuJoCo at which the physics have paused. */
  setWarned(warnings: string[]): void {
    this.setStopped(warnings.join("\n"), "Paused at a warning of MuJoCo: run again to go on");
  }

  setLost(isLost: boolean): void {
    this.lost.hidden = !isLost;
  }

  /** Hide it, and tell whether it was there. */
  hide(): boolean {
    const isThere = !this.root.hidden;
    this.root.hidden = true;
    return isThere;
  }

  private row(row: FaultRow): HTMLElement[] {
    const [first, ...others] = row.text.trimEnd().split("\n");
    const head =
      row.path && first.startsWith(row.place)
        ? lineOf(first, [placeOf(row), document.createTextNode(first.slice(row.place.length))])
        : lineOf(first);
    const button =
      row.fix !== null && this.fix
        ? [h("button", { className: "small wide fix", onclick: () => this.fix?.(row) }, `Fix: ${row.fix}`)]
        : [];
    return [head, ...others.map((line) => lineOf(line)), ...button, lineOf("")];
  }

  private set(text: string | null, head: string, more: string, rows: FaultRow[] = []): void {
    this.root.classList.remove("stopped");
    this.root.hidden = text === null;
    if (text === null) {
      return;
    }
    this.root.replaceChildren(
      h(
        "header",
        {},
        h("b", {}, head),
        h("span", {}, more),
        h("button", { title: "hide (Esc)", ariaLabel: "hide", onclick: () => this.hide() }, "×"),
      ),
      h("pre", {}, ...(rows.length ? rows.flatMap((row) => this.row(row)) : shown(text))),
    );
  }
}
