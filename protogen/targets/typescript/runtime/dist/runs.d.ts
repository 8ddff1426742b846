/** Runs of as many packed numbers as their bytes hold. */
import type { Reader, Step } from "./reader.js";
import type { Writer } from "./writer.js";
/** The bits of each number of what is left of a payload. */
export declare function readRun(reader: Reader, width: number, little: boolean, least: number, greatest: number, step: Step): bigint[];
/** Write numbers of `width` bits one behind another; the last byte is filled up with zeros. */
export declare function writeRun(writer: Writer, values: readonly bigint[], width: number, little: boolean): void;
