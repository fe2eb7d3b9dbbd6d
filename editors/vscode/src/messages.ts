// The messages between the extension and the page next to the text.
import type { Place } from "./surroundings";

export type FromPage =
  | { kind: "get"; id: number; path: string }
  | { kind: "post"; path: string; data: unknown }
  | { kind: "ask"; id: number; path: string; data: object }
  | { kind: "listen" }
  | { kind: "open"; file: string; line: number; column: number };

export type ToPage =
  | { kind: "got"; id: number; bytes: ArrayBuffer }
  | { kind: "told"; id: number; data: unknown }
  | { kind: "failed"; id: number; words: string }
  | { kind: "event"; name: string; data: unknown }
  | { kind: "lost" }
  | { kind: "theme"; name: string }
  | { kind: "reveal"; files: string[]; places: Place[] };
