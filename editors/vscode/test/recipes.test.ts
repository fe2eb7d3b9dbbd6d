import assert from "node:assert/strict";
import { test } from "node:test";
import { isModel, isRecipe, MOST_LINES_ABOVE } from "../src/recipes";

test("a text whose first key is `recipe` with a number is a recipe", () => {
  for (const text of [
    "recipe: 1\n",
    "\uFEFF# words\r\n\r\n%YAML 1.2\r\n---\r\nrecipe: 1   # version\r\nbase: ./arm.xml",
    '"recipe": 1',
    "recipe:  2",
  ]) {
    assert.ok(isRecipe(text), text);
  }
});

test("others are not", () => {
  for (const text of [
    "",
    "recipe:\n  name: python\n",
    "recipe: bread\n",
    "name: a\nrecipe: 1\n",
    " recipe: 1\n",
    "recipes: 1\n",
    "recipe: 1.5.0\n",
    `${"#\n".repeat(MOST_LINES_ABOVE + 1)}recipe: 1`,
  ]) {
    assert.ok(!isRecipe(text), text);
  }
});

test("a model is XML whose root is that of MJCF", () => {
  for (const text of [
    "<mujoco>",
    "\uFEFF<?xml version='1.0'?>\r\n<!-- <robot/> -->\n<mujoco model='arm'>",
    "<mujocoinclude/>",
    "<mujoco",
  ]) {
    assert.ok(isModel(text), text);
  }
  for (const text of ["", "<robot name='arm'/>", "<!-- <mujoco> --><project/>", "<mujocos/>", "words <mujoco/>"]) {
    assert.ok(!isModel(text), text);
  }
});
