// The numbers among the parameters of a recipe, as sliders: each change builds the model again.
import type { Parameter } from "./data";
import { colorTo, h, nameSpan } from "./dom";
import { neat } from "./info";
import { NumberBox } from "./numbers";

interface Row {
  parameter: Parameter;
  show: () => void;
}

export class Params {
  readonly panel = h("div", { className: "sliders" });
  private rows = new Map<string, Row>();

  constructor(
    private readonly choose: (name: string, value: number) => void,
    private readonly write: (name: string, value: number) => void,
  ) {}

  /** Show the parameters of a model. Rows that stay are not made again: somebody may hold a slider. */
  use(parameters: Parameter[], writes: boolean): void {
    const names = parameters.map(({ name }) => name);
    if (names.join() !== [...this.rows.keys()].join()) {
      this.rows = new Map();
      this.panel.replaceChildren(
        h("p", { className: "hint" }, "A change builds the model with this value; the recipe stays as it is."),
        ...parameters.map((parameter) => this.row(parameter, writes)),
      );
    }
    for (const parameter of parameters) {
      const row = this.rows.get(parameter.name)!;
      row.parameter = parameter;
      row.show();
    }
  }

  private row(first: Parameter, writes: boolean): HTMLElement {
    const { name, unit, doc } = first;
    const [low, high] = rangeOf(first);
    const step = first.whole ? "1" : "any";
    const range = h("input", { type: "range", min: String(low), max: String(high), step, ariaLabel: name });
    const own: Row = { parameter: first, show: () => {} };
    const change = (value: number) => {
      own.parameter = { ...own.parameter, value };
      own.show();
      this.choose(name, value);
    };
    const shown = () => neat(own.parameter.value, 6);
    const box = new NumberBox(`parameter ${name}, value`, "plain", shown, change);
    const button = h(
      "button",
      {
        className: "small wide",
        title: `make this the default of ${name} in the recipe`,
        onclick: () => this.write(name, own.parameter.value),
      },
      "Write",
    );
    own.show = () => {
      const { value, standard } = own.parameter;
      if (document.activeElement !== range) {
        range.value = String(value);
      }
      colorTo(range, value, [low, high]);
      box.show();
      button.hidden = !writes || value === standard;
    };
    range.addEventListener("input", () => change(Number(range.value)));
    this.rows.set(name, own);
    const ends = h(
      "span",
      { className: "ends" },
      h("span", {}, neat(low)),
      h("span", { className: "more" }, [unit, doc].filter(Boolean).join(", ")),
      h("span", {}, neat(high)),
    );
    return h("div", { className: "slider" }, h("label", {}, nameSpan(name)), box.root, range, ends, button);
  }
}

/** The declared bounds; a missing one is as far from the default as the default is from zero. */
function rangeOf({ low, high, standard }: Parameter): [number, number] {
  const far = Math.abs(standard) || 1;
  return [low ?? Math.min(standard - far, high ?? Infinity), high ?? Math.max(standard + far, low ?? -Infinity)];
}
