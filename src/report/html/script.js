
"use strict";
// What goes wrong is written on the page, where a test finds it.
const wrong = (text) => { document.documentElement.dataset.error = text; };
addEventListener("error", (event) => wrong(event.message || "a picture does not load"), true);
addEventListener("securitypolicyviolation", (event) => wrong("blocked: " + event.violatedDirective));

for (const slider of document.querySelectorAll(".slider")) {
  const input = slider.querySelector("input");
  const move = () => slider.style.setProperty("--at", input.value + "%");
  input.addEventListener("input", move);
  move();
}
for (const button of document.querySelectorAll(".enlarge")) {
  button.addEventListener("click", () => {
    const wide = button.closest("figure").classList.toggle("wide");
    button.setAttribute("aria-expanded", String(wide));
    button.textContent = wide ? "reduce" : "enlarge";
  });
}
document.documentElement.dataset.ready = "yes";
