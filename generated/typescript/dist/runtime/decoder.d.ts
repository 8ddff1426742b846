/** The decoder: bytes in any portions -> events. */
import { type Event } from "./events.js";
import type { Sender } from "./sender.js";
import type { Telling } from "./told.js";
/**
 * Cuts what is on a line into events: what one endpoint sends, or several.
 *
 * The raw bytes of all events, joined, are the input; how the input is divided among calls of `feed`
 * changes nothing. At most one greatest frame is kept between calls, and behind it what may yet
 * become a start of three bytes or more; in front of a frame that only a silence ends, as much noise.
 */
export declare class Decoder<Message = unknown, Parts = unknown> {
    private readonly search;
    private readonly name;
    /** Takes what is plain; null where only candidates do. */
    private readonly whole;
    /** Takes what is there as a whole; null where nothing is generated for that. */
    private readonly atOnce;
    private readonly shares;
    private readonly greatest;
    /** Zeros behind the bytes that came in, as a generated function may look beyond these. */
    private readonly ahead;
    private readonly isAnywhere;
    /** True if noise has to go where it and a candidate are longer than a frame. */
    private readonly keepsOne;
    private events;
    /** What is not delivered, and a little context in front of it. Bytes that came in are not changed. */
    private data;
    private size;
    /** Offset of the first of these bytes in the input. */
    private offset;
    private source;
    /** All in front of it is delivered. */
    private done;
    /** No frame starts between `done` and here. */
    private scan;
    /** The candidate has taken all in front of it. */
    private pushed;
    /** Bytes of the frame there that were tried at once. */
    private tried;
    private candidate;
    /** The candidate's, until the next start is known. */
    private failure;
    private sharesStart;
    /** True if nothing came in since the start or the last flush. */
    private isFresh;
    private beganFresh;
    /** Throws a RangeError where the frames of several senders are found in different ways. */
    constructor(senders: readonly Sender[]);
    /** Bytes that were taken and that no event covers yet. */
    get pending(): number;
    /** Take the next bytes of the input; the events that are certain now. */
    feed(chunk: Uint8Array): Event<Message, Parts>[];
    /** Take the end of the input; all remaining events. */
    flush(): Event<Message, Parts>[];
    /** Take a silence on the line: what `flush` does, which ends what has come. */
    idle(): Event<Message, Parts>[];
    /**
     * Tell identities that are not sent, such as what was asked for, by their parts' names.
     *
     * They hold for the frame that comes next and those behind it, or for one where the schema says so.
     * Several values are those of frames that follow each other, of which the last stays. Throws a
     * RangeError where there is no such part, or it can't have the value.
     */
    tell(values: Readonly<Record<string, Telling | undefined>>): void;
    /** Take what another decoder found on the same bus, which may tell an identity here. */
    hear(event: Event): void;
    /** Let a candidate that has taken no byte know what was told since it was made. */
    private restart;
    /** Keep the bytes, behind those that are there. */
    private append;
    /** Forget what is delivered: what is left goes to a place of its own, where more fits behind it. */
    private move;
    private deliver;
    private run;
    /** Look for the next possible start; what is in front of it is noise. */
    private seek;
    private nextStart;
    /** Begin at a possible start. */
    private open;
    /** Take more of a frame, of which most often the rest has come. */
    private goOn;
    /** Take the frames that are there, one behind another. False: there is none. */
    private takeAtOnce;
    /** Take the frame there if it is plainly one, or as much of it as has come. */
    private takeWhole;
    private begin;
    /** Give the candidate bytes until its verdict. */
    private take;
    private judge;
    /** Deliver the frame, unless its payload is not that of its message. */
    private read;
    /** Go on behind the candidate's first byte, where the next frame may start. */
    private resume;
    private giveUp;
    /** The bytes that are kept, for events. */
    private sourceOf;
    /** Deliver noise up to `end` by greatest frames, and if it is complete the rest as well. */
    private noise;
    private invalid;
}
