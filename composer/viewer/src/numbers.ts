// Numbers as people write them, and the boxes that take them: `0.3`, `10cm`, `1/4`, `0.5rad + 3deg`.
import { h } from "./dom";

export type Quantity = "length" | "angle" | "plain";

/** Units by the quantity that they measure, in meters and radians. */
const UNITS: Record<Quantity, Record<string, number>> = {
  length: { m: 1, cm: 0.01, mm: 0.001, in: 0.0254 },
  angle: { rad: 1, deg: Math.PI / 180, "°": Math.PI / 180 },
  plain: {},
};
/** The unit of a number without one. */
const OWN: Record<Quantity, number> = { length: 1, angle: Math.PI / 180, plain: 1 };
const TOKEN = /\s*((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[a-zA-Z]+|[-+*/()°])/y;

/** A value, and whether a unit has been written for it. */
interface Part {
  value: number;
  isMeasured: boolean;
}

class Unreadable extends Error {}

/** Reads one text from left to right, as `a + b * (c - d)`. */
class Reader {
  private readonly tokens: string[] = [];
  private at = 0;

  constructor(
    text: string,
    private readonly quantity: Quantity,
  ) {
    const plain = text.replaceAll("−", "-").trim();
    TOKEN.lastIndex = 0;
    while (TOKEN.lastIndex < plain.length) {
      const token = TOKEN.exec(plain);
      if (!token) {
        throw new Unreadable();
      }
      this.tokens.push(token[1]);
    }
  }

  whole(): number {
    const part = this.sum();
    if (this.at < this.tokens.length || !Number.isFinite(part.value)) {
      throw new Unreadable();
    }
    return part.isMeasured ? part.value : part.value * OWN[this.quantity];
  }

  private takes(...some: string[]): string | null {
    return some.includes(this.tokens[this.at]) ? this.tokens[this.at++] : null;
  }

  private sum(): Part {
    let left = this.product();
    for (let sign = this.takes("+", "-"); sign; sign = this.takes("+", "-")) {
      const right = this.product();
      // `10cm + 1` could mean 1 cm or 1 m.
      if (left.isMeasured !== right.isMeasured) {
        throw new Unreadable();
      }
      left = { ...left, value: sign === "+" ? left.value + right.value : left.value - right.value };
    }
    return left;
  }

  private product(): Part {
    let left = this.factor();
    for (let sign = this.takes("*", "/"); sign; sign = this.takes("*", "/")) {
      const right = this.factor();
      if (right.isMeasured && (left.isMeasured || sign === "/")) {
        throw new Unreadable();
      }
      left = {
        value: sign === "*" ? left.value * right.value : left.value / right.value,
        isMeasured: left.isMeasured || right.isMeasured,
      };
    }
    return left;
  }

  private factor(): Part {
    const sign = this.takes("-", "+");
    if (sign) {
      const part = this.factor();
      return { ...part, value: sign === "-" ? -part.value : part.value };
    }
    if (this.takes("(")) {
      const part = this.sum();
      if (!this.takes(")")) {
        throw new Unreadable();
      }
      return part;
    }
    return this.number();
  }

  private number(): Part {
    const value = Number(this.tokens[this.at++] ?? "none");
    if (Number.isNaN(value)) {
      throw new Unreadable();
    }
    const next = this.tokens[this.at];
    if (next === undefined || !/^[a-zA-Z°]/.test(next)) {
      return { value, isMeasured: false };
    }
    const unit = Object.hasOwn(UNITS[this.quantity], next) ? UNITS[this.quantity][next] : Number.NaN;
    this.at++;
    if (Number.isNaN(unit)) {
      throw new Unreadable();
    }
    return { value: value * unit, isMeasured: true };
  }
}

/** The number that a text means, in meters or radians; null for a text that means none. A bare angle is in degrees. */
export function measured(text: string, quantity: Quantity): number | null {
  try {
    return new Reader(text, quantity).whole();
  } catch (error) {
    if (error instanceof Unreadable) {
      return null;
    }
    throw error;
  }
}

const EXAMPLES: Record<Quantity, string> = {
  length: "0.1, 10cm, 4in or 1/4",
  angle: "30, 30deg, 0.5rad or 90/4",
  plain: "0.1, 1e3 or 1/4",
};

/** A text field for a number. Any other text stays, in red, and changes nothing. */
export class NumberBox {
  readonly root: HTMLInputElement;

  constructor(
    label: string,
    private readonly quantity: Quantity,
    private readonly shown: () => string,
    private readonly take: (value: number) => void,
  ) {
    this.root = h("input", { type: "text", inputMode: "text", className: "number", ariaLabel: label });
    this.root.addEventListener("change", () => this.read());
    this.root.addEventListener("focus", () => this.root.select());
    this.root.addEventListener("keydown", (event) => {
      if (event.key === "Escape") {
        this.accept();
        this.root.value = this.shown();
      }
    });
    this.show();
  }

  /** Show the value as it is now, unless somebody types. */
  show(): void {
    if (document.activeElement !== this.root && this.root.ariaInvalid !== "true") {
      this.root.value = this.shown();
    }
  }

  private accept(): void {
    this.root.ariaInvalid = "false";
    this.root.title = "";
  }

  private read(): void {
    const value = measured(this.root.value, this.quantity);
    if (value === null) {
      this.root.ariaInvalid = "true";
      this.root.title = `not a number, so nothing has changed: write ${EXAMPLES[this.quantity]}`;
      return;
    }
    this.accept();
    this.root.blur();
    this.take(value);
    this.show();
  }
}
