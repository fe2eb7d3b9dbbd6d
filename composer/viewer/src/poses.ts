// The poses that a model has by name: its reference and its keyframes, in a menu, as buttons, and as ghosts.
import type { Scene } from "./data";
import { h, icon } from "./dom";
import { Ghosts } from "./extras";
import type { World } from "./world";

export class Poses {
  /** The keyframe that was chosen last, -1 for the reference. */
  key = -1;
  /** The keyframe whose pose is shown, -1 for the reference; null for any other pose. */
  at: number | null = -1;
  ghosts!: Ghosts;
  readonly menu: HTMLSelectElement;
  readonly buttons = h("div", { className: "keys" });
  private scene!: Scene;

  constructor(
    private readonly choose: (key: number) => void,
    private readonly changed: () => void,
  ) {
    this.menu = h("select", {
      ariaLabel: "keyframe",
      title: "keyframe",
      onchange: () => choose(Number(this.menu.value)),
    });
  }

  use(world: World): void {
    this.scene = world.model.scene;
    this.ghosts = new Ghosts(world);
    world.root.add(this.ghosts.root);
  }

  /** The pose has left its keyframe. */
  stray(): void {
    if (this.at !== null) {
      this.at = null;
      this.show();
    }
  }

  set(key: number): void {
    this.key = key;
    this.at = key;
    this.show();
  }

  private called(key: number): string {
    return key < 0 ? "reference" : this.scene.key.name[key] || `key#${key}`;
  }

  show(): void {
    const { name } = this.scene.key;
    const option = (value: number, words: string) => h("option", { value: String(value) }, words);
    this.menu.replaceChildren(option(-1, "reference pose"), ...name.map((_, key) => option(key, this.called(key))));
    if (this.at === null) {
      this.menu.append(h("option", { value: "", disabled: true }, `${this.called(this.key)}, moved`));
    }
    this.menu.value = this.at === null ? "" : String(this.at);
    this.buttons.replaceChildren(...[-1, ...name.keys()].map((key) => this.button(key)));
  }

  private button(key: number): HTMLElement {
    const words = `show a ghost at ${this.called(key)}`;
    const ghost = h(
      "button",
      {
        className: "ghost",
        title: words,
        ariaLabel: words,
        ariaPressed: String(this.ghosts.has(key)),
        onclick: () => {
          this.ghosts.flip(key);
          this.show();
          this.changed();
        },
      },
      icon("ghost"),
    );
    if (this.ghosts.has(key)) {
      ghost.style.color = this.ghosts.color(key);
    }
    return h(
      "span",
      { className: key === this.at ? "chip on" : "chip" },
      h("button", { onclick: () => this.choose(key) }, this.called(key)),
      ghost,
    );
  }
}
