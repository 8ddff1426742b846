/** What generated modules, and those who use them, need. */

export type { GivenParts } from "./given.js";
export { hex, toHex } from "./bytes.js";
export { crc, fletcher16, sum, xor } from "./checksums.js";
export { Decoder } from "./decoder.js";
export { DecodeError, EncodeError, type Reason } from "./errors.js";
export type { Event, InvalidEvent, MessageEvent, UnknownEvent } from "./events.js";
export { jsonLine, jsonValue } from "./json.js";
export { bits, counted, elements, floor, modulo, noneOf } from "./formulas.js";
export {
  readBigDigits,
  readBigNumeral,
  readDigits,
  readNumeral,
  writeDigits,
  writeNumeral,
  type Digits,
  type Numeral,
} from "./numerals.js";
export { bitsNumber, characters, digits, number, type Value } from "./numbers.js";
export { nearest, physical } from "./physical.js";
export { frame, group, plan, single } from "./plan.js";
export type { Frame, HeldParts, MessagePlan, NamedMessage } from "./plan.js";
export {
  Encoder,
  Protocol,
  type DecodeOptions,
  type EncodeOptions,
} from "./protocol.js";
export { readRun, writeRun } from "./runs.js";
export { readPayload, writePayload } from "./sender.js";
export { latin1, PLAIN_TEXT, type Reader } from "./reader.js";
export { eventsOf, streamOf } from "./stream.js";
export { base16, cobs, escape, insertion, substitution } from "./transparency.js";
export type { Telling } from "./told.js";
export type { Writer } from "./writer.js";
