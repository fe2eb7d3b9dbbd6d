// The picture as it is, into the clipboard.
import { h, toast } from "./dom";
import type { Stage } from "./stage";

export async function copyPicture(stage: Stage, name: string): Promise<void> {
  const blob = await picture(stage);
  try {
    await navigator.clipboard.write([new ClipboardItem({ "image/png": blob })]);
    toast("copied the picture");
  } catch {
    const link = h("a", { href: URL.createObjectURL(blob), download: `${name}.png` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    toast(`saved the picture as ${name}.png, because the browser keeps its clipboard closed`);
  }
}

/** The canvas on the page's background, which it does not have itself. */
export function picture(stage: Stage): Promise<Blob> {
  stage.sharp();
  const { canvas } = stage, made = h("canvas", { width: canvas.width, height: canvas.height }), pen = made.getContext("2d")!, style = getComputedStyle(document.documentElement);
  const ground = pen.createRadialGradient(0.5 * made.width, 0.35 * made.height, 0, 0.5 * made.width, 0.35 * made.height, 0.75 * Math.max(made.width, made.height));
  ground.addColorStop(0, style.getPropertyValue("--ground").trim());
  ground.addColorStop(1, style.getPropertyValue("--ground2").trim());
  pen.fillStyle = ground;
  pen.fillRect(0, 0, made.width, made.height);
  pen.drawImage(canvas, 0, 0);
  return new Promise((done, failed) => made.toBlob((blob) => (blob ? done(blob) : failed(new Error("the browser makes no picture"))), "image/png"));
}
