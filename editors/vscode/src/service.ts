// `mjcompose view` as a process, and the requests to it. The extension carries the requests of the page: the server answers
// only who knows its address, no other page may show it in a frame, and over SSH it needs no forwarded port.
import { type ChildProcess, spawn } from "node:child_process";
import * as http from "node:http";
import { type Event, Events } from "./events";

const GETS = /^(model\/-?\d+|blob\/[\w.-]+|page\.(js|css)|events)$/;
const POSTS = /^(play|pose|choose|shown|change)$/;
const PATIENCE = 3000;

export class Service {
  private readonly streams = new Set<http.ClientRequest>();

  private constructor(
    private readonly child: ChildProcess,
    readonly address: string,
  ) {}

  /** Start; resolves once the page is served. Rejects with the output of the command if it ends before. */
  static start(
    [program, ...words]: string[],
    cwd: string,
    ended: (output: string) => void,
    began: (stop: () => void) => void,
  ): Promise<Service> {
    return new Promise((done, failed) => {
      const child = spawn(program, words, { cwd, stdio: ["ignore", "pipe", "pipe"], windowsHide: true });
      let out = "";
      let output = "";
      let serves = false;
      began(() => stop(child));
      child.stderr!.setEncoding("utf8").on("data", (piece: string) => {
        output = (output + piece).slice(-20_000);
      });
      child.stdout!.setEncoding("utf8").on("data", (piece: string) => {
        if (serves) {
          return;
        }
        out += piece;
        const address = /^http:\/\/\S+\/$/m.exec(out)?.[0];
        if (!address) {
          return;
        }
        serves = true;
        done(new Service(child, address));
      });
      child.on("error", (error) => failed(error));
      child.on("exit", () => {
        if (serves) {
          ended(output.trim());
        } else {
          failed(new Error(output.trim() || `${program} ended`));
        }
      });
    });
  }

  get(path: string): Promise<Buffer> {
    if (!GETS.test(path)) {
      return Promise.reject(new Error(`no such path: ${path}`));
    }
    return this.request(path, "GET");
  }

  async post(path: string, data: unknown): Promise<void> {
    if (!POSTS.test(path)) {
      throw new Error(`no such path: ${path}`);
    }
    await this.request(path, "POST", JSON.stringify(data));
  }

  /** Post, and give the answer. */
  async ask(path: string, data: unknown): Promise<any> {
    if (!POSTS.test(path)) {
      throw new Error(`no such path: ${path}`);
    }
    return JSON.parse((await this.request(path, "POST", JSON.stringify(data))).toString());
  }

  /** Calls `take` with each event until the server is gone, and then `lost`. */
  listen(take: (event: Event) => void, lost: () => void): void {
    const request = http.get(new URL("events", this.address), (answer) => {
      const events = new Events();
      answer
        .setEncoding("utf8")
        .on("data", (piece: string) => events.take(piece).forEach(take))
        .on("close", lost)
        .on("error", () => {});
    });
    request.on("error", lost);
    this.streams.add(request);
  }

  close(): void {
    for (const stream of this.streams) {
      stream.destroy();
    }
    stop(this.child);
  }

  private request(path: string, method: string, body?: string): Promise<Buffer> {
    return new Promise((done, failed) => {
      const headers =
        body === undefined
          ? {}
          : {
              "content-type": "application/json",
              "content-length": Buffer.byteLength(body),
              origin: new URL(this.address).origin,
            };
      const request = http.request(new URL(path, this.address), { method, headers }, (answer) => {
        const pieces: Buffer[] = [];
        answer.on("data", (piece: Buffer) => pieces.push(piece));
        answer.on("error", failed);
        answer.on("end", () => {
          if (answer.statusCode! < 300) {
            done(Buffer.concat(pieces));
          } else {
            failed(new Error(`${path}: ${answer.statusCode} ${answer.statusMessage}`));
          }
        });
      });
      request.on("error", failed);
      request.end(body);
    });
  }
}

/** End it like Ctrl-C, and kill it if it does not listen. */
function stop(child: ChildProcess): void {
  if (child.exitCode !== null || child.signalCode !== null) {
    return;
  }
  child.kill("SIGINT");
  const killing = setTimeout(() => child.kill("SIGKILL"), PATIENCE);
  child.once("exit", () => clearTimeout(killing));
}
