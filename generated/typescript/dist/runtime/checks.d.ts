/** What values of a payload have to be, and errors that say where they are not. */
import { EncodeError } from "./errors.js";
import { type Step } from "./reader.js";
/** Checks values, and knows the path of the record or list that they are in. */
export declare class Checks {
    /** With it, values that the schema forbids are refused, even where they fit the wire. */
    strict: boolean;
    protected readonly path: Step[];
    /** The error of a field. */
    error(step: Step, problem: string): EncodeError;
    enter(step: Step): void;
    leave(): void;
    /** An integer that the wire can hold. */
    int(value: unknown, low: number, high: number, step: Step): number;
    protected noInteger(value: unknown, low: number, high: number, step: Step): EncodeError;
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
}
