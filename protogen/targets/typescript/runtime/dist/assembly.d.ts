/** Frames from their parts. */
import type { MessagePlan } from "./plan.js";
import { type Sender } from "./sender.js";
/** Values of parts by their names, as callers give them. */
export type GivenParts = Readonly<Record<string, unknown>>;
/** The frame of a message. Throws an EncodeError. */
export declare function frameOf(sender: Sender, message: MessagePlan, value: unknown, given: GivenParts, strict: boolean): Uint8Array;
/** The frame of an unknown message, whose identity is given. Throws an EncodeError. */
export declare function unknownFrameOf(sender: Sender, payload: Uint8Array, given: GivenParts): Uint8Array;
