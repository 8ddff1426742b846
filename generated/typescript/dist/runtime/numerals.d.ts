/** Integers that are written as text in payloads. */
import type { Reader, Step } from "./reader.js";
import type { Writer } from "./writer.js";
/** Form of an integer of as many digits as it needs, or of one character. */
export interface Numeral {
    readonly base: 10 | 16 | 256;
    readonly padded: number;
    readonly fraction: number;
    readonly signed: boolean;
    readonly upper: boolean;
    /** Greatest integer that so many digits stand for. */
    readonly greatest: number | bigint;
    /** Bytes of the longest text. */
    readonly longest: number;
    /** What no text stands for, where there may be none. */
    readonly absent: number | bigint;
    readonly separator?: number;
    readonly leads?: boolean;
    readonly empty?: boolean;
}
/** Form of an integer of `bits` bits as so many digits out of an alphabet. */
export interface Digits {
    readonly alphabet: string;
    readonly size: number;
    readonly bits: number;
    readonly signed: boolean;
}
/** Read an integer of so many digits. */
export declare function readDigits(reader: Reader, form: Digits, step: Step): number;
/** The same of more than 53 bits. */
export declare function readBigDigits(reader: Reader, form: Digits, step: Step): bigint;
/** Write an integer as so many digits. */
export declare function writeDigits(writer: Writer, value: number | bigint, form: Digits, step: Step): void;
/** Read an integer as text. */
export declare function readNumeral(reader: Reader, form: Numeral, step: Step): number;
/** The same of more than 53 bits. */
export declare function readBigNumeral(reader: Reader, form: Numeral, step: Step): bigint;
/** Write an integer as text. */
export declare function writeNumeral(writer: Writer, value: number | bigint, form: Numeral, step: Step): void;
