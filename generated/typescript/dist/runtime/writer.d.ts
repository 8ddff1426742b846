/** Writes the values of a payload, one after another. Generated functions call it. */
import { EncodeError } from "./errors.js";
import type { Value } from "./numbers.js";
import { type Step, type TextForm } from "./reader.js";
/**
 * Bytes of a payload so far. Each method appends a value, or throws an EncodeError.
 *
 * There may be room in front of the payload, for the parts of the frame that stand there.
 */
export declare class Writer {
    strict: boolean;
    bytes: Uint8Array;
    /** Bytes so far, those in front of the payload among them. */
    size: number;
    /** Values of the fields that are parts of the frame, by the names of the parts. */
    held: Record<string, Value>;
    private readonly path;
    /** With `strict`, values that the schema forbids are refused, even where they fit the wire. */
    constructor(strict: boolean);
    /** Begin another payload, in the place of the one before, behind so many bytes. */
    restart(strict: boolean, from: number): this;
    /** The error of a field. */
    error(step: Step, problem: string): EncodeError;
    enter(step: Step): void;
    leave(): void;
    /** The place of so many more bytes. */
    room(size: number): number;
    /** Leave a number to the frame, whose part it is. */
    part(name: string, value: Value): void;
    /** An integer that the wire can hold. */
    int(value: unknown, low: number, high: number, step: Step): number;
    /** An integer of more than 53 bits that the wire can hold. */
    big(value: unknown, low: bigint, high: bigint, step: Step): bigint;
    /** A value in the range of the schema, or a special one. */
    ranged<T extends number | bigint>(value: T, least: NoInfer<T> | null, greatest: NoInfer<T> | null, special: readonly NoInfer<T>[], step: Step): T;
    /** A value out of a closed enum. */
    one<T extends number | bigint>(value: number | bigint, values: readonly T[], step: Step): T;
    /** A truth value; 0 and 1 are taken as well. */
    truth(value: unknown, step: Step): number;
    /** A float that its bits can hold. */
    real(value: unknown, bits: 32 | 64, step: Step): number;
    /** A constant, which needs not be given. */
    constant<const T>(value: unknown, due: T, step: Step): T;
    /** A struct. */
    record(value: unknown, step: Step): any;
    /** A list of `least` to `greatest` elements. */
    list(value: unknown, least: number, greatest: number, step: Step): readonly any[];
    /** A number of elements or bytes. */
    count(count: number, least: number, greatest: number, what: string, step: Step): void;
    /** Nothing: the value of what is not there, or has no bytes. */
    nothing(value: unknown, step: Step): void;
    /** Refuse a value behind one that is left out. */
    behind(front: unknown, name: string, step: Step): void;
    /** Refuse an element that says that it is the last where it is not, or the reverse. */
    last(isLast: boolean, items: readonly unknown[], index: number, by: string): void;
    /** The error of a selector without a case. */
    noCase(value: number | bigint, by: string, step: Step): EncodeError;
    u8(value: number): void;
    u16(value: number): void;
    u16be(value: number): void;
    u32(value: number): void;
    u32be(value: number): void;
    /** The lowest bits of an integer in bytes of 8 bits or, if `base` is 128, of 7. */
    uint(value: number, size: number, bits: number, little: boolean, base: 128 | 256): void;
    /** The same of more than 53 bits. */
    ubig(value: bigint, size: number, bits: number, little: boolean, base: 128 | 256): void;
    /** A float; `base` is 256, or 128 in bytes of 7 bits. A NaN is written in one way. */
    float(value: number, bits: 32 | 64, little: boolean, base: 128 | 256): void;
    /** `least` to `greatest` bytes. */
    octets(value: unknown, least: number, greatest: number, sevenBit: boolean, step: Step, until?: number): void;
    /** The characters of a text, which are bytes. */
    characters(value: unknown, step: Step): string;
    /** A text of `least` to `greatest` characters. */
    latin1(value: unknown, least: number, greatest: number, sevenBit: boolean, step: Step, until?: number): void;
    /** A text among separators. */
    between(value: unknown, separator: number, leads: boolean, allowed: string, least: number, greatest: number, step: Step): void;
    /** A text of a fixed size, which its padding fills up. */
    text(value: unknown, size: number, form: TextForm, sevenBit: boolean, step: Step): void;
    /** Begin a region of so many bytes; what ends it is given to `close`. */
    open(size: number, _step: Step): readonly [number, number];
    /** Refuse a region that has another size than it has to have. */
    close([start, size]: readonly [number, number], step: Step): void;
}
