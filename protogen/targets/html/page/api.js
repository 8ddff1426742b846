/** What the page does with bytes, as plain data: for its views, its console and its tests. */
import { titleOf, valueText } from "./explain.js";
import { hexOf } from "./octets.js";

/** The events of bytes, each with its title and the cells of its rows. */
export function explained(explainer, bytes, endpoint) {
  return explainer.events(bytes, endpoint).map((event) => {
    const rows = explainer.rows(event);
    return { title: titleOf(event, rows), rows: rows.map((item) => cellsOf(event, item)) };
  });
}

/** Offset, wire bytes or bits, unstuffed bytes, name, type, raw value, meaning and fault. */
export const cellsOf = (event, item) => [
  String(event.offset + item.offset),
  item.bits || hexOf(item.wire),
  hexOf(item.bytes),
  item.path,
  item.type,
  valueText(item.value),
  item.meaning,
  item.fault,
];

