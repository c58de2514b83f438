// The interactive page: controls to numbers, curves and advice.
"use strict";

(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const laws = data.laws.map((law) => ({
    ...law, compute: Laws.ofEntry(law),
  }));
  const form = document.getElementById("controls");
  const { number, percent } = Charts;
  const OWN = "", SAME = "same";
  const MATERIAL = {
    E: [1, 1000, 207, "log"], nu: [0, 0.49, 0.3, "linear"], yield_stress: [10, 5000, 250, "log"],
  };
  // The bodies by their select: the prefix of their sliders.
  const BODIES = { material: "", pin_material: "pin_" };
  const properties = (prefix) => Object.keys(MATERIAL).map((name) => prefix + name);
  const FIXED = {
    ...MATERIAL, ...Object.fromEntries(Object.entries(MATERIAL).map(([name, ends]) => [`pin_${name}`, ends])),
    R_i: [1, 500, 10, "log"], length: [1, 500, 10, "log"],
  };
  const values = Object.fromEntries(Object.entries(FIXED).map(([name, [, , start]]) => [name, start]));
  const selected = { internal: new Set(data.initial_laws), external: new Set(data.initial_laws) };
  let contact = "internal", truthId = data.truth.internal;

  // Sliders: a range of a thousand steps, linear or logarithmic, and a field for the exact number.
  const range = (name) => (name in FIXED ? FIXED[name] : [...data.controls[contact][name], "log"]);
  const toShare = ([low, high, , scale], value) => (scale === "log"
    ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low));
  const fromShare = ([low, high, , scale], share) => Number((scale === "log"
    ? low * (high / low) ** share : low + share * (high - low)).toPrecision(3));
  const parts = (name) => [document.getElementById(`${name}-range`), document.getElementById(name)];

  function place(name, exact = true) {
    const [slider, field] = parts(name);
    slider.value = String(Math.round(1000 * toShare(range(name), values[name])));
    slider.setAttribute("aria-valuetext", `${Charts.plain(values[name])} ${unit(name)}`);
    if (exact) field.value = String(values[name]);
    field.removeAttribute("aria-invalid");
  }
  const unit = (name) => document.querySelector(`[data-slider="${name}"] label span`).textContent;

  function listen(name) {
    const [slider, field] = parts(name);
    slider.addEventListener("input", () => {
      values[name] = fromShare(range(name), slider.value / 1000);
      changed(name, true);
    });
    field.addEventListener("input", () => {
      const number = Number(field.value);
      const bad = field.value === "" || !(name.endsWith("nu") ? number >= 0 && number <= 0.5 : number > 0);
      field.toggleAttribute("aria-invalid", bad);
      if (bad) {
        field.setAttribute("aria-invalid", "true");
        return;
      }
      values[name] = number;
      changed(name, false);
    });
    field.addEventListener("change", () => place(name));
  }
  function changed(name, exact) {
    for (const [select, prefix] of Object.entries(BODIES)) {
      if (properties(prefix).includes(name)) form.elements[select].value = OWN;
    }
    place(name, exact);
    update();
  }

  function fillMaterials() {
    form.elements.pin_material.add(new Option("same as the hole", SAME));
    for (const [name, prefix] of Object.entries(BODIES)) {
      const select = form.elements[name];
      for (const material of data.materials) select.add(new Option(material.name, material.name));
      select.add(new Option("own values", OWN));
      select.addEventListener("change", () => {
        takeMaterial(select.value, prefix);
        update();
      });
    }
    const first = materialOf("low-carbon steel") || data.materials[0];
    form.elements.material.value = first ? first.name : OWN;
    form.elements.pin_material.value = SAME;
    takeMaterial(form.elements.material.value, BODIES.material);
  }
  const materialOf = (name) => data.materials.find((each) => each.name === name);
  function takeMaterial(name, prefix) {
    const material = materialOf(name);
    if (!material) return;
    values[`${prefix}E`] = material.E / 1000;
    values[`${prefix}nu`] = material.nu;
    if (material.yield_stress !== null) values[`${prefix}yield_stress`] = material.yield_stress;
    for (const property of properties(prefix)) place(property);
  }
  function showOrigins() {
    const words = { E_GPa: ["E", "E", " GPa"], nu: ["nu", "ν", ""], yield_stress_MPa: ["yield_stress", "yield stress", " MPa"] };
    for (const [name, prefix] of Object.entries(BODIES)) {
      const { value } = form.elements[name], material = materialOf(value);
      const origin = document.getElementById(`${name}-origin`);
      origin.hidden = value === SAME;
      origin.textContent = material
        ? Object.entries(words).filter(([key]) => key in material.provenance)
          .map(([key, [own, word, suffix]]) => `${word} ${Charts.plain(values[prefix + own])}${suffix}: ${material.provenance[key]}`).join("; ")
        : "Your own values.";
    }
    document.getElementById("pin-sliders").hidden = form.elements.pin_material.value !== OWN;
  }
  function followHole() {
    if (form.elements.pin_material.value !== SAME) return;
    for (const name of Object.keys(MATERIAL)) {
      values[`pin_${name}`] = values[name];
      place(`pin_${name}`);
    }
  }
  // Modulus in MPa, Poisson's ratio and yield stress of a body; rollers are of one material.
  function bodyOf(prefix) {
    const [E, nu, stress] = properties(contact === "internal" ? prefix : "").map((name) => values[name]);
    return { E: 1000 * E, nu, stress };
  }

  const here = () => laws.filter((law) => law.contact === contact);
  function fillLaws() {
    const box = document.getElementById("laws");
    box.replaceChildren();
    for (const law of here()) {
      const label = document.createElement("label");
      const input = Object.assign(document.createElement("input"), {
        type: "checkbox", name: "law", value: law.id, checked: selected[contact].has(law.id),
      });
      input.addEventListener("change", () => {
        selected[contact][input.checked ? "add" : "delete"](law.id);
        update();
      });
      const text = document.createElement("span");
      text.textContent = law.label;
      if (law.formula) text.title = law.formula;
      label.append(input, newSwatch(law), text);
      box.append(label);
    }
  }
  function newSwatch(law) {
    const swatch = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    swatch.setAttribute("aria-hidden", "true");
    swatch.dataset.swatch = law.id;
    return swatch;
  }
  function drawSwatches(chosen) {
    document.getElementById("legend").replaceChildren(...chosen.map((law) => {
      const item = document.createElement("li");
      item.append(newSwatch(law), law.label);
      return item;
    }));
    for (const swatch of document.querySelectorAll("[data-swatch]")) {
      swatch.replaceChildren();
      const slot = chosen.findIndex((law) => law.id === swatch.dataset.swatch);
      if (slot < 0) continue;
      Charts.make("line", {
        class: `curve c${slot % 6}`, "stroke-dasharray": Charts.dash(slot), x1: 0, x2: 36, y1: 7, y2: 7,
      }, swatch);
    }
  }

  // The laws to measure the others by; the one for this pair is shown in place of the last one.
  function takeReference({ unlike }) {
    const last = truthId;
    truthId = data.truth[unlike ? "unlike" : contact];
    if (contact !== "internal" || last === truthId) return;
    if (selected.internal.delete(last)) selected.internal.add(truthId);
    fillLaws();
  }

  function compute() {
    const { dR, R_i, length, load } = values;
    const hole = bodyOf(""), pin = bodyOf("pin_");
    const pair = Laws.pairOf({ contact, E: hole.E, nu: hole.nu, pin, dR, R_i, length });
    takeReference(pair);
    const find = (id) => here().find((law) => law.id === id).compute;
    const johnson = find("johnson"), truth = find(truthId);
    const reference = johnson.penetration(load, pair), exact = truth.penetration(load, pair);
    const answers = here().filter((law) => selected[contact].has(law.id)).map((law) => {
      const penetration = law.compute.penetration(load, pair);
      return {
        law,
        penetration,
        stiffness: law.compute.stiffness(penetration, pair, load),
        difference: 100 * (penetration / reference - 1),
        error: 100 * (penetration / exact - 1),
        maxLoad: law.compute.maxLoad(pair),
      };
    });
    const yields = Yield.first({ hole: hole.stress, pin: pin.stress }, pair);
    return { pair, load, johnson, truth, answers, yields, johnsonLoad: Laws.limits.johnsonLoad(pair) };
  }

  const ofTwo = ({ alpha, beta, w_i, w_j }) => [
    ["alpha", "Dundurs' α", alpha, ""],
    ["beta", "Dundurs' β", beta, ""],
    ["w_i", "the hole's share of 1/E*", w_i, ""],
    ["w_j", "the pin's share of 1/E*", w_j, ""],
  ];
  function showNumbers(now) {
    const { pair, load } = now;
    const entries = [
      ["E_star", "composite modulus E*", pair.E_star, "MPa"],
      ...(pair.unlike ? ofTwo(pair) : []),
      ["R_j", contact === "internal" ? "radius of the pin" : "radius of the second roller", pair.R_j, "mm"],
      ["phi", "load number f/(E*ΔR)", load / (pair.E_star * pair.dR), ""],
      ["yield_load", "first yield, von Mises", now.yields.load, "N/mm"],
      ["johnson_load", "largest load of Johnson's law", now.johnsonLoad, "N/mm"],
      ["johnson_penetration", "penetration there", 1000 * Laws.limits.johnsonPenetration(pair), "µm"],
      ["hertz_stress", "peak pressure, Hertz", Laws.limits.hertzStress(load, pair), "MPa"],
      ["half_width", "half-width, Hertz", Laws.limits.hertzHalfWidth(load, pair), "mm"],
    ];
    document.getElementById("numbers").replaceChildren(...entries.map(([key, name, value, unitText]) => {
      const box = document.createElement("div");
      const term = Object.assign(document.createElement("dt"), { textContent: name });
      const detail = document.createElement("dd");
      detail.dataset.key = key;
      detail.dataset.value = String(value);
      detail.append(number(value, 5), " ", Object.assign(document.createElement("small"), { textContent: unitText }));
      box.append(term, detail);
      return box;
    }));
  }

  function showAnswers(now) {
    document.getElementById("truth-column").textContent = `against ${Advice.truthOf(now.pair)}, %`;
    const body = document.querySelector("#answers tbody");
    body.replaceChildren(...now.answers.map((answer) => {
      const row = document.createElement("tr");
      row.dataset.law = answer.law.id;
      const name = document.createElement("th");
      name.scope = "row";
      name.textContent = answer.law.label;
      const cells = [
        ["penetration", 1000 * answer.penetration, number(1000 * answer.penetration)],
        ["stiffness", answer.stiffness, number(answer.stiffness)],
        ["difference", answer.difference, percent(answer.difference)],
        ["error", answer.error, percent(answer.error)],
        ["max_load", answer.maxLoad, number(answer.maxLoad)],
      ].map(([key, value, text]) => {
        const cell = document.createElement("td");
        cell.dataset.key = key;
        cell.dataset.value = String(value);
        cell.textContent = text;
        return cell;
      });
      row.append(name, ...cells);
      return row;
    }));
  }

  // Collect the input of Advice.advise.
  function adviseHere(now) {
    const { pair, load, truth } = now;
    const exact = truth.penetration(load, pair);
    const off = (id) => {
      const law = here().find((each) => each.id === id);
      return law ? 100 * (law.compute.penetration(load, pair) / exact - 1) : NaN;
    };
    return Advice.advise({
      ...now, contact, off, range: data.explicit_range[contact], trained: data.trained_dR[contact][0],
    });
  }
  let waiting = 0;
  function showAdvice(now) {
    const { tone, title, points } = adviseHere(now);
    const box = document.getElementById("verdict");
    box.dataset.tone = tone;
    // Announce the advice when the slider stops, not at every step.
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      const heading = Object.assign(document.createElement("h2"), { textContent: title });
      const list = document.createElement("ul");
      list.append(...points.map((text) => Object.assign(document.createElement("li"), { textContent: text })));
      box.replaceChildren(heading, list);
    }, 150);
  }

  function drawForce(now) {
    const { pair, load, answers } = now;
    const deepest = Math.max(...answers.map((a) => a.penetration).filter(Number.isFinite), 1e-12);
    const log = document.querySelector("input[name=scale]:checked").value === "log";
    const make = log ? Charts.logarithmic : Charts.linear;
    const x = { scale: make, from: log ? deepest * 1e-3 * 1000 : 0, to: deepest * (log ? 10 : 1.5) * 1000 };
    const y = { scale: make, from: log ? load * 1e-3 : 0, to: load * (log ? 10 : 1.6) };
    const frame = Charts.axes(document.getElementById("force"), x, y, "penetration (µm)", "load (N/mm)");
    Charts.shadeFrom(frame, "y", now.johnsonLoad);
    answers.forEach(({ law }, slot) => {
      const points = [];
      const highest = Math.min(law.compute.maxLoad(pair), y.to);
      for (let k = 0; k < Charts.SAMPLES; k += 1) {
        const f = Math.min(frame.sy.sample(k), highest);
        points.push([1000 * law.compute.penetration(f, pair), f]);
        if (f === highest) break;
      }
      Charts.curve(frame, points, slot, law.id);
    });
    Charts.mark(frame, "y", load, "here");
    Charts.mark(frame, "y", now.yields.load, "limit", "yield");
    Charts.mark(frame, "y", now.johnsonLoad, "limit johnson", "end of Johnson's law");
    answers.forEach(({ penetration }, slot) => Charts.point(frame, 1000 * penetration, load, slot));
    document.getElementById("force-text").textContent = `At ${number(load, 4)} N/mm: `
      + answers.map((a) => `${a.law.label} ${number(1000 * a.penetration, 4)} µm`).join(", ");
  }

  function drawDifference(now) {
    const { pair, load, answers, johnson } = now;
    const [low, high] = data.controls[contact].load;
    const x = { scale: Charts.logarithmic, from: Math.min(low, load), to: Math.max(high, load) };
    const curves = answers.filter(({ law }) => law.id !== "johnson").map((answer) => {
      const points = [];
      const scale = Charts.logarithmic(x.from, Math.min(x.to, now.johnsonLoad), 0, 1);
      for (let k = 0; k < Charts.SAMPLES; k += 1) {
        const f = scale.sample(k);
        points.push([f, 100 * (answer.law.compute.penetration(f, pair) / johnson.penetration(f, pair) - 1)]);
      }
      return { ...answer, points };
    });
    // High enough for most of the curves and for every point; curves may diverge near the limits.
    const heights = curves.flatMap(({ points }) => points.map(([, value]) => Math.abs(value)))
      .filter(Number.isFinite).sort((a, b) => a - b);
    const most = heights[Math.floor(0.8 * heights.length)] || 0;
    const points = curves.map(({ difference }) => Math.abs(difference)).filter(Number.isFinite);
    const reach = 1.2 * Math.max(4, most, ...points);
    const y = { scale: Charts.linear, from: -reach, to: reach };
    const frame = Charts.axes(document.getElementById("difference"), x, y, "load (N/mm)", "difference (%)");
    Charts.shadeFrom(frame, "x", now.johnsonLoad);
    Charts.mark(frame, "y", 0, "frame");
    for (const { law, points } of curves) Charts.curve(frame, points, slotOf(answers, law), law.id);
    Charts.mark(frame, "x", load, "here");
    Charts.mark(frame, "x", now.yields.load, "limit", "yield", 0);
    Charts.mark(frame, "x", now.johnsonLoad, "limit johnson", "end of Johnson's law", 1);
    for (const { law, difference } of curves) Charts.point(frame, load, difference, slotOf(answers, law));
    document.getElementById("difference-text").textContent = `At ${number(load, 4)} N/mm: `
      + curves.map((a) => `${a.law.label} ${percent(a.difference)} %`).join(", ");
  }
  const slotOf = (answers, law) => answers.findIndex((answer) => answer.law === law);

  function update() {
    followHole();
    const now = compute();
    showOrigins();
    drawSwatches(now.answers.map(({ law }) => law));
    showNumbers(now);
    showAnswers(now);
    showAdvice(now);
    drawForce(now);
    drawDifference(now);
  }
  function switchContact() {
    contact = form.elements.contact.value;
    for (const name of ["dR", "load"]) {
      [, , values[name]] = range(name);
      place(name);
    }
    const words = contact === "internal" ? "Radial clearance ΔR" : "Sum of the radii ΔR";
    document.querySelector('[data-slider="dR"] label').firstChild.textContent = `${words} `;
    const body = contact === "internal" ? "hole" : "first roller";
    document.querySelector('[data-slider="R_i"] label').firstChild.textContent = `Radius of the ${body} `;
    document.getElementById("material-of").textContent = contact === "internal" ? "Material of the hole" : "Material of both rollers";
    document.getElementById("pin").hidden = contact === "external";
    fillLaws();
    update();
  }

  for (const name of [...Object.keys(FIXED), "dR", "load"]) listen(name);
  for (const name of Object.keys(FIXED)) place(name);
  for (const radio of form.elements.contact) radio.addEventListener("change", switchContact);
  for (const radio of document.querySelectorAll("input[name=scale]")) radio.addEventListener("change", update);
  form.addEventListener("submit", (event) => event.preventDefault());
  fillMaterials();
  // On a phone the list of laws starts closed, so that the results are near.
  document.getElementById("laws-list").open = matchMedia("(min-width: 62rem)").matches;
  switchContact();
  let frameWaiting = 0;
  addEventListener("resize", () => {
    cancelAnimationFrame(frameWaiting);
    frameWaiting = requestAnimationFrame(update);
  });
  addEventListener("beforeprint", update);
})();
