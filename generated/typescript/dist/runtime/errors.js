/** Reasons why bytes are no frame, and errors that say where and why. */
/** A value can't be sent. `path` names the field or part; `problem` says what is allowed. */
export class EncodeError extends Error {
    constructor(path, problem) {
        super(path ? `${path}: ${problem}` : problem);
        this.path = path;
        this.problem = problem;
        this.name = "EncodeError";
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
    constructor(reason, problem, offset = 0, path = "") {
        super(`byte ${offset}${path ? `, ${path}` : ""}: ${problem} (${reason})`);
        this.reason = reason;
        this.problem = problem;
        this.offset = offset;
        this.path = path;
        this.name = "DecodeError";
    }
}
/**
 * A verdict: bytes are no frame, or no payload.
 *
 * It is thrown and caught for each damaged candidate, so it is no Error, which would keep the stack.
 * `missing` is how many more bytes a payload needs at least, where it ended too early.
 */
export class Fault {
    constructor(reason, problem, path = "", offset = 0, missing = 0) {
        this.reason = reason;
        this.problem = problem;
        this.path = path;
        this.offset = offset;
        this.missing = missing;
    }
}
/** A path of names and indices as people write it: `wheels[2].speed`. */
export function joined(path) {
    let text = "";
    for (const step of path) {
        if (typeof step === "number")
            text += `[${step}]`;
        else if (step)
            text += text ? `.${step}` : step;
    }
    return text;
}
/** The bytes as people read them. */
export function spelled(bytes) {
    return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join(" ").toUpperCase();
}
