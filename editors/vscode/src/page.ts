// The text of the page next to an editor.

/** The page of `mjcompose view`, with nothing that it would have to fetch: its requests go through the extension. */
export function page(program: string, style: string, bridge: string, theme: string, nonce: string): string {
  const script = (text: string) =>
    `<script nonce="${nonce}">${text.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--")}</script>`;
  return shell(
    `<style>${style}\nbody{padding:0}</style>`,
    `<div id=page></div>${script(bridge)}${script(program)}`,
    theme,
    `script-src 'nonce-${nonce}'; img-src data: blob:; `,
  );
}

/** A page of words alone. */
export function words(text: string, theme: string): string {
  return shell("<style>body{padding:1em}pre{white-space:pre-wrap}</style>", `<pre>${escaped(text)}</pre>`, theme);
}

function shell(head: string, body: string, theme: string, allowed = ""): string {
  const policy = `default-src 'none'; ${allowed}style-src 'unsafe-inline'; form-action 'none'; base-uri 'none'`;
  const lines = [
    "<!doctype html>",
    `<html lang=en data-live data-theme=${theme}>`,
    "<meta charset=utf-8>",
    `<meta http-equiv="Content-Security-Policy" content="${policy}">`,
    head,
    `<body>${body}</body>`,
    "</html>",
  ];
  return `${lines.join("\n")}\n`;
}

const escaped = (text: string): string =>
  text.replace(/[&<>]/g, (each) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" })[each]!);
