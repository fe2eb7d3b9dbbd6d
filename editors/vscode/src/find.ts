// Which mjcompose is used.
import { execFile } from "node:child_process";
import { type Candidate, candidates, type Places, versionIn } from "./command";

export interface Found extends Candidate {
  version: string;
}
export interface Search {
  found: Found | null;
  tried: Candidate[];
}

const PATIENCE = 60_000;

/** The first candidate that is mjcompose. */
export async function find(places: Places, cwd?: string): Promise<Search> {
  const tried = candidates(places);
  for (const candidate of tried) {
    const version = await versionOf(candidate.words, cwd);
    if (version !== null) {
      return { found: { ...candidate, version }, tried };
    }
  }
  return { found: null, tried };
}

function versionOf([program, ...words]: string[], cwd?: string): Promise<string | null> {
  return new Promise((done) => {
    execFile(program, [...words, "--version"], { cwd, timeout: PATIENCE, windowsHide: true }, (error, output) =>
      done(error ? null : versionIn(output)),
    );
  });
}
