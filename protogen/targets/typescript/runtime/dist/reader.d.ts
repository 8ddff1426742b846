/** Reads the values of a payload, one after another. Generated functions call it. */
import { Fault } from "./errors.js";
import { type HeldParts } from "./plan.js";
/** Name of a field, or index of an element. */
export type Step = string | number;
/** What ends an array that takes what is left, in bytes or in fields. */
export interface Tail {
    readonly element: number;
    readonly least: number;
    /** The byte in front of each field, where fields are counted. */
    readonly separator?: number;
}
/** Form of a text of a fixed size: its padding, and how its characters lie in bytes. */
export interface TextForm {
    readonly padding: number;
    readonly bits: number;
    readonly shift: number;
    readonly add: number;
}
/** Form of a text whose bytes are its characters, with NUL as padding. */
export declare const PLAIN_TEXT: TextForm;
/**
 * A place in a payload. Each method takes what is there, or throws a Fault with the path.
 *
 * The last argument of most methods is the name of the field or the index of the element.
 */
export declare class Reader {
    bytes: Uint8Array;
    private held;
    /** The place of the next byte. */
    at: number;
    /** The place behind the last byte of the payload, or of the region. */
    end: number;
    private readonly path;
    private depth;
    private regions;
    /** `held` has the parts of the frame that are fields. */
    constructor(bytes: Uint8Array, held?: HeldParts);
    /** Begin at another payload. */
    restart(bytes: Uint8Array, at: number, end: number, held?: HeldParts): this;
    /** The Fault of a field. */
    fault(step: Step, reason: "size" | "value" | "encoding", problem: string, missing?: number): Fault;
    /** Begin what lies inside of a field or an element. */
    enter(step: Step): void;
    /** End what lies inside of it. */
    leave(): void;
    /** Bytes that are left. */
    get left(): number;
    /** The place of so many bytes, which are taken. */
    take(size: number, step: Step): number;
    private short;
    /** A number of up to 53 bits that the frame has. */
    part(name: string, step: Step): number;
    /** A number of more bits that the frame has. */
    bigPart(name: string, step: Step): bigint;
    private heldPart;
    u8(step: Step): number;
    i8(step: Step): number;
    u16(step: Step): number;
    u16be(step: Step): number;
    i16(step: Step): number;
    i16be(step: Step): number;
    i32(step: Step): number;
    i32be(step: Step): number;
    u32(step: Step): number;
    u32be(step: Step): number;
    u64(step: Step): bigint;
    u64be(step: Step): bigint;
    i64(step: Step): bigint;
    i64be(step: Step): bigint;
    /** An unsigned integer of 7 bits. */
    u7(step: Step): number;
    /** One of 14 bits, 7 in each byte, the least significant ones first. */
    u14(step: Step): number;
    i14(step: Step): number;
    /** An unsigned integer of up to 53 bits in bytes of 8 bits or, if `base` is 128, of 7. */
    uint(size: number, bits: number, little: boolean, base: 128 | 256, step: Step): number;
    /** A signed integer of up to 53 bits; two's complement in its bits. */
    sint(size: number, bits: number, little: boolean, base: 128 | 256, step: Step): number;
    /** An unsigned integer of more than 53 bits. */
    ubig(size: number, bits: number, little: boolean, base: 128 | 256, step: Step): bigint;
    /** A signed integer of more than 53 bits. */
    sbig(size: number, bits: number, little: boolean, base: 128 | 256, step: Step): bigint;
    private eighthBit;
    private padding;
    bool(step: Step): boolean;
    f32(little: boolean, step: Step): number;
    f64(little: boolean, step: Step): number;
    /** A float in bytes of 7 bits. */
    float7(bits: 32 | 64, little: boolean, step: Step): number;
    /** A value out of a closed enum. */
    one<T extends number | bigint>(value: number | bigint, values: readonly T[], step: Step): T;
    /** A constant. */
    constant<const T>(value: unknown, due: T, step: Step): T;
    /** A number that earlier fields give, of elements or bytes. */
    count(number: number, least: number, greatest: number, by: string, step: Step): number;
    /** The Fault of a selector without a case. */
    noCase(value: number | bigint, by: string, step: Step): Fault;
    /** So many bytes, which are copied; with `sevenBit` each is at most 7F. */
    octets(size: number, sevenBit: boolean, step: Step): Uint8Array;
    /** So many bytes as a text, one character each. */
    latin1(size: number, sevenBit: boolean, step: Step): string;
    /** The number of bytes that are left. */
    rest(least: number, greatest: number, step: Step): number;
    /** Bytes in front of a terminator, which is taken, too. */
    until(byte: number, least: number, greatest: number, sevenBit: boolean, step: Step): Uint8Array;
    /** A text in front of a separator or of the end; with `leads` a separator stands in front. */
    between(separator: number, leads: boolean, allowed: string, least: number, greatest: number, step: Step): string;
    private separator;
    /** A text of a fixed size without its padding. */
    text(size: number, form: TextForm, sevenBit: boolean, step: Step): string;
    /** Begin a region of so many bytes; what ends it is given to `close`. */
    open(size: number, step: Step): number;
    /** End a region, of which nothing may be left. */
    close(outer: number, step: Step): void;
    /** The place of another element that takes what is left, -1 at its end; `here`: the one before. */
    next(here: number, index: number, least: number, greatest: number): number;
    /** True if another element stands behind one that is not the last. */
    goesOn(isLast: boolean, index: number, least: number, greatest: number): boolean;
    /** The number of elements in front of a tail. */
    elements(tail: Tail): number;
    /** Take a run of packed bits as one integer. */
    run(size: number, little: boolean, step: Step): bigint;
    /** Refuse bits of a run that belong to no number. */
    unused(run: bigint, mask: bigint, step: Step): void;
    /** Refuse what is left of the payload. */
    finish(): void;
}
/** The text of some bytes, one character each. */
export declare function latin1(bytes: Uint8Array): string;
/** True if two values of constants are equal. */
export declare function same(one: unknown, other: unknown): boolean;
/** A value as errors show it. */
export declare function shown(value: unknown): string;
