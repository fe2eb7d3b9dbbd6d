// What is wrong, over the picture: the faults of the model in the words of the terminal, and why the physics stopped.
import { h } from "./dom";

/** The lines of a diagnostic, by the class of their color. */
const LINES: [string, RegExp][] = [
  ["error", /(^|: )error\[/],
  ["warning", /(^|: )warning\[/],
  ["help", /^ *= help/],
  ["source", /^ *\d* *\|/],
];

function shown(text: string): HTMLElement[] {
  const hang = (line: string) => line.length - line.trimStart().length + (/^ *= /.test(line) ? 2 : 0);
  return text
    .trimEnd()
    .split("\n")
    .map((line) =>
      h(
        "span",
        { style: `--hang:${hang(line)}ch`, className: LINES.find(([, pattern]) => pattern.test(line))?.[0] ?? "" },
        line || "\u200b",
      ),
    );
}

export class Banner {
  readonly root = h("div", { className: "fault", hidden: true, role: "alert" });
  /** Stays as long as the server does not answer: nothing on the page is new then. */
  readonly lost = h(
    "div",
    { className: "lost", hidden: true, role: "status" },
    "The server does not answer, so this page shows nothing new. Start `mjcompose view` again, and open its address.",
  );

  /** A fault; null takes it away. `more` says what the page shows instead. */
  setFault(text: string | null, more: string): void {
    this.set(text, "The model has a fault", more);
  }

  /** Why the physics cannot go on, or have paused; null takes it away. */
  setStopped(text: string | null, head = "The simulation has stopped"): void {
    if (text !== null || this.root.classList.contains("stopped")) {
      this.set(text, head, "");
    }
    this.root.classList.toggle("stopped", text !== null);
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

  private set(text: string | null, head: string, more: string): void {
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
      h("pre", {}, ...shown(text)),
    );
  }
}
