/** Elements of the page. Text becomes text, never markup. */

export const by = (id) => document.getElementById(id);

/** An element with attributes, handlers (`onclick`) and children; null children are left out. */
export function h(tag, attributes = {}, ...children) {
  const found = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) found.addEventListener(name.slice(2), value);
    else if (name in found && name !== "list" && name !== "form") found[name] = value;
    else found.setAttribute(name, value === true ? "" : value);
  }
  found.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return found;
}

export const show = (holder, ...children) =>
  holder.replaceChildren(...children.flat().filter((child) => child !== null && child !== undefined));

export const options = (names, chosen) =>
  names.map(([value, text]) => h("option", { value, selected: value === chosen }, text));

/** Call a function once, a little after the last of several calls. */
export function later(call, milliseconds = 120) {
  let timer = 0;
  return (...values) => {
    clearTimeout(timer);
    timer = setTimeout(() => call(...values), milliseconds);
  };
}

/** A button that copies a text, and says so. */
export function copyButton(what, text) {
  const button = h("button", { type: "button" }, `Copy ${what}`);
  button.addEventListener("click", async () => {
    button.textContent = (await copied(text())) ? `Copied ${what}` : `Can't copy ${what}`;
  });
  return button;
}

async function copied(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const field = h("textarea", { value: text });
    document.body.append(field);
    field.select();
    const isDone = document.execCommand("copy");
    field.remove();
    return isDone;
  }
}
