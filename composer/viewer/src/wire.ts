// How a live page reaches its server: by itself, or through the program that shows it.

export interface Wire {
  get(path: string): Promise<ArrayBuffer>;
  post(path: string, data: unknown): Promise<void>;
  /** Posts, and gives the answer. An editor that is older than the page has none. */
  ask?(path: string, data: unknown): Promise<any>;
  /** Calls `event` with each event of the server, and `lost` when there is no answer. */
  listen(event: (name: string, data: any) => void, lost: () => void): void;
}

/** An editor around the page. It gives the page `mjcomposeHost` before the page begins. */
export interface Host extends Wire {
  theme: string;
  open(file: string, line: number, column: number): void;
  /** Calls `theme` when the editor looks different, and `reveal` with the places around the cursor, the innermost first. */
  follow(theme: (name: string) => void, reveal: (files: string[], places: [line: number, column: number][]) => void): void;
}

export const host: Host | null = (window as any).mjcomposeHost ?? null;

const EVENTS = ["model", "fault", "state"];

export class Http implements Wire {
  async get(path: string): Promise<ArrayBuffer> {
    const answer = await fetch(path);
    if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
    return answer.arrayBuffer();
  }

  async post(path: string, data: unknown): Promise<void> {
    await fetch(path, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(data) });
  }

  async ask(path: string, data: unknown): Promise<any> {
    const answer = await fetch(path, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(data) });
    if (!answer.ok) throw new Error(answer.statusText);
    return answer.json();
  }

  listen(event: (name: string, data: any) => void, lost: () => void): void {
    const events = new EventSource("events");
    for (const name of EVENTS) events.addEventListener(name, (said) => event(name, JSON.parse((said as MessageEvent).data)));
    events.addEventListener("error", lost);
  }
}
