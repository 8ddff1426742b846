/** Reasons why bytes are no frame, and errors that say where and why. */

/** Reason why bytes are no frame. */
export type Reason =
  | "noise"
  | "checksum"
  | "length"
  | "stuffing"
  | "truncated"
  | "size"
  | "encoding"
  | "value";

/** A value can't be sent. `path` names the field or part; `problem` says what is allowed. */
export class EncodeError extends Error {
  override readonly name: string = "EncodeError";

  constructor(
    readonly path: string,
    readonly problem: string,
  ) {
    super(path ? `${path}: ${problem}` : problem);
  }
}

/**
 * Bytes are not exactly one frame, or not the payload of this message.
 *
 * `reason` is one of the decoder's, or `unknown`: a valid frame whose identity belongs to no
 * message. `offset` counts bytes from the start of what was given; `path` names the field, if it is
 * one.
 */
export class DecodeError extends Error {
  override readonly name: string = "DecodeError";

  constructor(
    readonly reason: Reason | "unknown",
    readonly problem: string,
    readonly offset: number = 0,
    readonly path: string = "",
  ) {
    super(`byte ${offset}${path ? `, ${path}` : ""}: ${problem} (${reason})`);
  }
}

/**
 * A verdict: bytes are no frame, or no payload.
 *
 * It is thrown and caught for each damaged candidate, so it is no Error, which would keep the stack.
 * `missing` is how many more bytes a payload needs at least, where it ended too early.
 */
export class Fault {
  constructor(
    readonly reason: Reason,
    readonly problem: string,
    readonly path: string = "",
    readonly offset: number = 0,
    readonly missing: number = 0,
  ) {}
}

/** A path of names and indices as people write it: `wheels[2].speed`. */
export function joined(path: readonly (string | number)[]): string {
  let text = "";
  for (const step of path) {
    if (typeof step === "number") text += `[${step}]`;
    else if (step) text += text ? `.${step}` : step;
  }
  return text;
}

/** The bytes as people read them. */
export function spelled(bytes: ArrayLike<number>): string {
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join(" ").toUpperCase();
}
