// Filters of the claims: by verdict, by section, by words.
"use strict";

(() => {
  const form = document.getElementById("claim-filters");
  if (!form) return;
  const claims = [...document.querySelectorAll(".claim")];
  const texts = new Map(claims.map((claim) => [claim, claim.textContent.toLowerCase()]));
  const countText = document.getElementById("claims-count");

  function apply() {
    const verdicts = new Set(
      [...form.querySelectorAll("input[name=verdict]:checked")].map((box) => box.value),
    );
    const section = form.elements.section.value;
    const words = form.elements.words.value.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    for (const claim of claims) {
      const fits = verdicts.has(claim.dataset.verdict)
        && (!section || claim.dataset.section === section)
        && words.every((word) => texts.get(claim).includes(word));
      claim.hidden = !fits;
      count += fits;
    }
    for (const group of document.querySelectorAll(".claim-group")) {
      group.hidden = !group.querySelector(".claim:not([hidden])");
    }
    countText.textContent = `${count} of ${claims.length} claims shown`;
  }
  form.addEventListener("input", apply);
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => setTimeout(apply));
  apply();
})();
