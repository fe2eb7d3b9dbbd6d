// The page of `mjcompose view` next to the editor.
import { randomBytes } from "node:crypto";
import { readFile, realpath } from "node:fs/promises";
import * as path from "node:path";
import * as vscode from "vscode";
import type { FromPage, ToPage } from "./messages";
import { page, words } from "./page";
import { Service } from "./service";
import { aroundInXml, aroundInYaml } from "./surroundings";
import { folderOf, named } from "./tasks";
import { write } from "./writing";

const CELL = "cell";
/** The program of the page looks for its editor by this name. */
const HOST = "mjcomposeHost";

export class Panels implements vscode.Disposable {
  private readonly panels = new Map<string, Panel>();

  constructor(private readonly bridge: string) {}

  /** Show a file, one panel for each; `cell` is a cell of its matrix or a sample. */
  open(command: string[], file: string, cell?: string): void {
    const standing = this.panels.get(file);
    if (standing) {
      standing.again(cell);
    } else {
      this.panels.set(file, new Panel(command, file, cell, this.bridge, () => this.panels.delete(file)));
    }
  }

  /** The cursor of an editor has moved. */
  follow(editor: vscode.TextEditor): void {
    for (const panel of this.panels.values()) {
      panel.follow(editor);
    }
  }

  retheme(): void {
    for (const panel of this.panels.values()) {
      panel.say({ kind: "theme", name: theme() });
    }
  }

  dispose(): void {
    for (const panel of [...this.panels.values()]) {
      panel.panel.dispose();
    }
  }
}

class Panel {
  readonly panel: vscode.WebviewPanel;
  private service: Service | undefined;
  private stop = () => {};
  private jumped: string | undefined;
  private ended = false;

  constructor(
    private readonly command: string[],
    private readonly file: string,
    private cell: string | undefined,
    private readonly bridge: string,
    gone: () => void,
  ) {
    const title = path.basename(file).replace(/(\.recipe)?\.\w+$/, "");
    this.panel = vscode.window.createWebviewPanel(
      "mjcompose.view",
      title,
      { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true },
      { enableScripts: true, retainContextWhenHidden: true, localResourceRoots: [] },
    );
    this.panel.webview.onDidReceiveMessage((message: FromPage) => void this.hear(message));
    this.panel.onDidDispose(() => {
      gone();
      this.ended = true;
      this.service?.close();
      this.stop();
    });
    void this.begin();
  }

  again(cell?: string): void {
    this.panel.reveal(undefined, true);
    if (!this.service) {
      void this.begin();
    } else if (cell !== this.cell) {
      void this.service.post("choose", { name: CELL, value: cell ?? "(no cell)" });
    }
    this.cell = cell;
  }

  say(message: ToPage): void {
    void this.panel.webview.postMessage(message);
  }

  /**
   * Select the element that is written at the cursor. The lines of an edited text differ from the lines of the model.
   */
  follow(editor: vscode.TextEditor): void {
    const { document, selection } = editor;
    const at = selection.active;
    const jumped = this.jumped;
    this.jumped = undefined;
    if (
      !this.service ||
      document.uri.scheme !== "file" ||
      document.isDirty ||
      jumped === mark(document.uri.fsPath, at.line)
    ) {
      return;
    }
    const around = /\.(ya?ml)$/.test(document.fileName) ? aroundInYaml : aroundInXml;
    const places = around(document.getText(), at.line + 1, at.character + 1);
    void realpath(document.fileName)
      .catch(() => document.fileName)
      .then((real) => this.say({ kind: "reveal", files: [document.fileName, real], places }));
  }

