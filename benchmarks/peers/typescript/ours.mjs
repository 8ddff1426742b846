// Generated code, as its users call it.

export function codec(module, { sender, counter }) {
  return {
    decoder: () => new module.Decoder(sender),
    encode: counter
      ? (message, value) => module.encode(message, { sender, parts: { [counter]: value } })
      : (message) => module.encode(message, { sender }),
    counter: (event) => (counter ? event.parts[counter] : null),
  };
}
