// Which texts are recipes, and which are MJCF models.

export const LANGUAGE = "mjcompose-recipe";
/** The greatest number of lines above `recipe:`. */
export const MOST_LINES_ABOVE = 50;

const NOTHING = /^\s*(#.*)?$|^---\s*(#.*)?$|^%\w+/;
// With its number: other formats begin with `recipe:` too.
const VERSION = /^(["']?)recipe\1\s*:\s+\d+\s*(#.*)?$/;

const MODEL =
  /^\uFEFF?\s*(?:(?:<\?[\s\S]*?\?>|<!--[\s\S]*?-->|<!DOCTYPE[^>]*>)\s*)*<(?:mujoco|mujocoinclude)(?=[\s/>]|$)/;

/** Whether the root of an XML text is `<mujoco>` or `<mujocoinclude>`. */
export const isModel = (text: string): boolean => MODEL.test(text);

/** Whether the first key of a YAML text is `recipe`, with a number. */
export function isRecipe(text: string): boolean {
  const lines = text.replace(/^\uFEFF/, "").split(/\r?\n/, MOST_LINES_ABOVE + 1);
  const first = lines.find((line) => !NOTHING.test(line));
  return first !== undefined && VERSION.test(first);
}
