// In the page, before its own program: its requests go to the extension. The page calls this `Host`
// (composer/viewer/src/wire.ts).
import type { FromPage, ToPage } from "./messages";
import type { Place } from "./surroundings";

declare function acquireVsCodeApi(): { postMessage(message: FromPage): void };

const code = acquireVsCodeApi();
const waiting = new Map<number, { done: (answer: any) => void; failed: (error: Error) => void }>();
let count = 0;
let event: (name: string, data: unknown) => void = () => {};
let lost: () => void = () => {};
let theme: (name: string) => void = () => {};
let reveal: (files: string[], places: Place[]) => void = () => {};

addEventListener("message", ({ data }: MessageEvent<ToPage>) => {
  if (data.kind === "event") {
    event(data.name, data.data);
  } else if (data.kind === "lost") {
    lost();
  } else if (data.kind === "theme") {
    theme(data.name);
  } else if (data.kind === "reveal") {
    reveal(data.files, data.places);
  } else {
    const request = waiting.get(data.id);
    waiting.delete(data.id);
    if (data.kind === "got") {
      request?.done(data.bytes);
    } else if (data.kind === "told") {
      request?.done(data.data);
    } else {
      request?.failed(new Error(data.words));
    }
  }
});

Object.assign(window, {
  mjcomposeHost: {
    theme: document.documentElement.dataset.theme,
    get: (path: string) =>
      new Promise<ArrayBuffer>((done, failed) => {
        waiting.set(++count, { done, failed });
        code.postMessage({ kind: "get", id: count, path });
      }),
    ask: (path: string, data: object) =>
      new Promise<unknown>((done, failed) => {
        waiting.set(++count, { done, failed });
        code.postMessage({ kind: "ask", id: count, path, data });
      }),
    post: async (path: string, data: unknown) => code.postMessage({ kind: "post", path, data }),
    listen: (onEvent: typeof event, onLost: typeof lost) => {
      event = onEvent;
      lost = onLost;
      code.postMessage({ kind: "listen" });
    },
    open: (file: string, line: number, column: number) => code.postMessage({ kind: "open", file, line, column }),
    follow: (onTheme: typeof theme, onReveal: typeof reveal) => {
      theme = onTheme;
      reveal = onReveal;
    },
  },
});
