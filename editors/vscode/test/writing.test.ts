import assert from "node:assert/strict";
import { test } from "node:test";
import { type Edit, write } from "../src/writing";

const EDIT: Edit = { file: "/a.yaml", range: [1, 2, 1, 3], text: "5" };

async function written(unsaved: { path: string; text: string }[], applies = true): Promise<[any, any, unknown[]]> {
  let request: any;
  const applied: unknown[] = [];
  const ask = async (path: string, data: unknown) => {
    request = [path, data];
    return { said: "moved", edits: [EDIT] };
  };
  const answer = await write({ kind: "place" }, unsaved, ask, async (...each) => {
    applied.push(each);
    return applies;
  });
  return [answer, request, applied];
}

test("a saved recipe is changed and saved, an unsaved one is changed and says so", async () => {
  const [answer, request, applied] = await written([{ path: "/b.yaml", text: "b" }]);
  assert.deepEqual(request, ["change", { kind: "place", texts: { "/b.yaml": "b" } }]);
  assert.deepEqual(applied, [[EDIT, true]]);
  assert.equal(answer.said, "moved");
  const [unsaved, , kept] = await written([{ path: "/a.yaml", text: "a" }]);
  assert.deepEqual(kept, [[EDIT, false]]);
  assert.match(unsaved.said, /Save the recipe/);
});

test("what the editor or the server refuses is said", async () => {
  assert.match((await written([], false))[0].refused, /did not change/);
  assert.deepEqual(
    await write(
      {},
      [],
      async () => ({ refused: "no" }),
      async () => {
        throw new Error();
      },
    ),
    { refused: "no" },
  );
});
