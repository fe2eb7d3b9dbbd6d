// Where mjcompose may be, in the order in which it is looked for.
import * as path from "node:path";

/** The words of a command, and where they come from, for messages. */
export interface Candidate {
  words: string[];
  from: string;
}

export interface Places {
  setting: string[];
  /** The interpreter that the Python extension has chosen. */
  interpreter?: string;
  folders: string[];
  windows: boolean;
}

/** The commands to try. With the setting there is no other, because your choice is not replaced. */
export function candidates({ setting, interpreter, folders, windows }: Places): Candidate[] {
  if (setting.length) {
    return [{ words: setting, from: "the setting mjcompose.command" }];
  }
  const at = windows ? path.win32 : path.posix;
  const program = windows ? at.join("Scripts", "mjcompose.exe") : at.join("bin", "mjcompose");
  const places: Candidate[] = [];
  // -P: a folder called `mjcompose` in the workspace is not the package.
  if (interpreter) {
    places.push({ words: [interpreter, "-P", "-m", "mjcompose"], from: `Python ${interpreter}` });
  }
  for (const folder of folders) {
    for (const name of [".venv", "venv"]) {
      places.push({ words: [at.join(folder, name, program)], from: at.join(folder, name) });
    }
  }
  places.push({ words: ["mjcompose"], from: "the PATH" });
  return places;
}

export const INSTALL = 'python -m pip install "mjcompose[lsp]"';

/** What to say where none of the candidates is mjcompose. */
export function missing(tried: Candidate[], interpreter?: string): { message: string; run: string } {
  const from = tried.map((each) => each.from).join(", ");
  if (tried.length === 1 && tried[0].words[0] !== "mjcompose") {
    return { message: `${from} does not start mjcompose: ${tried[0].words.join(" ")}`, run: INSTALL };
  }
  const run = interpreter ? `${quoted(interpreter)} -m pip install "mjcompose[lsp]"` : INSTALL;
  return { message: `mjcompose was not found (${from}). Install it with: ${run}`, run };
}

const quoted = (word: string): string => (/[^\w./\\:-]/.test(word) ? `"${word}"` : word);

/** The version that `mjcompose --version` prints; null for the words of another program. */
export function versionIn(output: string): string | null {
  return /^mjcompose, version (\S+)/m.exec(output)?.[1] ?? null;
}

/** The standard error of a server that ended at once, as a line to show. */
export function reason(output: string): string {
  const lines = output.trim().split(/\r?\n/);
  return (lines.find((each) => /^Error: /.test(each))?.slice(7) ?? lines.at(-1) ?? "").trim();
}
