// The page changes a recipe through the editor, so text that is not saved stays.

/** What to replace, in lines and columns from 0. */
export interface Edit {
  file: string;
  range: [number, number, number, number];
  text: string;
}
export interface Unsaved {
  path: string;
  text: string;
}

/**
 * Let the server work out what changes in which text, and let the editor change it. A recipe that was saved is saved
 * again, and the model follows; unsaved text stays unsaved.
 */
export async function write(
  request: object,
  unsaved: Unsaved[],
  ask: (path: string, data: unknown) => Promise<any>,
  apply: (edit: Edit, save: boolean) => Promise<boolean>,
): Promise<any> {
  const answer = await ask("change", {
    ...request,
    texts: Object.fromEntries(unsaved.map(({ path, text }) => [path, text])),
  });
  for (const edit of (answer.edits ?? []) as Edit[]) {
    const saves = !unsaved.some(({ path }) => path === edit.file);
    if (!(await apply(edit, saves))) {
      return { refused: "the editor did not change the recipe" };
    }
    if (!saves) {
      answer.said += ". Save the recipe to build it";
    }
  }
  return answer;
}
