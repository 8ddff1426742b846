/** Parts of frames whose values callers give, or an encoder counts. */
import { EncodeError } from "./errors.js";
import type { PartNumber, Value } from "./numbers.js";
import { type ValueNumber } from "./plan.js";
/** Values of parts by their names, as callers give them. */
export type GivenParts = Readonly<Record<string, unknown>>;
/** What most callers give. */
export declare const NONE_GIVEN: GivenParts;
/** The next values of counters, by their names. */
export type Counts = Map<string, Value>;
/** The number of what a caller gives. Throws an EncodeError. */
export declare function givenTo(number: PartNumber | null, value: unknown, name: string): Value;
/** A part whose value callers may give, or have to. */
export declare class GivenPart {
    private readonly part;
    readonly name: string;
    readonly slot: number;
    /** True if every object has something by its name. */
    private readonly isInherited;
    /** Bounds of the numbers that need no other check; there are none where it is no number. */
    private readonly least;
    private readonly greatest;
    constructor(part: ValueNumber);
    /** What a caller gives for it. */
    own(given: GivenParts): unknown;
    /** True of a number that needs no other check. */
    private isPlain;
    /** The value of what a caller gives. Throws an EncodeError. */
    given(own: unknown, strict: boolean): Value;
    /** The value where a caller gives none; null where there has to be one. */
    usual(counts: Counts | null): Value | null;
    /** The error where there is no value. */
    error(): EncodeError;
    /** Go on counting, where the callers gave no value. */
    count(given: GivenParts, counts: Counts): void;
}
