// Building and checking, in a terminal.
import * as path from "node:path";
import * as vscode from "vscode";

/** Where commands about a file run: the folder of the workspace that it is in, or its own. */
export function folderOf(file: string): string {
  return vscode.workspace.getWorkspaceFolder(vscode.Uri.file(file))?.uri.fsPath ?? path.dirname(file);
}

/** A file as a command in `folder` names it. */
export function named(file: string, folder: string): string {
  const relative = path.relative(folder, file);
  return relative.startsWith("..") || path.isAbsolute(relative) ? file : relative;
}

/** Run a verb on a cell of a recipe, or on all of them without a cell. */
export async function runTask(verb: "build" | "check", command: string[], file: string, cell?: string): Promise<void> {
  const folder = folderOf(file);
  const [program, ...words] = command;
  const args = [...words, verb, named(file, folder), ...(cell ? ["--pick", cell] : ["--all"])];
  const scope = vscode.workspace.getWorkspaceFolder(vscode.Uri.file(file)) ?? vscode.TaskScope.Workspace;
  const task = new vscode.Task(
    { type: "mjcompose", verb },
    scope,
    `${verb} ${path.basename(file)}`,
    "mjcompose",
    new vscode.ProcessExecution(program, args, { cwd: folder }),
  );
  task.presentationOptions = {
    reveal: vscode.TaskRevealKind.Always,
    clear: true,
    showReuseMessage: false,
    panel: vscode.TaskPanelKind.Shared,
  };
  await vscode.tasks.executeTask(task);
}
