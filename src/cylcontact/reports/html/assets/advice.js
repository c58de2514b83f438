// Which law to use: what rules a law out at a pair and load, and how far each is from the reference.
// Pure functions from numbers to text; explore.js displays the text.
"use strict";

const Advice = (() => {
  const { number, percent } = Charts;

  // `now`: pair, load, contact, yields (from Yield.first), johnsonLoad; `off`: id of a law to its
  // distance from the truth in percent; `range` of the explicit law, `trained` of the enhanced.
  function advise(now) {
    const { pair, contact } = now;
    if (Number.isNaN(pair.R)) return noPair(pair, contact);
    const phi = now.load / (pair.E_star * pair.dR);
    const [from, to] = now.range;
    const inside = phi >= from && phi <= to;
    const beyond = now.load > now.yields.load;
    const best = pair.unlike ? "the parametric law"
      : inside ? "the explicit law" : contact === "internal" ? "Persson's solution" : "Johnson's law";
    return {
      tone: beyond ? "no" : "yes",
      title: beyond ? "Beyond yield: no elastic law holds" : `Use ${best}`,
      points: pair.unlike
        ? [ofYield(now, beyond), ofParametric(now, inside), ofModulusAlone(now), ofEnhanced(now)]
        : [ofYield(now, beyond), ofExplicit(now, inside), ofJohnson(now), ofEnhanced(now)],
    };
  }

  function noPair({ dR, R_i }, contact) {
    const why = contact === "internal"
      ? "a clearance ΔR as large as the hole's radius leaves no pin"
      : "the sum of the radii ΔR must be larger than the radius of one roller";
    return {
      tone: "no", title: "No such pair",
      points: [`ΔR = ${number(dR, 4)} mm and R_i = ${number(R_i, 4)} mm do not go together: ${why}.`],
    };
  }

  function ofYield({ yields: { load, depth, body } }, beyond) {
    const place = depth > 0 ? `${number(depth, 2)} mm below its surface` : "at its surface";
    if (Number.isNaN(load)) return "First yield is not computed here: the contact would nearly enclose the pin.";
    const where = `von Mises, in ${body === "either roller" ? body : `the ${body}`}, ${place}`;
    return `First yield (${where}) is at ${number(load, 4)} N/mm${beyond ? ": elastic laws do not hold beyond" : ""}.`;
  }

  const truthOf = ({ contact }) => (contact === "internal" ? "conformal contact" : "Johnson's law");

  function ofParametric({ off, range: [from, to] }, inside) {
    const where = inside ? "" : `; that is known for f/(E*ΔR) from ${from} to ${to}, not for this load`;
    return `The parametric law is within 0.06 % of conformal contact of any two materials${where}. The explicit-pair law, one line, is ${percent(off("explicit-pair"))} % from it.`;
  }

  // The laws that are used for want of one for two materials.
  function ofModulusAlone({ off, load, johnsonLoad }) {
    const johnson = load > johnsonLoad ? "Johnson's law has ended" : `Johnson's law is ${percent(off("johnson"))} % off`;
    return `The explicit law, which knows E* alone, is ${percent(off("explicit"))} % off; ${johnson}. Persson's solution is for one material.`;
  }

  function ofExplicit({ off, pair, range: [from, to] }, inside) {
    return inside
      ? `The explicit law differs by ${percent(off("explicit"))} % from ${truthOf(pair)}; it needs no iteration and has no largest load.`
      : `The explicit law was calibrated for f/(E*ΔR) from ${from} to ${to}; here it is extrapolated.`;
  }

  function ofJohnson({ off, contact, load, johnsonLoad }) {
    if (contact === "external") return "Johnson's law is the reference for rollers; one Lambert W gives the load.";
    if (load > johnsonLoad) return "Johnson's law has ended: the load is beyond its largest.";
    return `Johnson's law differs by ${percent(off("johnson"))} % from conformal contact${Math.abs(off("johnson")) > 5 ? ": do not use it" : ""}.`;
  }

  function ofEnhanced({ off, pair, trained }) {
    if (Number.isNaN(off("enhanced"))) return "The published enhanced law is undefined here.";
    return `The published enhanced law differs by ${percent(off("enhanced"))} % from ${truthOf(pair)}${pair.dR < trained ? `; it was fitted from ΔR = ${trained} mm on and is extrapolated` : ""}.`;
  }

  return { advise, truthOf };
})();
