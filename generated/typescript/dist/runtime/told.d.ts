/** What a receiver is told of identities that are not sent: by its program, or by frames. */
import type { ToldValues } from "./candidate.js";
import type { Framed } from "./events.js";
import type { Sender } from "./sender.js";
/** A number, or those of frames that follow each other. */
export type Telling = number | readonly number[];
/** The values of a decoder's told parts, by their names. */
export declare class Told {
    private readonly senders;
    private readonly parts;
    private readonly values;
    private readonly following;
    private fresh;
    constructor(senders: readonly Sender[]);
    /** True if there are such parts. */
    get isNeeded(): boolean;
    /** Take what was told: it holds for a frame that begins now. */
    beginFrame(): void;
    /** What holds for the frame that is coming in, by the slots of a sender. */
    valuesFor(sender: Sender): ToldValues;
    /** Take values, or those of the frames to come. Throws a RangeError; then nothing is taken. */
    tell(given: Readonly<Record<string, Telling | undefined>>): void;
    /** Throw a RangeError for a length that no frame has, but for the one before any is told. */
    private checkLengths;
    /** What holds for one frame that is all there is, without lengths that are not given. */
    valuesForOne(sender: Sender, given: Readonly<Record<string, unknown>>, data: number): ToldValues;
    /** Take a frame: what was told may hold no more, and it may tell something itself. */
    passFrame(event: Framed): void;
    /** Take the numbers of a frame, which may tell something of those behind it. */
    hear(event: Framed): void;
}
