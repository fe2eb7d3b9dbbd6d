// The language server: found, started, and reported in one message where it cannot be.
import { spawn } from "node:child_process";
import * as vscode from "vscode";
import {
  CloseAction,
  type ErrorHandler,
  type Executable,
  LanguageClient,
  type LanguageClientOptions,
  type ServerOptions,
  State,
  type StaticFeature,
} from "vscode-languageclient/node";
import { INSTALL, missing, reason } from "./command";
import { type Found, find } from "./find";
import { interpreter } from "./interpreter";
import { OWN_COMMANDS, SELECTOR, serverWords, WATCHED } from "./options";
import { LANGUAGE } from "./recipes";

/** Commands of the server that the extension carries out itself are not offered twice, which VS Code refuses. */
const OWN: StaticFeature = {
  preInitialize: ({ executeCommandProvider: offered }) => {
    if (offered) {
      offered.commands = offered.commands.filter((each) => !OWN_COMMANDS.includes(each));
    }
  },
  fillClientCapabilities: () => {},
  initialize: () => {},
  getState: () => ({ kind: "static" }),
  clear: () => {},
};

export class Server implements vscode.Disposable {
  private client: LanguageClient | undefined;
  private finding: Promise<Found | null> | undefined;
  private starting: Promise<void> | undefined;
  private last = Promise.resolve();
  private readonly output = vscode.window.createOutputChannel("mjcompose", { log: true });
  private readonly status = vscode.languages.createLanguageStatusItem("mjcompose", { language: LANGUAGE });
  private readonly watcher = vscode.workspace.createFileSystemWatcher(WATCHED);

  constructor() {
    this.status.name = "mjcompose";
    this.status.command = { command: "mjcompose.restart", title: "Restart" };
  }

  /** Start it, unless it runs. */
  start(): Promise<void> {
    this.starting ??= this.after(() => this.begin());
    return this.starting;
  }

  /** Stop it and start it again, with the command that is mjcompose now. */
  restart(): Promise<void> {
    this.starting = this.after(async () => {
      await this.stop();
      this.finding = undefined;
      await this.begin();
    });
    return this.starting;
  }

  /** The command that is mjcompose here; that there is none is said. */
  command(): Promise<Found | null> {
    this.finding ??= this.look();
    return this.finding;
  }

  async dispose(): Promise<void> {
    await this.after(() => this.stop());
    for (const resource of [this.output, this.status, this.watcher]) {
      resource.dispose();
    }
  }

  /** Each action starts after the one before has ended. */
  private after(act: () => Promise<void>): Promise<void> {
    this.last = this.last.then(act, act);
    return this.last;
  }

  private async stop(): Promise<void> {
    const { client } = this;
    this.client = undefined;
    if (client?.state === State.Running) {
      await client.stop();
    }
    // One that did not start cannot be disposed of.
    await client?.dispose().catch(() => {});
  }

  private async look(): Promise<Found | null> {
    const folders = (vscode.workspace.workspaceFolders ?? []).map((each) => each.uri.fsPath);
    const setting = vscode.workspace.getConfiguration("mjcompose").get<string[]>("command", []);
    const python = setting.length ? undefined : await interpreter(vscode.workspace.workspaceFolders?.[0]?.uri);
    const { found, tried } = await find(
      { setting, interpreter: python, folders, windows: process.platform === "win32" },
      folders[0],
    );
    if (found) {
      this.output.info(`mjcompose ${found.version} (${found.from}): ${found.words.join(" ")}`);
      this.tell(`mjcompose ${found.version}`, found.from, vscode.LanguageStatusSeverity.Information);
      return found;
    }
    const { message, run } = missing(tried, python);
    this.tell("mjcompose was not found", message, vscode.LanguageStatusSeverity.Error);
    void this.complain(message, run);
    return null;
  }

  private async begin(): Promise<void> {
    const found = await this.command();
    if (!found) {
      return;
    }
    let stderr = "";
    let began = false;
    const [program, ...options] = serverWords(found.words);
    const executable: Executable = { command: program, args: options };
    const serverOptions: ServerOptions = async () => {
      const child = spawn(executable.command, executable.args!, {
        cwd: vscode.workspace.workspaceFolders?.[0]?.uri.fsPath,
        windowsHide: true,
      });
      stderr = "";
      child.stderr.setEncoding("utf8").on("data", (piece: string) => {
        stderr = (stderr + piece).slice(-20_000);
      });
      return child;
    };
    const client: LanguageClient = new LanguageClient("mjcompose", "mjcompose", serverOptions, {
      documentSelector: SELECTOR,
      outputChannel: this.output,
      synchronize: { fileEvents: this.watcher },
      initializationFailedHandler: () => false,
      errorHandler: this.errors(
        () => began,
        () => client,
      ),
    } satisfies LanguageClientOptions);
    client.registerFeature(OWN);
    this.client = client;
    try {
      await client.start();
      began = true;
    } catch (error) {
      const words = reason(stderr) || (error instanceof Error ? error.message : String(error));
      this.output.error(stderr.trim() || words);
      this.tell("the server did not start", words, vscode.LanguageStatusSeverity.Error);
      void this.complain(
        `mjcompose ${found.version} (${found.from}) started no language server: ${words}`,
        /`(.*pip install.*)`/.exec(words)?.[1] ?? INSTALL,
      );
    }
  }

  /** A server that never began is not started again; one that fails later is, a few times. */
  private errors(began: () => boolean, client: () => LanguageClient): ErrorHandler {
    let usual: ErrorHandler | undefined;
    const handler = () => (usual ??= client().createDefaultErrorHandler());
    return {
      error: (error, message, count) => handler().error(error, message, count),
      closed: () => (began() ? handler().closed() : { action: CloseAction.DoNotRestart, handled: true }),
    };
  }

  private tell(text: string, detail: string, severity: vscode.LanguageStatusSeverity): void {
    Object.assign(this.status, { text, detail, severity });
  }

  private async complain(message: string, run: string): Promise<void> {
    const [copy, settings, again] = ["Copy the command", "Open the setting", "Try again"];
    const chosen = await vscode.window.showErrorMessage(message, copy, settings, again);
    if (chosen === copy) {
      await vscode.env.clipboard.writeText(run);
    } else if (chosen === settings) {
      await vscode.commands.executeCommand("workbench.action.openSettings", "mjcompose.command");
    } else if (chosen === again) {
      await this.restart();
    }
  }
}
