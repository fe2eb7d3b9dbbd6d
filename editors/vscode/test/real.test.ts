// The real `mjcompose`, as the extension starts it: the server with a plain client, and the view.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { cp, mkdtemp, readFile, realpath, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import {
  createProtocolConnection,
  type ProtocolConnection,
  StreamMessageReader,
  StreamMessageWriter,
} from "vscode-languageserver-protocol/node";
import type { Candidate } from "../src/command";
import { find } from "../src/find";
import { SELECTOR, serverWords } from "../src/options";
import { LANGUAGE } from "../src/recipes";
import { Service } from "../src/service";
import { write } from "../src/writing";

const ROOT = resolve("../..");
const RECIPES = join(ROOT, "recipes");
const setting: string[] = JSON.parse(process.env.MJCOMPOSE_COMMAND ?? "[]");

let command: string[] = [];
let skipped: string | false = false;
let folder = "";

before(async () => {
  const { found, tried } = await find({ setting, folders: [ROOT], windows: process.platform === "win32" });
  if (found) {
    command = found.words;
  } else {
    skipped = `no mjcompose: ${tried.map((each: Candidate) => each.words.join(" ")).join(", ")}`;
  }
  folder = await mkdtemp(join(tmpdir(), "mjcompose-"));
  await cp(RECIPES, folder, { recursive: true });
});

after(() => rm(folder, { recursive: true, force: true }));

/** A client as VS Code's: it opens a text with the language that the selector asks for. */
async function client(
  act: (connection: ProtocolConnection, open: (name: string, text: string) => Promise<string>) => Promise<void>,
): Promise<void> {
  const [program, ...words] = serverWords(command);
  const child = spawn(program, words, { cwd: folder, stdio: ["pipe", "pipe", "inherit"] });
  const connection = createProtocolConnection(
    new StreamMessageReader(child.stdout),
    new StreamMessageWriter(child.stdin),
  );
  connection.listen();
  const ended = new Promise<number | null>((done) => child.on("exit", done));
  try {
    const uri = pathToFileURL(folder).href;
    const { capabilities } = (await connection.sendRequest("initialize", {
      processId: process.pid,
      rootUri: uri,
      workspaceFolders: [{ uri, name: "recipes" }],
      capabilities: {},
    })) as any;
    assert.ok(capabilities.completionProvider && capabilities.textDocumentSync);
    await connection.sendNotification("initialized", {});
    await act(connection, async (name, text) => {
      const address = pathToFileURL(join(folder, name)).href;
      assert.ok(SELECTOR.some((each) => "language" in each && each.language === LANGUAGE));
      await connection.sendNotification("textDocument/didOpen", {
        textDocument: { uri: address, languageId: LANGUAGE, version: 1, text },
      });
      return address;
    });
    await connection.sendRequest("shutdown");
    await connection.sendNotification("exit");
    assert.equal(await ended, 0);
  } finally {
    child.kill();
    connection.dispose();
  }
}

test("the server reports a fault of an unsaved text, and what completes it", { timeout: 120_000 }, async (context) => {
  if (skipped) {
    return context.skip(skipped);
  }
  const text = (await readFile(join(folder, "demo.yaml"), "utf8")).replace(
    "site: arm/attachment_site\n",
    "site: arm/attachment_sit\n",
  );
  await client(async (connection, open) => {
    const reported = new Promise<any>((done) =>
      connection.onNotification(
        "textDocument/publishDiagnostics",
        (params: any) => params.diagnostics.length && done(params),
      ),
    );
    const uri = await open("demo.yaml", text);
    const { uri: of, diagnostics } = await reported;
    const line = text.split("\n").findIndex((each) => each.endsWith("attachment_sit"));
    assert.equal(of, uri);
    assert.deepEqual([diagnostics[0].range.start.line, diagnostics[0].range.start.character], [line, 10]);
    const answer = (await connection.sendRequest("textDocument/completion", {
      textDocument: { uri },
      position: { line, character: 14 },
    })) as any;
    const labels = (Array.isArray(answer) ? answer : answer.items).map((each: any) => each.label);
    assert.ok(labels.includes("arm/attachment_site"), labels.join(" "));
  });
});

test("what the page moves is changed in the editor's own text", { timeout: 120_000 }, async (context) => {
  if (skipped) {
    return context.skip(skipped);
  }
  const file = join(await realpath(folder), "moved.yaml");
  const text = "recipe: 1\nattach:\n  cube: {model: ./models/props/cube.xml, pos: [0, 0, 1]}  # mine\n";
  await writeFile(file, text);
  const service = await Service.start(
    [...command, "view", "moved.yaml", "--no-open"],
    folder,
    () => {},
    () => {},
  );
  try {
    await new Promise<void>((done) =>
      service.listen(
        ({ name }) => {
          if (name === "model") {
            done();
          }
        },
        () => {},
      ),
    );
    const { move } = JSON.parse((await service.get("model/0")).toString());
    const request = {
      kind: "place",
      version: move.version,
      at: ["moved.yaml", 3, 3],
      pos: [0, 0.5, 1],
      quat: [1, 0, 0, 0],
    };
    const edits: unknown[] = [];
    const answer = await write(
      request,
      [{ path: file, text: `# unsaved\n${text}` }],
      (path, data) => service.ask(path, data),
      async (...each) => {
        edits.push(each);
        return true;
      },
    );
    assert.deepEqual(edits, [[{ file, range: [3, 51, 3, 51], text: ".5" }, false]], JSON.stringify(answer));
    assert.equal(await readFile(file, "utf8"), text);
  } finally {
    service.close();
  }
});

test("the view serves its page, builds what is saved, and ends", { timeout: 120_000 }, async (context) => {
  if (skipped) {
    return context.skip(skipped);
  }
  let over = () => {};
  const ended = new Promise<void>((done) => {
    over = done;
  });
  const service = await Service.start([...command, "view", "demo.yaml", "--no-open"], folder, over, () => {});
  try {
    assert.ok((await service.get("page.js")).includes("mjcomposeHost"));
    const versions: number[] = [];
    await new Promise<void>((done, failed) =>
      service.listen(
        ({ name, data }) => {
          if (name !== "model") {
            return;
          }
          versions.push((data as { version: number }).version);
          if (versions.length === 1) {
            void writeFile(join(folder, "demo.yaml"), "recipe: 1\nname: demo\nbase: ./models/table/table.xml\n");
          } else {
            done();
          }
        },
        () => failed(new Error("lost")),
      ),
    );
    const scene = JSON.parse((await service.get(`model/${versions.at(-1)}`)).toString());
    assert.equal(versions.length, 2);
    assert.ok(Object.values<string>(scene.editor.files).every((path) => existsSync(path)));
  } finally {
    service.close();
  }
  await ended;
});
