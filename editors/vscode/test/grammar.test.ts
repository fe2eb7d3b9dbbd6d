import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { test } from "node:test";
import * as oniguruma from "vscode-oniguruma";
import * as textmate from "vscode-textmate";

// YAML's own grammar is VS Code's; this one has what the recipe's meets: strings, plain words and comments.
const YAML = {
  scopeName: "source.yaml",
  patterns: [
    { name: "comment.line.yaml", match: "#.*" },
    { name: "string.quoted.yaml", begin: '"', end: '"' },
    { name: "string.unquoted.yaml", match: "[^\\s:,\\[\\]{}#][^,\\[\\]{}#]*?(?=\\s*(#|$|[,\\]}]))" },
  ],
};

async function grammar(): Promise<textmate.IGrammar> {
  const require = createRequire(`${process.cwd()}/package.json`);
  await oniguruma.loadWASM(await readFile(require.resolve("vscode-oniguruma/release/onig.wasm")));
  const own = JSON.parse(await readFile("syntaxes/recipe.tmLanguage.json", "utf8"));
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (sources) => new oniguruma.OnigScanner(sources),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async (scope) => (scope === YAML.scopeName ? YAML : own) as textmate.IRawGrammar,
  });
  return (await registry.loadGrammar(own.scopeName))!;
}

test("expressions and angles stand out, in plain words and between quotes, and not in comments", async () => {
  const tokenizer = await grammar();
  const scopes = (line: string, word: string): string => {
    const at = line.indexOf(word);
    const { tokens } = tokenizer.tokenizeLine(line, null);
    return tokens
      .find((each) => each.startIndex <= at && at < each.endIndex)!
      .scopes.at(-1)!
      .replace(".mjcompose-recipe", "");
  };
  for (const line of ["pos: [0, ${2 * max(reach, 1)}, 0]", 'pos: "${2 * max(reach, 1)}"']) {
    assert.equal(scopes(line, "${"), "punctuation.definition.template-expression.begin");
    assert.equal(scopes(line, "2"), "constant.numeric");
    assert.equal(scopes(line, "max"), "entity.name.function");
    assert.equal(scopes(line, "reach"), "variable.other");
  }
  assert.equal(scopes("range: [-90deg, 90deg]", "deg"), "keyword.other.unit");
  assert.equal(scopes("a: 1  # ${reach}", "${"), "comment.line.yaml");
  assert.equal(scopes("name: left90deg", "deg"), "string.unquoted.yaml");
});
