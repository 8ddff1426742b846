/** Puts the page's parts to work. */
import * as codec from "./codec.js";
import { explained } from "./api.js";
import { DecodeView } from "./decode_view.js";
import { by } from "./dom.js";
import { EncodeView } from "./encode_view.js";
import { Explainer } from "./explain.js";
import { FileView } from "./file_view.js";
import { keep, stateIn } from "./links.js";
import { fromHex } from "./octets.js";
import { resolved } from "./plans.js";
import { startSearch } from "./search_view.js";
import { Tabs } from "./tabs.js";

const plans = resolved(JSON.parse(by("plans").textContent));
const explainer = new Explainer(plans, codec);
by("bench").hidden = false;
by("to-bench").hidden = false;
by("outline").open = globalThis.innerWidth >= 900;
startSearch(JSON.parse(by("entries").textContent));
const tabs = new Tabs(["decode", "encode", "file"]);
let isRestoring = false;
const decode = new DecodeView(explainer, (text, endpoint, told) => {
  // What is too long for an address is left out of it; lines of a log stay lines.
  const hex = text.length < 4000 ? text.replace(/[^\S\n]+/g, " ").trim() : "";
  if (!isRestoring) keep({ d: endpoint || "any", hex, ...told });
});

isRestoring = true;
const encode = new EncodeView(
  explainer,
  (event, time) => decode.event(event, time),
  (message, sender, hex) => isRestoring || keep({ m: message, s: sender, hex: hex.length < 4000 ? hex : "" }),
);
isRestoring = false;
new FileView(explainer, decode.endpoints, (hex, endpoint) => {
  tabs.open("decode");
  decode.set(hex, endpoint);
  by("bytes").focus();
});

function restore() {
  const state = stateIn(location.hash);
  if (!state) return;
  isRestoring = true;
  const side = state.get("d");
  if (side !== null) {
    tabs.open("decode");
    decode.set(state.get("hex") ?? "", side === "any" ? "" : side, state);
  }
  const message = state.get("m");
  if (message !== null) {
    tabs.open("encode");
    const sender = state.get("s") ?? undefined;
    encode.pick(message, sender);
    const hex = (state.get("hex") ?? "").replace(/[^0-9A-Fa-f]/g, "");
    if (hex) encode.load(message, encode.side?.endpoint, fromHex(hex));
  }
  isRestoring = false;
  by("bench").scrollIntoView();
}

globalThis.addEventListener("hashchange", restore);
restore();
globalThis.protogen = {
  encode,
  explain: (hex, endpoint) => explained(explainer, fromHex(hex), endpoint),
};
