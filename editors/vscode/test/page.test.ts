import assert from "node:assert/strict";
import { test } from "node:test";
import { page, words } from "../src/page";

test("the page runs what the extension puts into it, and nothing else", () => {
  const text = page("let a = '</script><!--';", "b{}", "let c;", "dark", "n0nce");
  assert.match(text, /default-src 'none'; script-src 'nonce-n0nce'; /);
  assert.equal(text.match(/<script nonce="n0nce">/g)?.length, 2);
  assert.equal(text.match(/<\/script/g)?.length, 2);
  assert.ok(!text.includes("<!--") && text.includes("data-theme=dark") && text.includes("data-live"));
});

test("words are no markup", () => {
  assert.match(words("<b> & more", "light"), /<pre>&lt;b&gt; &amp; more<\/pre>/);
  assert.ok(!words("", "light").includes("script-src"));
});
