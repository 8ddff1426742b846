/** Pieces of input through decoders: one for each direction, as far as names tell them apart. */

/** The endpoint of each piece: that which it names, of `TX` the one chosen, of `RX` the other. */
export function endpointOf({ name }, chosen, endpoints) {
  if (endpoints.includes(name)) return name;
  return name === "RX" && chosen && endpoints.length === 2 ? endpoints.find((item) => item !== chosen) : chosen;
}

/** The events of all pieces in the order in which they end, each with the time of its last piece. */
export function eventsOf(codec, pieces, chosen, endpoints, told = {}) {
  const decoders = new Map();
  const found = [];
  for (const item of pieces) {
    const name = endpointOf(item, chosen, endpoints);
    // Two directions are two streams, also where either side may have sent them.
    const key = name || item.name;
    if (!decoders.has(key)) {
      decoders.set(key, new codec.Decoder(name || undefined));
      decoders.get(key).tell(tellable(codec, name, told));
    }
    const { time } = item;
    for (const event of decoders.get(key).feed(item.bytes)) found.push({ event, time });
  }
  for (const decoder of decoders.values()) {
    for (const event of decoder.flush()) found.push({ event, time: null });
  }
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
