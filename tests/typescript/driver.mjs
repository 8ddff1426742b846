// Decodes and encodes with generated modules: a request a line, and a line for each answer.
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";

const modules = new Map();

async function load(path) {
  if (!modules.has(path)) modules.set(path, await import(pathToFileURL(path).href));
  return modules.get(path);
}

const bytes = (hex) => Uint8Array.from(Buffer.from(hex, "hex"));

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

function answer(module, request) {
  if (request.steps) return decodeSteps(module, request);
  if (request.frame) {
    const options = { sender: request.sender ?? undefined, told: request.told ?? undefined };
    return tried(module, () => {
      const message = module.decode(bytes(request.frame), options);
      if (request.again === undefined) return null;
      const given = { ...options, parts: valueOf(request.again), strict: false };
      return Buffer.from(module.encode(message, given)).toString("hex");
    });
  }
  const { sender, form, strict, parts } = request;
  const options = { sender, form, strict, parts: valueOf(parts ?? {}) };
  return tried(module, () =>
    Buffer.from(module.encode(valueOf(request.message), options)).toString("hex"),
  );
}

for await (const line of createInterface({ input: process.stdin })) {
  const request = JSON.parse(line);
  let found;
  try {
    found = { answer: answer(await load(request.module), request) };
  } catch (error) {
    found = { error: String(error.stack ?? error) };
  }
  process.stdout.write(`${JSON.stringify(found)}\n`);
}
