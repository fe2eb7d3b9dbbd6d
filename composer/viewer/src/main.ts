import { App } from "./app";
import { embedded, unpacked } from "./data";
import { h } from "./dom";
import { Live } from "./live";

async function start(): Promise<void> {
  const root = document.getElementById("page")!;
  try {
    const app = new App(root);
    (window as any).mjcompose = app;
    if (document.documentElement.dataset.live !== undefined) new Live(app);
    else {
      const physics = document.querySelector("script.physics"), Physics = (window as any).mjcomposePhysics;
      if (physics && Physics) app.server = new Physics(app, await unpacked(physics));
      await app.show(await embedded());
    }
  } catch (error) {
    root.replaceChildren(h("p", { className: "broken" }, `This browser cannot show the model: ${error instanceof Error ? error.message : error}. It needs WebGL 2.`));
    throw error;
  }
}

void start();
