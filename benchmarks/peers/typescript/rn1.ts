/** What the RN#1 BRAIN sends, by hand: 7-bit data behind a byte that says what it is. */

import { integer, joined, type Codec, type Received } from "./shared.js";

interface Axes<Name extends string> {
  message: Name;
  status: number;
  int_x: number;
  int_y: number;
  int_z: number;
}

export type Message =
  | Axes<"gyro">
  | Axes<"xcel">
  | { message: "compass"; status: number; avg_x: number; avg_y: number; avg_z: number }
  | { message: "optflow"; status: number; dx: number; dy: number; q: number }
  | { message: "lidar"; status: number; distances: number[] }
  | { message: "sonar"; status: number; distances: number[] }
  | { message: "facing"; status: number; heading: number; speed: number };

const GYRO = 0x80;
const XCEL = 0x81;
const COMPASS = 0x82;
const OPTFLOW = 0x83;
const LIDAR = 0x84;
const SONAR = 0x85;
const FACING = 0xa0;
const STOP = 0xff;

const LIDAR_POINTS = 360;
const SONARS = 7;

/** Bytes behind each start. */
const SIZES = new Map([
  [GYRO, 7],
  [XCEL, 7],
  [COMPASS, 7],
  [OPTFLOW, 6],
  [LIDAR, 1 + 2 * LIDAR_POINTS],
  [SONAR, 1 + 2 * SONARS],
  [FACING, 5],
]);

function unsigned(data: Uint8Array, at: number): number {
  return data[at]! | (data[at + 1]! << 7);
}

function signed(data: Uint8Array, at: number): number {
  return (unsigned(data, at) << 18) >> 18;
}

function distances(data: Uint8Array, at: number, count: number): number[] {
  const found: number[] = [];
  for (let index = 0; index < count; index++) found.push(unsigned(data, at + 2 * index));
  return found;
}

function read(data: Uint8Array, at: number): Message {
  const status = data[at + 1]!;
  switch (data[at]) {
    case GYRO:
    case XCEL:
      return {
        message: data[at] === GYRO ? "gyro" : "xcel",
        status,
        int_x: signed(data, at + 2),
        int_y: signed(data, at + 4),
        int_z: signed(data, at + 6),
      };
    case COMPASS:
      return {
        message: "compass",
        status,
        avg_x: signed(data, at + 2),
        avg_y: signed(data, at + 4),
        avg_z: signed(data, at + 6),
      };
    case OPTFLOW:
      return {
        message: "optflow",
        status,
        dx: signed(data, at + 2),
        dy: signed(data, at + 4),
        q: data[at + 6]!,
      };
    case LIDAR:
      return { message: "lidar", status, distances: distances(data, at + 2, LIDAR_POINTS) };
    case SONAR:
      return { message: "sonar", status, distances: distances(data, at + 2, SONARS) };
    default:
      return {
        message: "facing",
        status,
        heading: unsigned(data, at + 2),
        speed: signed(data, at + 4),
      };
  }
}

export class Decoder {
  private rest = new Uint8Array(0);
  private offset = 0;

  feed(chunk: Uint8Array): Received<Message>[] {
    const data = joined(this.rest, chunk);
    const events: Received<Message>[] = [];
    let at = 0;
    while (at < data.length) {
      const start = data[at]!;
      const size = SIZES.get(start);
      const isStart = start >= 0x80 && start !== STOP;
      // A frame of no known message, and noise, go up to the next start.
      const most = size === undefined ? data.length : at + 1 + size;
      let end = at + 1;
      while (end < most && end < data.length && data[end]! < 0x80) end++;
      if (end === data.length && (size === undefined ? isStart : end < most)) break;
      const offset = this.offset + at;
      if (size === undefined) {
        const kind = isStart ? "unknown" : "invalid";
        events.push({ offset, size: end - at, kind, counter: null, message: null });
      } else if (end < most) {
        events.push({ offset, size: end - at, kind: "invalid", counter: null, message: null });
      } else {
        const message = read(data, at);
        events.push({ offset, size: 1 + size, kind: "message", counter: null, message });
      }
      at = end;
    }
    this.rest = data.slice(at);
    this.offset += at;
    return events;
  }
}

function putUnsigned(out: Uint8Array, at: number, value: number, name: string): void {
  integer(value, 0, 0x3fff, name);
  out[at] = value & 0x7f;
  out[at + 1] = value >> 7;
}

function putSigned(out: Uint8Array, at: number, value: number, name: string): void {
  integer(value, -0x2000, 0x1fff, name);
  out[at] = value & 0x7f;
  out[at + 1] = (value >> 7) & 0x7f;
}

function framed(start: number, status: number): Uint8Array {
  const out = new Uint8Array(1 + SIZES.get(start)!);
  out[0] = start;
  out[1] = integer(status, 0, 0x7f, "status");
  return out;
}

function putDistances(out: Uint8Array, values: readonly number[], count: number): void {
  if (values.length !== count) throw new RangeError(`${count} distances, not ${values.length}`);
  for (let index = 0; index < count; index++) {
    putUnsigned(out, 2 + 2 * index, values[index]!, "distances");
  }
}

/** The frame of a message. Throws a RangeError. */
export function encode(message: Message): Uint8Array {
  switch (message.message) {
    case "gyro":
    case "xcel": {
      const out = framed(message.message === "gyro" ? GYRO : XCEL, message.status);
      putSigned(out, 2, message.int_x, "int_x");
      putSigned(out, 4, message.int_y, "int_y");
      putSigned(out, 6, message.int_z, "int_z");
      return out;
    }
    case "compass": {
      const out = framed(COMPASS, message.status);
      putSigned(out, 2, message.avg_x, "avg_x");
      putSigned(out, 4, message.avg_y, "avg_y");
      putSigned(out, 6, message.avg_z, "avg_z");
      return out;
    }
    case "optflow": {
      const out = framed(OPTFLOW, message.status);
      putSigned(out, 2, message.dx, "dx");
      putSigned(out, 4, message.dy, "dy");
      out[6] = integer(message.q, 0, 0x7f, "q");
      return out;
    }
    case "lidar": {
      const out = framed(LIDAR, message.status);
      putDistances(out, message.distances, LIDAR_POINTS);
      return out;
    }
    case "sonar": {
      const out = framed(SONAR, message.status);
      putDistances(out, message.distances, SONARS);
      return out;
    }
    case "facing": {
      const out = framed(FACING, message.status);
      putUnsigned(out, 2, message.heading, "heading");
      putSigned(out, 4, message.speed, "speed");
      return out;
    }
  }
}

export const codec: Codec<Message> = {
  decoder: () => new Decoder(),
  encode,
  counter: (event) => event.counter,
};
