// Decodes and encodes with generated modules: a request a line, and a line for each answer.
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";
import { answer } from "./requests.mjs";

const modules = new Map();

async function load(path) {
  if (!modules.has(path)) modules.set(path, await import(pathToFileURL(path).href));
  return modules.get(path);
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
