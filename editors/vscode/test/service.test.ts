import assert from "node:assert/strict";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { Service } from "../src/service";

// What `mjcompose view` is to the extension: it prints its address, answers, and ends with SIGINT.
const SERVER = `
const http = require("node:http");
const server = http.createServer((request, answer) => {
  const parts = [];
  request.on("data", (part) => parts.push(part)).on("end", () => {
    if (request.url.endsWith("/events")) answer.write('event: model\\ndata: {"version": 0}\\n\\n');
    else if (request.method === "POST") {
      answer.statusCode = Buffer.concat(parts).toString() === '{"name":"cell"}' ? 204 : 400;
      answer.end();
    }
    else answer.end(JSON.stringify([request.url, request.headers.origin ?? null, request.headers.host]));
  });
});
server.listen(0, "127.0.0.1", () => console.log("http://127.0.0.1:" + server.address().port + "/token/"));
`;

async function started(program: string, ended: (output: string) => void = () => {}): Promise<Service> {
  const file = join(await mkdtemp(join(tmpdir(), "mjcompose-")), "view.cjs");
  await writeFile(file, program);
  return Service.start([process.execPath, file], tmpdir(), ended, () => {});
}

test("requests go to the address with the token, and only those of the page", async () => {
  let over = () => {};
  const ended = new Promise<void>((done) => {
    over = done;
  });
  const service = await started(SERVER, over);
  const [url, origin, host] = JSON.parse((await service.get("model/3")).toString());
  assert.deepEqual([url, origin, `http://${host}/token/`], ["/token/model/3", null, service.address]);
  await service.post("choose", { name: "cell" });
  await assert.rejects(service.post("choose", {}), /400/);
  for (const path of ["../secret", "http://evil.example/", "model/../../x", "play"]) {
    await assert.rejects(service.get(path), /no such path/);
  }
  await assert.rejects(service.post("model/1", {}), /no such path/);
  const lost = new Promise<void>((done) => {
    service.listen((event) => {
      assert.deepEqual(event, { name: "model", data: { version: 0 } });
      service.close();
    }, done);
  });
  await lost;
  await ended;
});

test("a command that ends before it serves says why", async () => {
  await assert.rejects(
    started('console.error("error: no such file"); process.exitCode = 2;'),
    /^Error: error: no such file$/,
  );
  await assert.rejects(
    Service.start(
      ["/no/such/program"],
      tmpdir(),
      () => {},
      () => {},
    ),
    /ENOENT/,
  );
});
