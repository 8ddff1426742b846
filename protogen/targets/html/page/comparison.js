/** Puts the page of two versions to work. */
import { codecs } from "./codecs.js";
import { ComparisonBench, showWitness } from "./comparison_view.js";
import { by } from "./dom.js";
import { Explainer } from "./explain.js";
import { resolved } from "./plans.js";

JSON.parse(by("versions").textContent).forEach(({ plans, endpoints }, at) => {
  const explainers = plans.map((item, side) => new Explainer(resolved(item), codecs[at][side]));
  const within = document.querySelector(`[data-versions="${at}"]`);
  for (const holder of within.querySelectorAll("[data-hex]")) showWitness(holder, explainers);
  new ComparisonBench(within.querySelector(".own > div"), explainers, endpoints);
});
