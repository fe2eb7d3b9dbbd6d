// The actions of the extension, and when it starts.
import * as vscode from "vscode";
import { onInterpreter } from "./interpreter";
import { Panels } from "./panel";
import { isModel, isRecipe, LANGUAGE, MOST_LINES_ABOVE } from "./recipes";
import { Server } from "./server";
import { runTask } from "./tasks";

const PAUSE = 150;
let server: Server | undefined;

export function activate(context: vscode.ExtensionContext): void {
  const panels = new Panels(context.asAbsolutePath("dist/bridge.js"));
  const acts: Record<string, (file: string, cell?: string) => Promise<void>> = {
    "mjcompose.view": (file, cell) => withCommand((command) => panels.open(command, file, cell)),
    "mjcompose.build": (file, cell) => withCommand((command) => runTask("build", command, file, cell)),
    "mjcompose.check": (file, cell) => withCommand((command) => runTask("check", command, file, cell)),
  };
  const run = async (command: string, [target, cell]: unknown[]): Promise<void> => {
    const file = await saved(target);
    if (file) {
      await acts[command](file, typeof cell === "string" && cell ? cell : undefined);
    }
  };
  server = new Server();
  context.subscriptions.push(
    panels,
    ...Object.keys(acts).map((name) => vscode.commands.registerCommand(name, (...args: unknown[]) => run(name, args))),
    vscode.commands.registerCommand("mjcompose.restart", () => server?.restart()),
    vscode.workspace.onDidOpenTextDocument((document) => void meet(document)),
    vscode.workspace.onDidChangeTextDocument(({ document, contentChanges }) => {
      if (contentChanges.some((each) => each.range.start.line <= MOST_LINES_ABOVE)) {
        void meet(document);
      }
    }),
    vscode.workspace.onDidChangeConfiguration((event) => {
      if (event.affectsConfiguration("mjcompose.command")) {
        void server?.restart();
      }
    }),
    vscode.window.onDidChangeActiveColorTheme(() => panels.retheme()),
    following(panels),
  );
  vscode.workspace.textDocuments.forEach((document) => void meet(document));
  void onInterpreter(() => void server?.restart()).then((each) => each && context.subscriptions.push(each));
}

export async function deactivate(): Promise<void> {
  await server?.dispose();
  server = undefined;
}

async function withCommand(act: (command: string[]) => void | Promise<void>): Promise<void> {
  const command = await server?.command();
  if (command) {
    await act(command.words);
  }
}

const changed = new Set<string>();

/**
 * A recipe gets its language, once: who chooses another one afterwards keeps it. The first recipe or MJCF model starts
 * the server.
 */
async function meet(document: vscode.TextDocument): Promise<void> {
  if (document.languageId === LANGUAGE || (document.languageId === "xml" && isModel(document.getText()))) {
    return server?.start();
  }
  const key = document.uri.toString();
  if (document.languageId !== "yaml" || !["file", "untitled"].includes(document.uri.scheme) || changed.has(key)) {
    return;
  }
  if (
    !vscode.workspace.getConfiguration("mjcompose", document).get("recognizeRecipes") ||
    !isRecipe(document.getText())
  ) {
    return;
  }
  changed.add(key);
  await vscode.languages.setTextDocumentLanguage(document, LANGUAGE);
}

function uriOf(target: unknown): vscode.Uri | undefined {
  if (target instanceof vscode.Uri) {
    return target;
  }
  if (typeof target !== "string" || !target) {
    return undefined;
  }
  return /^\w{2,}:/.test(target) ? vscode.Uri.parse(target) : vscode.Uri.file(target);
}

/**
 * The file of a command, from its argument, an address or a path, or from the editor. An unsaved text is saved first.
 */
async function saved(target: unknown): Promise<string | undefined> {
  const uri = uriOf(target) ?? vscode.window.activeTextEditor?.document.uri;
  const document = vscode.workspace.textDocuments.find((each) => each.uri.toString() === uri?.toString());
  if (!uri) {
    return void vscode.window.showInformationMessage("No recipe is open.");
  }
  const file = document?.isDirty || document?.isUntitled ? await vscode.workspace.save(uri) : uri;
  return file?.fsPath;
}

/** The cursor selects in the pages, as soon as it rests. */
function following(panels: Panels): vscode.Disposable {
  let due: NodeJS.Timeout | undefined;
  return vscode.window.onDidChangeTextEditorSelection(({ textEditor }) => {
    clearTimeout(due);
    due = setTimeout(() => {
      if (vscode.workspace.getConfiguration("mjcompose").get("followCursor")) {
        panels.follow(textEditor);
      }
    }, PAUSE);
  });
}
