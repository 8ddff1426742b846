/** Tabs of the bench: arrows go from one to the next. */
import { by } from "./dom.js";

export class Tabs {
  constructor(names) {
    this.names = names;
    names.forEach((name, index) => {
      const tab = by(`tab-${name}`);
      tab.addEventListener("click", () => this.open(name));
      tab.addEventListener("keydown", (event) => {
        const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (!step) return;
        event.preventDefault();
        const next = names[(index + step + names.length) % names.length];
        this.open(next);
        by(`tab-${next}`).focus();
      });
    });
  }

  open(name) {
    for (const item of this.names) {
      const isOpen = item === name;
      by(item).hidden = !isOpen;
      by(`tab-${item}`).setAttribute("aria-selected", String(isOpen));
      by(`tab-${item}`).tabIndex = isOpen ? 0 : -1;
    }
  }
}
