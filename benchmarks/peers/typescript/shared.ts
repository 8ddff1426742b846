/** What the three codecs by hand have in common. */

/** A message that came in, or bytes that are no frame (`message` is null, and so is the number). */
export interface Received<Message> {
  /** Of the first byte, counted from the start of the input. */
  readonly offset: number;
  readonly size: number;
  readonly kind: "message" | "unknown" | "invalid";
  /** Counter of the frame, where it has one. */
  readonly counter: number | null;
  readonly message: Message | null;
}

export interface Codec<Message> {
  decoder(): { feed(chunk: Uint8Array): Received<Message>[] };
  encode(message: Message, counter: number): Uint8Array;
  counter(event: Received<Message>): number | null;
}

/** Bytes that are left of the portion before, and the next ones. */
export function joined(rest: Uint8Array, chunk: Uint8Array): Uint8Array {
  if (!rest.length) return chunk;
  const data = new Uint8Array(rest.length + chunk.length);
  data.set(rest);
  data.set(chunk, rest.length);
  return data;
}

/** The value, if it is an integer in these bounds. Throws a RangeError. */
export function integer(value: number, least: number, greatest: number, name: string): number {
  if (!Number.isInteger(value) || value < least || value > greatest) {
    throw new RangeError(`${name}: ${value} is no integer in ${least}..${greatest}`);
  }
  return value;
}
