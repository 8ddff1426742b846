/** Reasons why bytes are no frame, and errors that say where and why. */
/** Reason why bytes are no frame. */
export type Reason = "noise" | "checksum" | "length" | "stuffing" | "truncated" | "size" | "encoding" | "value";
/** A value can't be sent. `path` names the field or part; `problem` says what is allowed. */
export declare class EncodeError extends Error {
    readonly path: string;
    readonly problem: string;
    readonly name: string;
    constructor(path: string, problem: string);
}
/**
 * Bytes are not exactly one frame, or not the payload of this message.
 *
 * `reason` is one of the decoder's, or `unknown`: a valid frame whose identity belongs to no
 * message. `offset` counts bytes from the start of what was given; `path` names the field, if it is
 * one.
 */
export declare class DecodeError extends Error {
    readonly reason: Reason | "unknown";
    readonly problem: string;
    readonly offset: number;
    readonly path: string;
    readonly name: string;
    constructor(reason: Reason | "unknown", problem: string, offset?: number, path?: string);
}
/**
 * A verdict: bytes are no frame, or no payload.
 *
 * It is thrown and caught for each damaged candidate, so it is no Error, which would keep the stack.
 * `missing` is how many more bytes a payload needs at least, where it ended too early.
 */
export declare class Fault {
    readonly reason: Reason;
    readonly problem: string;
    readonly path: string;
    readonly offset: number;
    readonly missing: number;
    constructor(reason: Reason, problem: string, path?: string, offset?: number, missing?: number);
}
/** A path of names and indices as people write it: `wheels[2].speed`. */
export declare function joined(path: readonly (string | number)[]): string;
/** The bytes as people read them. */
export declare function spelled(bytes: ArrayLike<number>): string;
