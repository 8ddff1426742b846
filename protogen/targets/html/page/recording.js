/** A file of bytes or text, read in portions: of what was read, counts are kept, and no event. */
import { Gathered } from "./gathered.js";
import { dressOf, HEAD } from "./input.js";
import { Streams } from "./streams.js";
import { InputError } from "./tokens.js";

const PORTION = 1 << 17;
const MOST_SPANS = 100;
/** Bytes of an invalid span that can be looked at. */
const MOST_RAW = 64;

export class Recording {
  /** What the file holds is known by its first bytes. */
  static async of(file, endpoints) {
    const found = new Recording();
    const head = new Uint8Array(await file.slice(0, HEAD).arrayBuffer());
    Object.assign(found, { file, endpoints, dress: null, isDirected: false, why: "" });
    if (!isText(head)) return found;
    try {
      found.dress = dressOf(new TextDecoder().decode(head), endpoints, file.size <= HEAD);
      found.isDirected = found.dress.isDirected;
    } catch (error) {
      found.readRaw(error);
    }
    return found;
  }

  get form() {
    return `${this.dress?.form ?? "a raw recording"}${this.why}`;
  }

  /**
   * Decode the file into what `begin()` gives, which is returned: `take(event, time)` is called for
   * each event. `goesOn(place)` is asked at each portion of the file, and false ends it.
   *
   * It begins again where what the first lines said does not hold.
   */
  async read(codec, chosen, begin, goesOn) {
    for (;;) {
      const taker = begin();
      if (await this.pass(codec, chosen, taker, goesOn)) return taker;
    }
  }

  /** False: the file has to be read in another way. */
  async pass(codec, chosen, taker, goesOn) {
    const { file, dress } = this;
    const out = new Gathered();
    const reader = dress?.begin(out);
    const decoder = new TextDecoder();
    const streams = new Streams(codec, chosen, this.endpoints, this);
    const take = (event, time) => taker.take(event, time);
    Object.assign(taker, { out, size: 0 });
    for (let at = 0; at < file.size; at += PORTION) {
      const bytes = new Uint8Array(await file.slice(at, at + PORTION).arrayBuffer());
      if (!goesOn(at)) return true;
      const isLast = at + PORTION >= file.size;
      try {
        if (reader) reader.feed(decoder.decode(bytes, { stream: !isLast }), isLast);
        else out.whole(bytes);
      } catch (error) {
        this.readRaw(error);
        return false;
      }
      if (dress && out.isDirected !== this.isDirected && !this.isDirected) {
        this.isDirected = true;
        return false;
      }
      taker.size += out.size;
      streams.feed(out, take);
      out.clear();
    }
    goesOn(file.size);
    streams.flush(take);
    return true;
  }

  /** Protocols of printable bytes look like text, too. */
  readRaw(error) {
    if (!(error instanceof InputError)) throw error;
    [this.dress, this.isDirected, this.why] = [null, false, ` (as text, ${error.message})`];
  }
}

const isText = (head) =>
  head.length > 0 && head.subarray(0, 4096).every((byte) => (byte >= 0x20 && byte < 0x7f) || [9, 10, 13].includes(byte));

/** Counts of events, and the first spans that are no frame. */
export class Tally {
  counts = new Map();
  spans = [];
  invalid = 0;
  lost = 0;
  first = Infinity;
  last = -Infinity;

  take(event, time) {
    if (time !== null) {
      this.first = Math.min(this.first, time);
      this.last = Math.max(this.last, time);
    }
    const { kind, offset, size, reason } = event;
    if (kind === "invalid") {
      this.invalid++;
      this.lost += size;
      // The bytes are copied, so that what they lie in can be forgotten.
      if (this.spans.length < MOST_SPANS) this.spans.push({ offset, size, reason, raw: event.raw.slice(0, MOST_RAW) });
      return;
    }
    const name = kind === "message" ? event.message.message : "unknown";
    let own = this.counts.get(name);
    if (!own) this.counts.set(name, (own = { count: 0, bytes: 0 }));
    own.count++;
    own.bytes += size;
  }
}
