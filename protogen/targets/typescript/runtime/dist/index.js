/** What generated modules, and those who use them, need. */
export { hex, toHex } from "./bytes.js";
export { crc, fletcher16, sum, xor } from "./checksums.js";
export { Decoder } from "./decoder.js";
export { DecodeError, EncodeError } from "./errors.js";
export { jsonLine, jsonValue } from "./json.js";
export { bits, counted, elements, floor, modulo, noneOf } from "./formulas.js";
export { readBigDigits, readBigNumeral, readDigits, readNumeral, writeDigits, writeNumeral, } from "./numerals.js";
export { bitsNumber, characters, digits, number } from "./numbers.js";
export { nearest, physical } from "./physical.js";
export { frame, group, plan, single } from "./plan.js";
export { Encoder, Protocol, } from "./protocol.js";
export { readRun, writeRun } from "./runs.js";
export { readPayload, writePayload } from "./sender.js";
export { latin1, PLAIN_TEXT } from "./reader.js";
export { eventsOf, streamOf } from "./stream.js";
export { base16, cobs, escape, insertion, substitution } from "./transparency.js";
