// What only VS Code itself can show: languages, faults, completion, commands and the page beside the text.
import assert from "node:assert/strict";
import * as vscode from "vscode";

const WAIT = 60_000;

const tests: Record<string, () => Promise<void>> = {
  async "a YAML file with `recipe:` at the top is a recipe"() {
    const editor = await opened("demo.yaml");
    await until(() => editor.document.languageId === "mjcompose-recipe");
    assert.equal(
      (await vscode.workspace.openTextDocument({ language: "yaml", content: "name: x\n" })).languageId,
      "yaml",
    );
  },

  async "the server reports faults of what is typed, and completes names"() {
    const editor = await opened("demo.yaml");
    const { document } = editor;
    const at = document.positionAt(
      document.getText().indexOf("site: arm/attachment_site") + "site: arm/attachment_sit".length,
    );
    await editor.edit((edit) => edit.delete(new vscode.Range(at, at.translate(0, 1))));
    await until(() => vscode.languages.getDiagnostics(document.uri).length > 0);
    assert.equal(vscode.languages.getDiagnostics(document.uri)[0].range.start.line, at.line);
    const { items } = await vscode.commands.executeCommand<vscode.CompletionList>(
      "vscode.executeCompletionItemProvider",
      document.uri,
      at,
    );
    assert.ok(
      items.some((each) => label(each) === "arm/attachment_site"),
      items.map(label).join(" "),
    );
    await vscode.commands.executeCommand("undo");
    await until(() => vscode.languages.getDiagnostics(document.uri).length === 0);
  },

  async "the commands above the recipe are those of the extension"() {
    const { document } = await opened("demo.yaml");
    const lenses = await vscode.commands.executeCommand<vscode.CodeLens[]>(
      "vscode.executeCodeLensProvider",
      document.uri,
      3,
    );
    assert.deepEqual(
      lenses.map((each) => each.command?.command),
      ["mjcompose.view", "mjcompose.build", "mjcompose.check"],
    );
    const { command, arguments: args } = lenses[0].command!;
    await vscode.commands.executeCommand(command, ...args!);
    await until(() => tabs().some((each) => each.label === "demo" && each.input instanceof vscode.TabInputWebview));
    await vscode.window.tabGroups.close(tabs().filter((each) => each.input instanceof vscode.TabInputWebview));
  },

  async "a check runs as a task"() {
    const { document } = await opened("demo.yaml");
    const ended = new Promise<number | undefined>((done) =>
      vscode.tasks.onDidEndTaskProcess(({ exitCode }) => done(exitCode)),
    );
    await vscode.commands.executeCommand("mjcompose.check", document.uri);
    assert.equal(await ended, 0);
  },

  async "the server starts again"() {
    const { document } = await opened("demo.yaml");
    await vscode.commands.executeCommand("mjcompose.restart");
    const symbols = await vscode.commands.executeCommand<vscode.DocumentSymbol[]>(
      "vscode.executeDocumentSymbolProvider",
      document.uri,
    );
    assert.ok(symbols.some((each) => each.name === "attach"));
  },
};

export async function run(): Promise<void> {
  const failed: string[] = [];
  for (const [name, test] of Object.entries(tests)) {
    try {
      await test();
      console.log(`ok: ${name}`);
    } catch (error) {
      failed.push(name);
      console.log(`not ok: ${name}\n${error instanceof Error ? error.stack : error}`);
    }
  }
  console.log(`suite: ${failed.length} failed of ${Object.keys(tests).length}`);
  if (failed.length) {
    throw new Error(failed.join(", "));
  }
}

const label = (item: vscode.CompletionItem): string => (typeof item.label === "string" ? item.label : item.label.label);
const tabs = (): vscode.Tab[] => vscode.window.tabGroups.all.flatMap((each) => each.tabs);

async function opened(name: string): Promise<vscode.TextEditor> {
  const uri = vscode.Uri.joinPath(vscode.workspace.workspaceFolders![0].uri, name);
  const editor = await vscode.window.showTextDocument(uri, { viewColumn: vscode.ViewColumn.One });
  await until(() => editor.document.languageId === "mjcompose-recipe");
  return editor;
}

async function until(holds: () => boolean): Promise<void> {
  for (const start = Date.now(); !holds(); await new Promise((done) => setTimeout(done, 50))) {
    if (Date.now() - start > WAIT) {
      throw new Error(`still not: ${holds}`);
    }
  }
}
