/** Events as lines of JSON, equal to those of `protogen decode --format jsonl`. */
import { type Event } from "./events.js";
/** A value as JSON has it: bytes as hexadecimal digits, integers of any size as numbers. */
export declare function jsonValue(value: unknown): string;
/** The line of an event. It has `raw` where encoding it would give other bytes. */
export declare function jsonLine(event: Event): string;
