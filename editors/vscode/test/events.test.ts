import assert from "node:assert/strict";
import { test } from "node:test";
import { Events } from "../src/events";

test("events come whole, however the stream is cut", () => {
  const text = 'event: model\ndata: {"version": 1}\n\n: \n\nevent: fault\ndata: {"text": "a\\n\\nb"}\n\n';
  for (let cut = 0; cut < text.length; cut++) {
    const events = new Events();
    assert.deepEqual(
      [...events.take(text.slice(0, cut)), ...events.take(text.slice(cut))],
      [
        { name: "model", data: { version: 1 } },
        { name: "fault", data: { text: "a\n\nb" } },
      ],
    );
  }
});
