/** Writes the values of a payload, one after another. Generated functions call it. */
import { Checks } from "./checks.js";
import type { Value } from "./numbers.js";
import { type HeldParts } from "./plan.js";
import { type Step, type TextForm } from "./reader.js";
/** How many values a byte has. */
type Base = 128 | 256;
/**
 * Bytes of a payload so far. Each method appends a value, or throws an EncodeError.
 *
 * There may be room in front of the payload, for the parts of the frame that stand there.
 */
export declare class Writer extends Checks {
    /** What is written into where nobody knows how much it will be. */
    private scratch;
    bytes: Uint8Array;
    /** A frame as it is on the wire. */
    private stuffed;
    /** Bytes so far, those in front of the payload among them. */
    size: number;
    /** Values of the fields that are parts of the frame, by the names of the parts. */
    held: HeldParts;
    /**
     * Begin another payload behind so many bytes.
     *
     * With a size, all that will be written has so many bytes.
     */
    restart(strict: boolean, from: number, size: number): this;
    /** All that was written. */
    taken(): Uint8Array;
    /** The place of so many more bytes. */
    room(size: number): number;
    /** Room for so many bytes of a frame as it is on the wire. */
    wire(size: number): Uint8Array;
    private grow;
    /** Leave a number to the frame, whose part it is. */
    part(name: string, value: Value): void;
    u8(value: unknown, step: Step): void;
    i8(value: unknown, step: Step): void;
    u16(value: unknown, step: Step): void;
    i16(value: unknown, step: Step): void;
    u16be(value: unknown, step: Step): void;
    i16be(value: unknown, step: Step): void;
    /** All bits of a byte of 7 bits. */
    u7(value: unknown, step: Step): void;
    /** All bits of two bytes of 7 bits, the least significant byte first. */
    u14(value: unknown, step: Step): void;
    /** The same of a signed one. */
    i14(value: unknown, step: Step): void;
    u32(value: unknown, step: Step): void;
    i32(value: unknown, step: Step): void;
    u32be(value: unknown, step: Step): void;
    i32be(value: unknown, step: Step): void;
    /** The lowest eight bits. */
    byte(value: number): void;
    /** A truth value as a byte. */
    bool(value: unknown, step: Step): void;
    /** An unsigned integer in bytes of 8 bits or, if `base` is 128, of 7. */
    uint(value: unknown, size: number, bits: number, little: boolean, base: Base, step: Step): void;
    /** The same of a signed one. */
    sint(value: unknown, size: number, bits: number, little: boolean, base: Base, step: Step): void;
    /** The lowest bits of an integer. */
    private lowest;
    /** The same of more than 53 bits. */
    ubig(value: bigint, size: number, bits: number, little: boolean, base: Base): void;
    f32(value: unknown, little: boolean, step: Step): void;
    f64(value: unknown, little: boolean, step: Step): void;
    /** A float in bytes of 7 bits. */
    float7(value: unknown, bits: 32 | 64, little: boolean, step: Step): void;
    private real32;
    private real64;
    /** `least` to `greatest` bytes. */
    octets(value: unknown, least: number, greatest: number, sevenBit: boolean, step: Step, until?: number): void;
    /** End the bytes from a place on by `until`, if they have an end, and refuse what they can't be. */
    private ended;
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
export {};
