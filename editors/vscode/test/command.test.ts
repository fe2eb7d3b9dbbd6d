import assert from "node:assert/strict";
import { test } from "node:test";
import { candidates, missing, reason, versionIn } from "../src/command";

const NOTHING = { setting: [], folders: [], windows: false };

test("the setting is the only candidate", () => {
  const commands = candidates({
    ...NOTHING,
    setting: ["uv", "run", "mjcompose"],
    interpreter: "/usr/bin/python3",
    folders: ["/lab"],
  });
  assert.deepEqual(
    commands.map((each) => each.words),
    [["uv", "run", "mjcompose"]],
  );
});

test("the interpreter comes first, then the folders' environments, then the PATH", () => {
  const commands = candidates({ ...NOTHING, interpreter: "/env/bin/python", folders: ["/lab"] });
  assert.deepEqual(
    commands.map((each) => each.words),
    [
      ["/env/bin/python", "-P", "-m", "mjcompose"],
      ["/lab/.venv/bin/mjcompose"],
      ["/lab/venv/bin/mjcompose"],
      ["mjcompose"],
    ],
  );
  assert.deepEqual(candidates({ ...NOTHING, folders: ["C:\\lab"], windows: true })[0].words, [
    "C:\\lab\\.venv\\Scripts\\mjcompose.exe",
  ]);
});

test("what is missing is said with the command that installs it", () => {
  const { message, run } = missing(candidates({ ...NOTHING, interpreter: "/my env/python" }), "/my env/python");
  assert.equal(run, '"/my env/python" -m pip install "mjcompose[lsp]"');
  assert.match(message, /not found \(Python \/my env\/python, the PATH\)\. Install it with: /);
  assert.match(
    missing(candidates({ ...NOTHING, setting: ["nope"] })).message,
    /the setting mjcompose\.command does not start mjcompose: nope/,
  );
  assert.equal(missing(candidates(NOTHING)).run, 'python -m pip install "mjcompose[lsp]"');
});

test("only mjcompose has its version", () => {
  assert.equal(versionIn("mjcompose, version 0.1.0\n"), "0.1.0");
  assert.equal(versionIn("Python 3.12.1\n"), null);
});

test("of what the command says the error is shown", () => {
  assert.equal(
    reason("Usage: mjcompose lsp [OPTIONS]\n\nError: The language server needs `pygls`.\n"),
    "The language server needs `pygls`.",
  );
  assert.equal(reason("a\nb\n"), "b");
  assert.equal(reason(""), "");
});
