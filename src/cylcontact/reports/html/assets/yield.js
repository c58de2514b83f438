// First yield by von Mises of two bodies of one material in plane strain, computed as
// src/cylcontact/stress.py and yield_search.py do, with the closed form of like bodies.
"use strict";

const Yield = (() => {
  // Points of the first search along the axis, of the others, and how many of these.
  const COARSE = 40, FINE = 7, PASSES = 5;
  const STEPS = 40;
  // tan(eps/2) of an arc for which Hertz's formulas hold.
  const HERTZ_B = 1e-7;

  // What depends on the arc alone, b = tan(eps/2): the peak pressure and its mean over the circle.
  function arcOf(b) {
    const square = b * b, B = Math.sqrt(1 + square), scale = Math.PI * square * B * B;
    return {
      b, square, B, scale, even: (2 * square) / (Math.PI * B),
      mean: square / (Math.PI * B * B) + Math.log1p(square) / (2 * scale),
      peak: (2 * b) / (Math.PI * B) + Math.asinh(b) / scale,
    };
  }

  // The equivalent stress on the axis in units of f/R, at w = (1 - tau)/(1 + tau): at the radius
  // R/w in the plate and w R in the pin.
  function equivalent(tau, { b, square, B, scale, even, mean }, nu, body) {
    const s = Math.hypot(b, tau), root = s + B * tau;
    const log = Math.log1p((square / (1 + B) + square / (s + tau)) / (1 + tau));
    const P = (even / root + log / scale - mean) / 2;
    const rate = (even * (tau / s + B)) / root ** 2
      + (s * B + square - tau) / (s * (B + s) * (1 + tau) * scale);
    const slope = ((1 + tau) ** 2 * rate) / 4;
    const w = (1 - tau) / (1 + tau), inside = (4 * tau) / (1 + tau) ** 2;
    let total, difference;
    if (body === "hole") {
      const q = (3 - 4 * nu) / (2 * Math.PI * (4 - 4 * nu));
      total = 4 * (q * w - P);
      difference = 2 * (w * inside * slope + (1 - inside) * (mean + 2 * q * w));
    } else {
      total = -2 * mean - 4 * P;
      difference = (2 * (slope - 1 / (2 * Math.PI)) * inside) / (w || 1e-9);
    }
    return Math.hypot((Math.sqrt(3) * difference) / 2, (0.5 - nu) * total);
  }

  // The largest equivalent stress of a body, and its depth in units of R.
  function largest(arc, nu, body) {
    let low = 0, high = Math.min(3 * arc.b, body === "hole" ? 0.9 : 3);
    let value, tau;
    for (let pass = 0, points = COARSE; pass <= PASSES; pass += 1, points = FINE) {
      const step = (high - low) / (points - 1), start = low;
      value = -1;
      for (let k = 0; k < points; k += 1) {
        const here = equivalent(start + k * step, arc, nu, body);
        if (here > value) [value, tau] = [here, start + k * step];
      }
      [low, high] = [Math.max(tau - step, start), Math.min(tau + step, high)];
    }
    return { value, depth: (2 * tau) / (body === "hole" ? 1 - tau : 1 + tau) };
  }

  // Steps with the slope 3/4 of ln(stress) over ln(load) converge from any start.
  function inBody(body, stress, pair) {
    const R = Math.sqrt(pair.R_i * pair.R_j), unit = pair.E_star * pair.dR;
    const strength = (stress * R) / unit, hertz = arcOf(HERTZ_B);
    const ratio = largest(hertz, pair.nu, body).value / hertz.peak;
    let phi = Math.min(Math.PI * (strength / ratio) ** 2, 2 * strength), at;
    for (let step = 0; step < STEPS; step += 1) {
      at = largest(arcOf(Laws.perssonHalfTangent(phi)), pair.nu, body);
      phi *= (strength / (phi * at.value)) ** (4 / 3);
    }
    return { load: phi * unit, depth: at.depth * R, body };
  }

  // The load in N/mm, the body and the depth in mm; for rollers by Hertz's stresses.
  function first(stress, pair) {
    if (Number.isNaN(pair.R)) return { load: NaN, depth: NaN, body: "" };
    if (pair.contact === "internal") {
      const [hole, pin] = ["hole", "pin"].map((body) => inBody(body, stress, pair));
      return pin.load < hole.load ? pin : hole;
    }
    const hertz = arcOf(HERTZ_B), { value, depth } = largest(hertz, pair.nu, "pin");
    const load = (Math.PI * ((stress * hertz.peak) / value) ** 2 * pair.R) / pair.E_star;
    const halfWidth = Laws.limits.hertzHalfWidth(load, pair);
    return { load, depth: (depth / (2 * HERTZ_B)) * halfWidth, body: "either roller" };
  }

  return { first };
})();
