// The places around a cursor at which something begins: its own first, then the surrounding ones. They count from 1.

export type Place = [line: number, column: number];

/**
 * Of YAML: the line of the cursor, and those less indented above it. The columns are ends of lines: a line is one
 * place.
 */
export function aroundInYaml(text: string, line: number, column: number): Place[] {
  const lines = text.split(/\r?\n/);
  const own = lines[line - 1] ?? "";
  const places: Place[] = [
    [line, column],
    [line, own.length + 1],
  ];
  let indent = begin(own);
  for (let at = line - 1; at > 0 && indent > 0; at--) {
    const above = lines[at - 1];
    if (!above.trim() || above.trimStart().startsWith("#")) {
      continue;
    }
    // The first key of an item comes after its dash.
    const dashed = above.replace(/^(\s*)-(?=\s)/, "$1 ");
    if (begin(above) < indent || (begin(dashed) === indent && dashed !== above)) {
      places.push([at, above.length + 1]);
      indent = begin(above);
    }
  }
  return places;
}

const begin = (line: string): number => (line.trim() ? line.length - line.trimStart().length : Infinity);

const COMMENT = /<!--[\s\S]*?(?:-->|$)/;
const CDATA = /<!\[CDATA\[[\s\S]*?(?:\]\]>|$)/;
const DECLARATION = /<[?!][^>]*>?/;
const END_TAG = /<\/[^>]*>?/;
const START_TAG = /<[A-Za-z_](?:"[^"]*"|'[^']*'|[^"'>])*>?/;
/** Everything that begins with `<`; the end of a text may cut it off. */
const MARKUP = new RegExp([COMMENT, CDATA, DECLARATION, END_TAG, START_TAG].map(({ source }) => source).join("|"), "g");

/** Of XML: the elements that the cursor is in, by their start tags. */
export function aroundInXml(text: string, line: number, column: number): Place[] {
  const lines = text.split("\n");
  const own = (lines[line - 1] ?? "").trimEnd();
  const starts = [0];
  for (const row of lines) {
    starts.push(starts.at(-1)! + row.length + 1);
  }
  // In front of the text of a line, the cursor is at the item that begins there, and behind it, at the item that ends
  // there.
  const inText = Math.min(Math.max(column - 1, own.length - own.trimStart().length), own.length - 1);
  const cursor = starts[line - 1] + inText;
  const open: number[] = [];
  for (const { 0: tag, index } of text.matchAll(MARKUP)) {
    if (index > cursor) {
      break;
    }
    if (/^<[?!]/.test(tag)) {
      continue;
    }
    const isEnd = tag.startsWith("</");
    if (!isEnd) {
      open.push(index);
    }
    if (cursor < index + tag.length) {
      break;
    }
    if (isEnd || tag.endsWith("/>")) {
      open.pop();
    }
  }
  return open.reverse().map((index) => {
    const at = starts.findLastIndex((start) => start <= index);
    return [at + 1, index - starts[at] + 1];
  });
}
