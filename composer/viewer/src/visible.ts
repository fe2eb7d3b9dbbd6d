// The parts of the model that the page draws: groups, kinds of things, and marks; the panel *Show*.
import { Bodies } from "./bodies";
import { check, h } from "./dom";
import { EXTRAS, type Extra, Extras, gridStep } from "./extras";
import { type Labels, NAMED, type Named } from "./labels";
import type { World } from "./world";

const NAME_WORDS: Record<Named, string> = { body: "bodies", joint: "joints", site: "sites", contact: "contacts" };

const EXTRA_WORDS: Record<Extra, string> = {
  frames: "body frames",
  axes: "joint axes",
  inertia: "inertia boxes",
  ellipsoids: "inertia ellipsoids",
  mass: "centers of mass",
  hulls: "convex hulls that collide",
  contacts: "contacts",
  forces: "contact forces",
  cameras: "cameras",
  grid: "grid",
};

export class Visible {
  readonly panel = h("div", { className: "show" });
  extras: Extras | null = null;
  readonly contactCount = h("span", {});
  labels!: Labels;
  readonly bodies: Bodies;
  private world!: World;
  private isCollision = false;
  private readonly groups = [true, true, true, false, false, false];
  private readonly softs: Record<string, boolean> = { site: true, tendon: true, skin: true, flex: true };
  private readonly marks = new Set<Extra>();

  constructor(private readonly changed: () => void) {
    this.bodies = new Bodies(changed);
  }

  use(world: World): void {
    this.world = world;
    this.extras = new Extras(world);
    world.root.add(this.extras.root);
    for (const mark of this.marks) {
      this.extras.set(mark, true);
    }
    this.bodies.use(world);
    this.apply();
  }

  flipGroup(group: number): void {
    this.groups[group] = !this.groups[group];
    this.apply();
  }

  flipCollision(): void {
    this.isCollision = !this.isCollision;
    this.apply();
  }

  flipSites(): void {
    this.softs.site = !this.softs.site;
    this.apply();
  }

  flipMark(mark: Extra): void {
    this.setMark(mark, !this.marks.has(mark));
    this.fill();
  }

  /** The names of bodies, then of joints, then of sites, then none. */
  nextNames(): void {
    const order: (Named | null)[] = [null, "body", "joint", "site"];
    const now = order.findIndex((kind) => kind !== null && this.labels.shown.has(kind));
    const next = order[(Math.max(now, 0) + 1) % order.length];
    for (const kind of NAMED) {
      this.labels.set(kind, kind === next);
    }
    this.fill();
    this.changed();
  }

  private setMark(mark: Extra, on: boolean): void {
    if (on) {
      this.marks.add(mark);
    } else {
      this.marks.delete(mark);
    }
    this.extras?.set(mark, on);
    this.changed();
  }

  private apply(): void {
    this.world.show((kind, group, collides) => {
      if (kind === "site") {
        return this.softs.site && group < 3;
      }
      return this.isCollision ? collides : this.groups[group];
    });
    for (const kind of ["tendon", "skin", "flex"]) {
      this.world.softs.show(kind, (group) => this.softs[kind] && !this.isCollision && group < 3);
    }
    this.world.softs.update();
    this.fill();
    this.changed();
  }

  private check(words: string, on: boolean, set: (on: boolean) => void, more: string | Node = ""): HTMLElement {
    return check(words, on, set, h("span", { className: "more" }, more));
  }

  private fill(): void {
    const { scene } = this.world.model;
    const groups = this.groups.flatMap((on, group) => {
      const count = scene.geom.group.filter((each: number) => each === group).length;
      return count ? [this.check(`group ${group}`, on, () => this.flipGroup(group), `${count} geoms`)] : [];
    });
    const softs = Object.entries(this.softs).flatMap(([kind, on]) => {
      const count =
        kind === "site" || kind === "tendon" ? (scene as any)[kind].name.length : (scene as any)[kind].length;
      const flip = () => {
        this.softs[kind] = !on;
        this.apply();
      };
      return count ? [this.check(`${kind}s`, on, flip, String(count))] : [];
    });
    const details: Partial<Record<Extra, Node | string>> = {
      contacts: this.contactCount,
      grid: `${gridStep(scene.look.extent)} m`,
    };
    this.panel.replaceChildren(
      h("h3", {}, "Geoms"),
      ...groups,
      this.check("collision shapes only", this.isCollision, () => this.flipCollision()),
      this.bodies.panel,
      ...(softs.length ? [h("h3", {}, "More of the model"), ...softs] : []),
      h("h3", {}, "Marks"),
      ...EXTRAS.map((mark) =>
        this.check(EXTRA_WORDS[mark], this.marks.has(mark), (on) => this.setMark(mark, on), details[mark] ?? ""),
      ),
      h("h3", {}, "Names"),
      ...NAMED.map((kind) =>
        this.check(`names of ${NAME_WORDS[kind]}`, this.labels.shown.has(kind), (on) => {
          this.labels.set(kind, on);
          this.changed();
        }),
      ),
    );
  }
}
