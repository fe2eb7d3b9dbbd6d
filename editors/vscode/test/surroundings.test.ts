import assert from "node:assert/strict";
import { test } from "node:test";
import { aroundInXml, aroundInYaml } from "../src/surroundings";

const YAML = `recipe: 1
attach:
  # words
  left:
    model: ./arm.xml

    pos: [0, 1,
      2]
edit:
  - select: {geom: ball}
    set: {rgba: [1, 0, 0, 1]}
`;

const lines = (places: [number, number][]) => places.map(([line]) => line);

test("in YAML the lines above that are less indented are around the cursor", () => {
  assert.deepEqual(aroundInYaml(YAML, 5, 3), [
    [5, 3],
    [5, 21],
    [4, 8],
    [2, 8],
  ]);
  assert.deepEqual(lines(aroundInYaml(YAML, 8, 7)), [8, 8, 7, 4, 2]);
  assert.deepEqual(lines(aroundInYaml(YAML, 1, 1)), [1, 1]);
});

test("the first key of an item of a list is around its other keys", () => {
  assert.deepEqual(lines(aroundInYaml(YAML, 11, 8)), [11, 11, 10, 9]);
});

test("on an empty line the cursor is in what is above it", () => {
  assert.deepEqual(lines(aroundInYaml(YAML, 6, 1)), [6, 6, 5, 4, 2]);
});

const XML = `<mujoco>
  <!-- <body name="not"> -->
  <worldbody>
    <body name="a > b"
          pos="0 0 1">
      <geom size="1"/><site name="s"/>
    </body>
    <body name="c"/>
  </worldbody>
</mujoco>
`;

test("in XML the elements are around the cursor", () => {
  assert.deepEqual(aroundInXml(XML, 6, 9), [
    [6, 7],
    [4, 5],
    [3, 3],
    [1, 1],
  ]);
  assert.deepEqual(aroundInXml(XML, 6, 23), [
    [6, 23],
    [4, 5],
    [3, 3],
    [1, 1],
  ]);
  assert.deepEqual(aroundInXml(XML, 5, 12), [
    [4, 5],
    [3, 3],
    [1, 1],
  ]);
  assert.deepEqual(aroundInXml(XML, 7, 7), [
    [4, 5],
    [3, 3],
    [1, 1],
  ]);
  assert.deepEqual(aroundInXml(XML, 2, 10), [[1, 1]]);
});

test("beside the text of a line it means what is written there", () => {
  assert.deepEqual(aroundInXml(XML, 6, 1)[0], [6, 7]);
  assert.deepEqual(aroundInXml(XML, 8, 21)[0], [8, 5]);
  assert.deepEqual(aroundInXml(XML.replaceAll("\n", "\r\n"), 8, 21)[0], [8, 5]);
});

test("of text that is no XML yet nothing is around what is not open", () => {
  assert.deepEqual(aroundInXml("<mujoco", 1, 4), [[1, 1]]);
  assert.deepEqual(aroundInXml("", 1, 1), []);
});
