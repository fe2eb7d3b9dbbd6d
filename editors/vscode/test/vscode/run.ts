// Runs the suite in VS Code: one that is installed (MJCOMPOSE_VSCODE, its executable), or one that is downloaded.
import { cpSync, mkdirSync, mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { downloadAndUnzipVSCode, runTests } from "@vscode/test-electron";

async function main(): Promise<void> {
  let vscodeExecutablePath = process.env.MJCOMPOSE_VSCODE;
  try {
    vscodeExecutablePath ??= await downloadAndUnzipVSCode();
  } catch (error) {
    console.log(
      `skipped: VS Code cannot be downloaded (${error instanceof Error ? error.message : error}); ` +
        "MJCOMPOSE_VSCODE may name an installed one",
    );
    return;
  }
  const folder = mkdtempSync(join(tmpdir(), "mjcompose-"));
  cpSync(resolve("../../recipes"), folder, { recursive: true });
  mkdirSync(join(folder, ".vscode"));
  writeFileSync(
    join(folder, ".vscode", "settings.json"),
    JSON.stringify({ "mjcompose.command": JSON.parse(process.env.MJCOMPOSE_COMMAND ?? "[]") }),
  );
  await runTests({
    vscodeExecutablePath,
    extensionDevelopmentPath: process.cwd(),
    extensionTestsPath: resolve("build/vscode/suite.js"),
    launchArgs: [folder, "--disable-extensions", "--disable-workspace-trust"],
  });
}

void main().catch((error) => {
  console.error(error);
  process.exitCode = 1;
});
