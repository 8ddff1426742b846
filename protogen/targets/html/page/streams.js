/** Input through decoders: one for each direction, as far as names tell them apart. */

/** Times that are kept, though all events up to them have come. */
const KEPT = 4096;

/** The decoders of what endpoints send; `chosen` sends all that names nobody. */
export class Streams {
  constructor(codec, chosen, endpoints, { isDirected, told = {} }) {
    Object.assign(this, { codec, chosen, endpoints, isDirected, told, known: new Map() });
  }

  /** Take pieces that were gathered; `take(event, time)` is called for each event. */
  feed({ data, ends, times, names }, take) {
    for (let at = 0, start = 0; at < ends.length; start = ends[at - 1]) {
      const stream = this.of(names[at]);
      const begin = start;
      for (let name = names[at]; at < ends.length && (names[at] === name || this.of(names[at]) === stream); at++) {
        stream.note(ends[at] - start, times[at]);
        start = ends[at];
      }
      stream.pass(stream.decoder.feed(data.subarray(begin, start)), take);
    }
  }

  flush(take) {
    for (const stream of new Set(this.known.values())) stream.pass(stream.decoder.flush(), take);
  }

  /** The stream of pieces with that name. */
  of(name) {
    if (!this.known.has(name)) {
      const own = this.isDirected || !/^[RT]X$/.test(name) ? name : "";
      const endpoint = this.endpointOf(own);
      // Two directions are two streams, also where either side may have sent them.
      const others = [...this.known.values()];
      const same = others.find((it) => it.key === (endpoint || own));
      this.known.set(name, same ?? new Stream(this.codec, endpoint, endpoint || own, this.told));
    }
    return this.known.get(name);
  }

  /** The endpoint that a name says, of `TX` the one chosen, of `RX` the other. */
  endpointOf(name) {
    const { chosen, endpoints } = this;
    if (endpoints.includes(name)) return name;
    return name === "RX" && chosen && endpoints.length === 2 ? endpoints.find((item) => item !== chosen) : chosen;
  }
}

/** What one side sends: a decoder, and when its bytes came. */
class Stream {
  constructor(codec, endpoint, key, told) {
    this.decoder = new codec.Decoder(endpoint || undefined);
    this.decoder.tell(tellable(codec, endpoint, told));
    Object.assign(this, { key, size: 0, ends: [], times: [], at: 0 });
  }

  /** So many bytes came at a time. */
  note(count, time) {
    this.size += count;
    this.ends.push(this.size);
    this.times.push(time);
  }

  /** Give each event with the time of its last byte. */
  pass(events, take) {
    const { ends, times } = this;
    for (const event of events) {
      while (ends[this.at] < event.offset + event.size) this.at++;
      take(event, times[this.at]);
    }
    if (this.at < KEPT) return;
    [this.ends, this.times, this.at] = [ends.slice(this.at), times.slice(this.at), 0];
  }
}

/** The events of all that was gathered, in the order in which they end, each with its time. */
export function eventsOf(codec, given, chosen, endpoints, told) {
  const streams = new Streams(codec, chosen, endpoints, { isDirected: given.isDirected, told });
  const found = [];
  const take = (event, time) => found.push({ event, time });
  streams.feed(given, take);
  streams.flush(take);
  return found;
}

/** What can be told of the frames of an endpoint. */
function tellable(codec, name, told) {
  const senders = codec.protocol.senders(name || undefined);
  const known = new Set(senders.flatMap(({ frame }) => frame.told.map((part) => part.name)));
  return Object.fromEntries(Object.entries(told).filter(([part]) => known.has(part)));
}

/** True if one decoder can take what all endpoints send. */
export function takesAll(codec) {
  try {
    new codec.Decoder(undefined);
    return true;
  } catch {
    return false;
  }
}
