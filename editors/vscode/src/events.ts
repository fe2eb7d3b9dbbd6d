// Server-Sent Events, out of the pieces in which they come.

export type Event = { name: string; data: unknown };

/** Takes in pieces of a stream; gives the events that are complete. */
export class Events {
  private rest = "";

  take(piece: string): Event[] {
    const blocks = (this.rest + piece).split("\n\n");
    this.rest = blocks.pop() ?? "";
    return blocks.flatMap((block) => {
      const field = (key: string) =>
        block
          .split("\n")
          .filter((line) => line.startsWith(`${key}: `))
          .map((line) => line.slice(key.length + 2))
          .join("\n");
      const name = field("event");
      return name ? [{ name, data: JSON.parse(field("data")) }] : [];
    });
  }
}
