// The command and the options of the server. It does not use the API of VS Code, so tests can use it.
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

/** Actions that the extension takes over from the server: the page opens next to the text. */
export const OWN_COMMANDS = ["mjcompose.view", "mjcompose.build", "mjcompose.check"];
