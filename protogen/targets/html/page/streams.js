/** Pieces of input through decoders: one for each direction, as far as names tell them apart. */

/** The endpoint of each piece, or the one that was chosen. */
const endpointOf = (item, chosen, endpoints) => (endpoints.includes(item.name) ? item.name : chosen);

/** The events of all pieces in the order in which they end, each with the time of its last piece. */
export function eventsOf(codec, pieces, chosen, endpoints, told = {}) {
  const decoders = new Map();
  const found = [];
  for (const item of pieces) {
    const name = endpointOf(item, chosen, endpoints);
    if (!decoders.has(name)) {
      decoders.set(name, new codec.Decoder(name || undefined));
      decoders.get(name).tell(tellable(codec, name, told));
    }
    const { time } = item;
    for (const event of decoders.get(name).feed(item.bytes)) found.push({ event, time });
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
