// The keys of the page, and the dialog that lists them.
import type { App } from "./app";
import { h } from "./dom";

/** A key and its action. `control` keys need Ctrl or Cmd. */
interface Command {
  keys: string[];
  shown: string;
  words: string;
  act: (app: App, event: KeyboardEvent) => void;
  control?: boolean;
}

const COMMANDS: Command[] = [
  { keys: ["f"], shown: "F", words: "fit the selection, or the whole", act: (app) => app.fit() },
  {
    keys: [..."012345"],
    shown: "0 … 5",
    words: "geom groups",
    act: (app, { key }) => app.visible.flipGroup(Number(key)),
  },
  { keys: ["c"], shown: "C", words: "collision shapes only", act: (app) => app.visible.flipCollision() },
  {
    keys: ["h"],
    shown: "H",
    words: "hide the selection; with nothing selected, show everything",
    act: (app, { shiftKey }) => (shiftKey ? app.visible.bodies.isolate(app.selected) : app.hideSelected()),
  },
  { keys: [], shown: "Shift H", words: "hide everything else, or show everything", act: () => {} },
  { keys: [], shown: "Shift + click", words: "select one more, or one less", act: () => {} },
  { keys: ["j"], shown: "J", words: "joint axes", act: (app) => app.visible.flipMark("axes") },
  { keys: ["i"], shown: "I", words: "inertia boxes", act: (app) => app.visible.flipMark("inertia") },
  { keys: ["b"], shown: "B", words: "body frames", act: (app) => app.visible.flipMark("frames") },
  { keys: ["s"], shown: "S", words: "sites", act: (app) => app.visible.flipSites() },
  { keys: ["g"], shown: "G", words: "grid", act: (app) => app.visible.flipMark("grid") },
  {
    keys: ["n"],
    shown: "N",
    words: "names of bodies, of joints, of sites, none",
    act: (app) => app.visible.nextNames(),
  },
  { keys: ["o"], shown: "O", words: "contact forces", act: (app) => app.visible.flipMark("forces") },
  { keys: ["r"], shown: "R", words: "reference pose", act: (app) => app.setKey(-1) },
  { keys: ["k"], shown: "K", words: "copy the pose as a keyframe", act: (app) => void app.sliders.copyPose() },
  { keys: [" "], shown: "Space", words: "run or pause the physics", act: (app) => app.server?.play() },
  { keys: ["."], shown: ".", words: "one step of the physics", act: (app) => app.server?.step() },
  { keys: [","], shown: ",", words: "back a little, over the last 10 seconds", act: (app) => app.time.back() },
  { keys: ["backspace"], shown: "Backspace", words: "reset the physics to time 0", act: (app) => app.reset() },
  { keys: [], shown: "Ctrl + drag", words: "pull a body while physics run", act: () => {} },
  {
    keys: ["m"],
    shown: "M",
    words: "move or turn, where a server can change the recipe",
    act: (app) => app.gizmo?.cycle(),
  },
  {
    keys: ["z"],
    shown: "Ctrl Z",
    words: "undo a change of the recipe",
    control: true,
    act: (app, { shiftKey }) => void app.gizmo?.back(shiftKey ? "redo" : "undo"),
  },
  {
    keys: ["y"],
    shown: "Ctrl Y",
    words: "redo it; also Ctrl Shift Z",
    control: true,
    act: (app) => void app.gizmo?.back("redo"),
  },
  { keys: ["d"], shown: "D", words: "measure a distance", act: (app) => app.ruler.flip() },
  { keys: ["p"], shown: "P", words: "copy the picture", act: (app) => app.copyPicture() },
  { keys: ["l"], shown: "L", words: "light or dark", act: (app) => app.flipTheme() },
  {
    keys: ["x"],
    shown: "X",
    words: "before or after, where two models are compared",
    act: (app) => app.flipCompared(),
  },
  { keys: ["/"], shown: "/", words: "search", act: (app) => app.frame.searchBox.focus() },
  { keys: ["?"], shown: "?", words: "this list", act: (app) => help(app) },
  {
    keys: ["escape"],
    shown: "Esc",
    words: "close the ruler or the message, then select nothing",
    act: (app) => app.leave(),
  },
];

/** A field that takes text keeps its keys, except Escape. */
const TEXT = "input:not([type=range]):not([type=checkbox]), textarea, select";

export function listen(app: App): void {
  addEventListener("keydown", (event) => {
    const field = event.target as HTMLElement;
    const isControl = event.ctrlKey || event.metaKey;
    if (event.altKey || document.querySelector("dialog[open]")) {
      return;
    }
    if (field.matches(TEXT)) {
      if (event.key === "Escape") {
        field.blur();
      }
      // A menu has no text of its own to undo.
      if (!isControl || !field.matches("select")) {
        return;
      }
    }
    const key = event.key.toLowerCase();
    const command = COMMANDS.find(({ keys, control = false }) => keys.includes(key) && control === isControl);
    if (!command || (isControl && !app.gizmo)) {
      return;
    }
    event.preventDefault();
    command.act(app, event);
  });
}

export function help(app: App): void {
  const dialog = h(
    "dialog",
    { className: "help", onclose: () => dialog.remove() },
    h("h2", {}, "Keys"),
    h("dl", {}, ...COMMANDS.flatMap(({ shown, words }) => [h("dt", {}, h("kbd", {}, shown)), h("dd", {}, words)])),
    h(
      "p",
      { className: "hint" },
      "Drag to turn, right button or two fingers to move, wheel to come nearer. Made with ",
      app.world.model.scene.made,
      " and three.js (MIT).",
    ),
    h("button", { onclick: () => dialog.close() }, "Close"),
  );
  document.body.append(dialog);
  dialog.showModal();
}
