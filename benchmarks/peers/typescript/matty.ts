/** What Matty's ESP32 sends, by hand: escaped frames with a length and a sum. */

import { integer, joined, type Codec, type Received } from "./shared.js";

export type Message =
  | { message: "ack" }
  | { message: "nack" }
  | {
      message: "status";
      status: number;
      mode: number;
      voltage: number;
      current: number;
      speed: number;
      angle: number;
      encoder0: number;
      encoder1: number;
      encoder2: number;
      encoder3: number;
    }
  | { message: "gps"; nmea: string };

const SYNC = 0x55;
const ESC = 0x56;
/** Length, counter and command. */
const HEAD = 3;
const LEAST = 2;
const GREATEST = 123;

const ACK = 0x41;
const NACK = 0x4e;
const STATUS = 0x49;
const GPS = 0x50;

function u16(data: Uint8Array, at: number): number {
  return data[at]! | (data[at + 1]! << 8);
}

function i16(data: Uint8Array, at: number): number {
  return (u16(data, at) << 16) >> 16;
}

/** The message of a frame's content; null: no message has this letter; undefined: its size. */
function read(content: Uint8Array): Message | null | undefined {
  const size = content[0]! - 2;
  switch (content[2]) {
    case ACK:
      return size ? undefined : { message: "ack" };
    case NACK:
      return size ? undefined : { message: "nack" };
    case STATUS:
      if (size !== 18) return undefined;
      return {
        message: "status",
        status: content[3]!,
        mode: content[4]!,
        voltage: u16(content, 5),
        current: u16(content, 7),
        speed: i16(content, 9),
        angle: i16(content, 11),
        encoder0: u16(content, 13),
        encoder1: u16(content, 15),
        encoder2: u16(content, 17),
        encoder3: u16(content, 19),
      };
    case GPS: {
      let nmea = "";
      for (let at = HEAD; at < HEAD + size; at++) nmea += String.fromCharCode(content[at]!);
      return { message: "gps", nmea };
    }
    default:
      return null;
  }
}

export class Decoder {
  private rest = new Uint8Array(0);
  private offset = 0;
  private readonly content = new Uint8Array(256);
  private events: Received<Message>[] = [];

  feed(chunk: Uint8Array): Received<Message>[] {
    const data = joined(this.rest, chunk);
    let at = 0;
    while (at < data.length) {
      let end = data[at] === SYNC ? this.frame(data, at) : 0;
      if (end < 0) break;
      if (!end) {
        end = at + 1;
        while (end < data.length && data[end] !== SYNC) end++;
        this.invalid(at, end);
      }
      at = end;
    }
    this.rest = data.slice(at);
    this.offset += at;
    const { events } = this;
    this.events = [];
    return events;
  }

  private invalid(at: number, end: number): void {
    const offset = this.offset + at;
    this.events.push({ offset, size: end - at, kind: "invalid", counter: null, message: null });
  }

  /** The end of the frame that starts there; 0: it is none; -1: it is not all there. */
  private frame(data: Uint8Array, start: number): number {
    const { content } = this;
    let size = 0;
    let sum = 0;
    let due = 1;
    let at = start + 1;
    while (at < data.length) {
      let byte = data[at++]!;
      if (byte === SYNC) return 0;
      if (byte === ESC) {
        if (at === data.length) return -1;
        byte = data[at++]! ^ 0xff;
        if (byte !== SYNC && byte !== ESC) return 0;
      }
      if (!size) {
        if (byte < LEAST || byte > GREATEST) return 0;
        due = byte + 2;
      }
      sum += byte;
      content[size++] = byte;
      if (size === due) return sum & 0xff ? 0 : this.complete(start, at);
    }
    return -1;
  }

  private complete(start: number, end: number): number {
    const message = read(this.content);
    if (message === undefined) return 0;
    this.events.push({
      offset: this.offset + start,
      size: end - start,
      kind: message ? "message" : "unknown",
      counter: this.content[1]!,
      message,
    });
    return end;
  }
}

/** Escapes a frame while it is written. */
class Frame {
  private readonly out = new Uint8Array(256);
  private size = 0;
  private sum = 0;

  begin(command: number, counter: number, payload: number): this {
    this.out[0] = SYNC;
    this.size = 1;
    this.sum = 0;
    this.put(payload + 2);
    this.put(integer(counter, 0, 0xff, "counter"));
    this.put(command);
    return this;
  }

  put(byte: number): void {
    this.sum += byte;
    if (byte === SYNC || byte === ESC) {
      this.out[this.size++] = ESC;
      this.out[this.size++] = byte ^ 0xff;
    } else this.out[this.size++] = byte;
  }

  u8(value: number, name: string): this {
    this.put(integer(value, 0, 0xff, name));
    return this;
  }

  u16(value: number, name: string): this {
    return this.word(integer(value, 0, 0xffff, name));
  }

  i16(value: number, name: string): this {
    return this.word(integer(value, -0x8000, 0x7fff, name));
  }

  private word(value: number): this {
    this.put(value & 0xff);
    this.put((value >> 8) & 0xff);
    return this;
  }

  end(): Uint8Array {
    this.put(-this.sum & 0xff);
    return this.out.slice(0, this.size);
  }
}

const FRAME = new Frame();

/** The frame of a message. Throws a RangeError. */
export function encode(message: Message, counter: number): Uint8Array {
  switch (message.message) {
    case "ack":
      return FRAME.begin(ACK, counter, 0).end();
    case "nack":
      return FRAME.begin(NACK, counter, 0).end();
    case "status":
      return FRAME.begin(STATUS, counter, 18)
        .u8(message.status, "status")
        .u8(message.mode, "mode")
        .u16(message.voltage, "voltage")
        .u16(message.current, "current")
        .i16(message.speed, "speed")
        .i16(message.angle, "angle")
        .u16(message.encoder0, "encoder0")
        .u16(message.encoder1, "encoder1")
        .u16(message.encoder2, "encoder2")
        .u16(message.encoder3, "encoder3")
        .end();
    case "gps": {
      const { nmea } = message;
      if (nmea.length > 121) throw new RangeError(`nmea: ${nmea.length} characters are too many`);
      FRAME.begin(GPS, counter, nmea.length);
      for (let index = 0; index < nmea.length; index++) {
        FRAME.put(integer(nmea.charCodeAt(index), 0, 0x7f, "nmea"));
      }
      return FRAME.end();
    }
  }
}

export const codec: Codec<Message> = {
  decoder: () => new Decoder(),
  encode,
  counter: (event) => event.counter,
};