  private async begin(): Promise<void> {
    this.panel.webview.html = words("The model is being built …", theme());
    const folder = folderOf(this.file);
    const line = [
      ...this.command,
      "view",
      named(this.file, folder),
      "--no-open",
      ...(this.cell ? ["--pick", this.cell] : []),
    ];
    let service: Service | undefined;
    try {
      service = await Service.start(
        line,
        folder,
        (message) => this.end(message || "`mjcompose view` has ended."),
        (stop) => {
          this.stop = stop;
        },
      );
      if (this.ended) {
        return service.close();
      }
      const [program, style, bridge] = await Promise.all([
        service.get("page.js"),
        service.get("page.css"),
        readFile(this.bridge, "utf8"),
      ]);
      if (!program.includes(HOST)) {
        throw new Error("This mjcompose is older than the extension: an editor cannot show its page.");
      }
      this.service = service;
      this.panel.webview.html = page(
        program.toString(),
        style.toString(),
        bridge,
        theme(),
        randomBytes(16).toString("hex"),
      );
    } catch (error) {
      service?.close();
      this.end(error instanceof Error ? error.message : String(error));
    }
  }

  private end(message: string): void {
    this.service = undefined;
    this.stop();
    if (!this.ended) {
      this.panel.webview.html = words(message, theme());
    }
  }

  private async hear(message: FromPage): Promise<void> {
    const { service } = this;
    if (message.kind === "open") {
      await this.jump(message.file, message.line, message.column);
    } else if (message.kind === "listen") {
      service?.listen(
        (event) => this.say({ kind: "event", ...event }),
        () => this.say({ kind: "lost" }),
      );
    } else if (message.kind === "post") {
      await service?.post(message.path, message.data).catch(() => {});
    } else {
      try {
        if (message.kind === "ask") {
          return this.say({ kind: "told", id: message.id, data: await this.write(message.data) });
        }
        const bytes = await service!.get(message.path);
        this.say({
          kind: "got",
          id: message.id,
          bytes: bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength) as ArrayBuffer,
        });
      } catch (error) {
        this.say({ kind: "failed", id: message.id, words: String(error) });
      }
    }
  }

  /** Change a recipe as the page asks. */
  private async write(request: object): Promise<unknown> {
    const recipes = vscode.workspace.textDocuments.filter(
      ({ uri }) => uri.scheme === "file" && /\.ya?ml$/i.test(uri.fsPath),
    );
    const documents = await Promise.all(
      recipes.map(async (document) => ({
        document,
        path: await realpath(document.uri.fsPath).catch(() => document.uri.fsPath),
      })),
    );
    const unsaved = documents
      .filter(({ document }) => document.isDirty)
      .map((dirty) => ({ path: dirty.path, text: dirty.document.getText() }));
    return write(
      request,
      unsaved,
      (address, data) => this.service!.ask(address, data),
      async ({ file, range, text }, saves) => {
        const document =
          documents.find((open) => open.path === file)?.document ??
          (await vscode.workspace.openTextDocument(vscode.Uri.file(file)));
        const edit = new vscode.WorkspaceEdit();
        edit.replace(document.uri, new vscode.Range(...range), text);
        return (await vscode.workspace.applyEdit(edit)) && (!saves || (await document.save()));
      },
    );
  }

  /** Go to a line in the editor next to the page; the selection there stays. */
  private async jump(file: string, line: number, column: number): Promise<void> {
    const at = new vscode.Position(line - 1, column - 1);
    const uri = vscode.Uri.file(file);
    this.jumped = mark(uri.fsPath, at.line);
    const shown = vscode.window.visibleTextEditors.find((each) => each.document.uri.fsPath === uri.fsPath);
    const beside = vscode.window.visibleTextEditors.find((each) => each.viewColumn !== this.panel.viewColumn);
    const viewColumn = shown?.viewColumn ?? beside?.viewColumn ?? vscode.ViewColumn.One;
    const editor = await vscode.window.showTextDocument(uri, { viewColumn, selection: new vscode.Range(at, at) });
    editor.revealRange(new vscode.Range(at, at), vscode.TextEditorRevealType.InCenterIfOutsideViewport);
  }
}

const mark = (file: string, line: number): string => `${file}:${line}`;

function theme(): string {
  const { kind } = vscode.window.activeColorTheme;
  return kind === vscode.ColorThemeKind.Light || kind === vscode.ColorThemeKind.HighContrastLight ? "light" : "dark";
}
