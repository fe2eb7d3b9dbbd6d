// The Python that the Python extension has chosen, if it is installed.
import * as vscode from "vscode";

interface Environments {
  getActiveEnvironmentPath(resource?: vscode.Uri): { path: string };
  resolveEnvironment(path: unknown): Promise<{ executable: { uri?: vscode.Uri } } | undefined>;
  onDidChangeActiveEnvironmentPath: vscode.Event<unknown>;
}

export async function interpreter(resource?: vscode.Uri): Promise<string | undefined> {
  const environments = await api();
  if (!environments) {
    return undefined;
  }
  try {
    const environment = await environments.resolveEnvironment(environments.getActiveEnvironmentPath(resource));
    return environment?.executable.uri?.fsPath;
  } catch {
    return undefined;
  }
}

/** Calls `act` when another one is chosen. */
export async function onInterpreter(act: () => void): Promise<vscode.Disposable | undefined> {
  return (await api())?.onDidChangeActiveEnvironmentPath(act);
}

async function api(): Promise<Environments | undefined> {
  const extension = vscode.extensions.getExtension("ms-python.python");
  if (!extension) {
    return undefined;
  }
  try {
    return (await extension.activate())?.environments;
  } catch {
    return undefined;
  }
}
