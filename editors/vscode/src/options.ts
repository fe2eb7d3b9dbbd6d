// What the server is started with, and what is said to it. Without the API of VS Code, so that a test can do the same.
import { LANGUAGE } from "./recipes";

/** The words that start the server. */
export const serverWords = (command: string[]): string[] => [...command, "lsp"];

/** The texts that the server gets: recipes, and models, whose unsaved text counts too. */
export const SELECTOR = [
  { scheme: "file", language: LANGUAGE },
  { scheme: "untitled", language: LANGUAGE },
  { scheme: "file", pattern: "**/*.{xml,mjcf}" },
];

/** The files whose changes on the disk the server hears of. */
export const WATCHED = "**/*.{xml,mjcf,urdf,xacro,yaml,yml,lock,obj,stl,msh,png}";

/** What the extension does itself, also where the server offers it: the page opens beside the text. */
export const OWN_COMMANDS = ["mjcompose.view", "mjcompose.build", "mjcompose.check"];
