/** The state of the page in its address: `#m=gyro&hex=...`, `#d=esp&hex=...`. */

export function stateIn(hash) {
  const text = hash.replace(/^#/, "");
  return text.includes("=") ? new URLSearchParams(text) : null;
}

/** Put a state into the address, without a new entry of the history. */
export function keep(values) {
  const given = Object.entries(values).filter(([, value]) => value);
  const text = new URLSearchParams(given).toString();
  try {
    history.replaceState(null, "", `#${text}`);
  } catch {
    // A page may be shown where its address can't be changed; then it has no link.
  }
}
