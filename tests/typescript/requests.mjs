// What generated modules make of requests of the tests, in node and in browsers.

const bytes = (hex) => Uint8Array.from(hex.match(/../g) ?? [], (digits) => parseInt(digits, 16));
const digitsOf = (data) => Array.from(data, (byte) => byte.toString(16).padStart(2, "0")).join("");

/** A value of a request: bytes, integers of 64 bits and what JSON has no numbers for are marked. */
function valueOf(given) {
  if (Array.isArray(given)) return given.map(valueOf);
  if (given === null || typeof given !== "object") return given;
  if ("$bytes" in given) return bytes(given.$bytes);
  if ("$big" in given) return BigInt(given.$big);
  if ("$float" in given) return Number(given.$float);
  return Object.fromEntries(Object.entries(given).map(([key, item]) => [key, valueOf(item)]));
}

/** The lines of events of each step: bytes, or null for a silence. */
function decodeSteps(module, { sender, steps, told }) {
  const decoder = new module.Decoder(sender ?? undefined);
  if (told) decoder.tell(told);
  return steps.map((step) => {
    const events = step === null ? decoder.flush() : decoder.feed(bytes(step));
    return events.map((event) => module.jsonLine(event));
  });
}

function tried(module, act) {
  try {
    return { found: act() };
  } catch (error) {
    if (error instanceof module.EncodeError) return { path: error.path, problem: error.problem };
    if (error instanceof module.DecodeError) {
      const { reason, offset, path, problem } = error;
      return { reason, offset, path, problem };
    }
    throw error;
  }
}

/** The answer to a request, or to each of several. */
export function answer(module, request) {
  if (request.several) return request.several.map((item) => answer(module, item));
  if (request.steps) return decodeSteps(module, request);
  if (request.frame) {
    const options = { sender: request.sender ?? undefined, told: request.told ?? undefined };
    return tried(module, () => {
      const message = module.decode(bytes(request.frame), options);
      if (request.again === undefined) return null;
      const given = { ...options, parts: valueOf(request.again), strict: false };
      return digitsOf(module.encode(message, given));
    });
  }
  const { sender, form, strict, parts } = request;
  const options = { sender, form, strict, parts: valueOf(parts ?? {}) };
  return tried(module, () => digitsOf(module.encode(valueOf(request.message), options)));
}
