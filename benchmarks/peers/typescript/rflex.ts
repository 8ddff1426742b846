/** What flex of an ATRV-Jr sends, by hand: stuffed packets with an exclusive or. */

import { integer, joined, type Codec, type Received } from "./shared.js";

export type Message =
  | { message: "system_status"; timestamp: number; battery_voltage: number; brake: number }
  | {
      message: "read_motor";
      unknown: number;
      timestamp: number;
      axis: number;
      position: number;
      velocity: number;
      acceleration: number;
      torque: number;
    }
  | {
      message: "joystick_data";
      timestamp: number;
      horizontal: number;
      vertical: number;
      buttons: number;
    }
  | {
      message: "sonar_data";
      unknown: number;
      timestamp: number;
      readings: { cluster: number; distance: number }[];
    };

const ESC = 0x1b;
const STX = 0x02;
const ETX = 0x03;
const BAR = 0x7c;
/** Class, number, subclass and length. */
const HEAD = 4;

const SYSTEM_STATUS = 0x0101;
const READ_MOTOR = 0x0221;
const JOYSTICK_DATA = 0x0300;
const SONAR_DATA = 0x0402;

function i32(data: Uint8Array, at: number): number {
  return (
    (data[at]! << 24) | (data[at + 1]! << 16) | (data[at + 2]! << 8) | data[at + 3]!
  );
}

function u32(data: Uint8Array, at: number): number {
  return i32(data, at) >>> 0;
}

/** The message of a packet's content; null: no message has this identity; undefined: its size. */
function read(content: Uint8Array): Message | null | undefined {
  const size = content[3]!;
  switch ((content[0]! << 8) | content[2]!) {
    case SYSTEM_STATUS:
      if (size !== 9) return undefined;
      return {
        message: "system_status",
        timestamp: u32(content, HEAD),
        battery_voltage: u32(content, HEAD + 4),
        brake: content[HEAD + 8]!,
      };
    case READ_MOTOR:
      if (size !== 25) return undefined;
      return {
        message: "read_motor",
        unknown: u32(content, HEAD),
        timestamp: u32(content, HEAD + 4),
        axis: content[HEAD + 8]!,
        position: i32(content, HEAD + 9),
        velocity: i32(content, HEAD + 13),
        acceleration: i32(content, HEAD + 17),
        torque: i32(content, HEAD + 21),
      };
    case JOYSTICK_DATA:
      if (size !== 13) return undefined;
      return {
        message: "joystick_data",
        timestamp: u32(content, HEAD),
        horizontal: i32(content, HEAD + 4),
        vertical: i32(content, HEAD + 8),
        buttons: content[HEAD + 12]!,
      };
    case SONAR_DATA: {
      if (size < 8 || size > 254 || size % 3 !== 2) return undefined;
      const readings = [];
      for (let at = HEAD + 8; at < HEAD + size; at += 3) {
        readings.push({
          cluster: content[at]!,
          distance: (content[at + 1]! << 8) | content[at + 2]!,
        });
      }
      return {
        message: "sonar_data",
        unknown: u32(content, HEAD),
        timestamp: u32(content, HEAD + 4),
        readings,
      };
    }
    default:
      return null;
  }
}

/** Place of the next start from `at` on, or of an ESC at the end that may begin one; or the end. */
function nextStart(data: Uint8Array, at: number): number {
  for (let place = at; place < data.length; place++) {
    if (data[place] !== ESC) continue;
    if (place + 1 === data.length || data[place + 1] === STX) return place;
  }
  return data.length;
}

export class Decoder {
  private rest = new Uint8Array(0);
  private offset = 0;
  private readonly content = new Uint8Array(HEAD + 256);
  private events: Received<Message>[] = [];

