// Prints files of TypeScript or JavaScript as the compiler lays them out, without comments.
import { readFileSync } from "node:fs";
import ts from "typescript";

const printer = ts.createPrinter({ removeComments: true });
const found = process.argv.slice(2).map((path) => {
  const source = ts.createSourceFile(path, readFileSync(path, "utf8"), ts.ScriptTarget.Latest);
  return printer.printFile(source);
});
process.stdout.write(JSON.stringify(found));