  feed(chunk: Uint8Array): Received<Message>[] {
    const data = joined(this.rest, chunk);
    let at = 0;
    while (at < data.length) {
      const start = nextStart(data, at);
      if (start > at) this.invalid(at, start);
      at = start;
      if (start + 1 >= data.length) break;
      const end = this.packet(data, start);
      if (end < 0) break;
      if (end > 0) at = end;
      else {
        at = nextStart(data, start + 1);
        this.invalid(start, at);
      }
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

  /** The end of the packet that starts there; 0: it is none; -1: it is not all there. */
  private packet(data: Uint8Array, start: number): number {
    const { content } = this;
    let size = 0;
    let sum = 0;
    let at = start + 2;
    while (at < data.length) {
      let byte = data[at++]!;
      if (byte === ESC) {
        if (at === data.length) return -1;
        const next = data[at++]!;
        if (next === ETX) return this.complete(start, at, size, sum);
        if (next !== 0x00) return 0;
      } else if (byte === BAR) {
        if (at === data.length) return -1;
        if (data[at++] !== ESC) return 0;
        if (at === data.length) return -1;
        if (data[at++] !== 0x01) return 0;
      }
      if (size > HEAD && size > HEAD + content[3]!) return 0;
      if (size >= HEAD) sum ^= byte;
      content[size++] = byte;
    }
    return -1;
  }

  private complete(start: number, end: number, size: number, sum: number): number {
    const { content } = this;
    if (size <= HEAD || size !== HEAD + content[3]! + 1 || sum) return 0;
    const message = read(content);
    if (message === undefined) return 0;
    this.events.push({
      offset: this.offset + start,
      size: end - start,
      kind: message ? "message" : "unknown",
      counter: content[1]!,
      message,
    });
    return end;
  }
}

/** Stuffs a packet while it is written. */
class Packet {
  private readonly out = new Uint8Array(782);
  private size = 0;
  private sum = 0;

  begin(identity: number, number: number, length: number): this {
    this.out[0] = ESC;
    this.out[1] = STX;
    this.size = 2;
    this.put(identity >> 8);
    this.put(integer(number, 0, 0xff, "number"));
    this.put(identity & 0xff);
    this.put(length);
    this.sum = 0;
    return this;
  }

  private put(byte: number): void {
    const { out } = this;
    out[this.size++] = byte;
    if (byte === ESC) out[this.size++] = 0x00;
    else if (byte === BAR) {
      out[this.size++] = ESC;
      out[this.size++] = 0x01;
    }
    this.sum ^= byte;
  }

  u8(value: number, name: string): this {
    this.put(integer(value, 0, 0xff, name));
    return this;
  }

  u16(value: number, name: string): this {
    integer(value, 0, 0xffff, name);
    this.put(value >> 8);
    this.put(value & 0xff);
    return this;
  }

  u32(value: number, name: string): this {
    return this.word(integer(value, 0, 0xffffffff, name));
  }

  i32(value: number, name: string): this {
    return this.word(integer(value, -0x80000000, 0x7fffffff, name));
  }

  private word(value: number): this {
    this.put(value >>> 24);
    this.put((value >> 16) & 0xff);
    this.put((value >> 8) & 0xff);
    this.put(value & 0xff);
    return this;
  }

  end(): Uint8Array {
    this.put(this.sum);
    this.out[this.size++] = ESC;
    this.out[this.size++] = ETX;
    return this.out.slice(0, this.size);
  }
}

const PACKET = new Packet();

/** The packet of a message. Throws a RangeError. */
export function encode(message: Message, number: number): Uint8Array {
  switch (message.message) {
    case "system_status":
      return PACKET.begin(SYSTEM_STATUS, number, 9)
        .u32(message.timestamp, "timestamp")
        .u32(message.battery_voltage, "battery_voltage")
        .u8(message.brake, "brake")
        .end();
    case "read_motor":
      return PACKET.begin(READ_MOTOR, number, 25)
        .u32(message.unknown, "unknown")
        .u32(message.timestamp, "timestamp")
        .u8(message.axis, "axis")
        .i32(message.position, "position")
        .i32(message.velocity, "velocity")
        .i32(message.acceleration, "acceleration")
        .i32(message.torque, "torque")
        .end();
    case "joystick_data":
      return PACKET.begin(JOYSTICK_DATA, number, 13)
        .u32(message.timestamp, "timestamp")
        .i32(message.horizontal, "horizontal")
        .i32(message.vertical, "vertical")
        .u8(message.buttons, "buttons")
        .end();
    case "sonar_data": {
      const { readings } = message;
      if (readings.length > 82) throw new RangeError(`readings: ${readings.length} are too many`);
      PACKET.begin(SONAR_DATA, number, 8 + 3 * readings.length)
        .u32(message.unknown, "unknown")
        .u32(message.timestamp, "timestamp");
      for (const { cluster, distance } of readings) {
        PACKET.u8(cluster, "cluster").u16(distance, "distance");
      }
      return PACKET.end();
    }
  }
}

export const codec: Codec<Message> = {
  decoder: () => new Decoder(),
  encode,
  counter: (event) => event.counter,
};
