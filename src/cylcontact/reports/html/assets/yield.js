// First yield by von Mises in plane strain, of a pin in a hole of any two materials and of rollers of
// one, computed as src/cylcontact/laws/glauert.py, stress.py and yield_search.py do.
"use strict";

const Yield = (() => {
  // Terms of Glauert's series for the pressure, and nodes in half a turn of its angle v.
  const TERMS = 24, NODES = 192;
  // Points of the first search along the axis, of the others, and how many of these.
  const COARSE = 40, FINE = 7, PASSES = 5;
  const HALVINGS = 34;
  // tan(eps/2) of an arc for which Hertz's formulas hold, and of the largest that the series is for.
  const HERTZ_B = 1e-7, LARGEST_B = 20;

  const sum = (values) => values.reduce((total, value) => total + value, 0);
  const dot = (left, right) => sum(left.map((value, m) => value * right[m]));
  const each = (length, value) => Array.from({ length }, (_, m) => value(m));

  // Nodes in a quarter turn: Fejer's weights for functions of cos v times sin v dv, others for dv.
  const RULE = each(NODES / 2, (k) => {
    const v = ((k + 0.5) * Math.PI) / NODES;
    const part = sum(each(NODES / 2, (j) => Math.cos(2 * (j + 1) * v) / (4 * (j + 1) ** 2 - 1)));
    return {
      square: Math.cos(v) ** 2,
      fejer: (4 / NODES) * (1 - 2 * part),
      even: (2 * Math.PI * Math.sin(v)) / NODES,
      sines: each(TERMS, (m) => Math.sin((2 * m + 1) * v)),
      cosines: each(2 * TERMS, (j) => Math.cos(2 * j * v)),
    };
  });

  // Solve a symmetric system for several right sides by elimination; its diagonal dominates.
  function solved(rows, sides) {
    const system = rows.map((row, m) => [...row, ...sides.map((side) => side[m])]);
    const size = rows.length;
    for (let m = 0; m < size; m += 1) {
      for (let k = m + 1; k < size; k += 1) {
        const factor = system[k][m] / system[m][m];
        for (let j = m; j < system[k].length; j += 1) system[k][j] -= factor * system[m][j];
      }
    }
    return sides.map((_, side) => {
      const x = new Array(size).fill(0);
      for (let m = size - 1; m >= 0; m -= 1) x[m] = (system[m][size + side] - dot(x, system[m])) / system[m][m];
      return x;
    });
  }

  // The contact along the arc of b = tan(eps/2) by Galerkin's method, f/(E*dR) and the pressure p in
  // units of f/R: `at` is p as an analytic function on the axis and its falling slope in tau.
  function arcOf(b, { beta, w_i }) {
    const moments = each(2 * TERMS, () => 0), total = each(TERMS, () => 0), versine = each(TERMS, () => 0);
    for (const { square, fejer, even, sines, cosines } of RULE) {
      const y2 = b * b * square, density = (2 * b) / (1 + y2);
      for (let j = 0; j < 2 * TERMS; j += 1) moments[j] += fejer * density * cosines[j];
      for (let m = 0; m < TERMS; m += 1) {
        total[m] += even * density * sines[m];
        versine[m] += (2 * y2 * even * density * sines[m]) / (1 + y2);
      }
    }
    const carried = total.map((value, m) => value - versine[m]);
    const rows = each(TERMS, (m) => each(TERMS, (k) => (beta * Math.PI * (moments[Math.abs(m - k)] - moments[m + k + 1])) / 2
      - (m === k ? (Math.PI ** 2 / 2) * (2 * m + 1) : 0)));
    const [byLoad, byShift] = solved(rows, [carried.map((value) => (beta - 1) * value), total.map((value) => -value)]);
    const A = (1 - dot(carried, byLoad)) / dot(carried, byShift);
    const p = byLoad.map((value, m) => value + A * byShift[m]);
    const K = 2 * A - w_i * (1 + dot(p, versine));
    const signed = p.map((value, m) => (m % 2 ? -value : value));
    function at(tau) {
      const s = Math.hypot(b, tau), r = b / (tau + s);
      let F = 0, rate = 0;
      for (let m = TERMS - 1; m >= 0; m -= 1) {
        F = F * r * r + signed[m];
        rate = rate * r * r + (2 * m + 1) * signed[m];
      }
      return [F * r, (rate * r) / s];
    }
    // Beyond the largest arc no load is large enough.
    return { b, phi: K > 0 ? Math.PI / K : Infinity, at, mean: at(1)[0] };
  }

  // The equivalent stress on the axis in units of f/R, at w = (1 - tau)/(1 + tau): at the radius
  // R/w in the plate and w R in the pin.
  function equivalent(tau, { at, mean }, nu, body) {
    const [F, rate] = at(tau);
    const P = (F - mean) / 2, slope = ((1 + tau) ** 2 * rate) / 4;
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

  // The body that is nearer to yield along an arc, and its stress over the yield stress.
  function nearer(b, stresses, pair) {
    const arc = arcOf(b, pair), R = Math.sqrt(pair.R_i * pair.R_j), load = arc.phi * pair.E_star * pair.dR;
    const [hole, pin] = ["hole", "pin"].map((body) => {
      const { value, depth } = largest(arc, pair.ratios[body], body);
      return { load, body, depth: depth * R, share: (value * load) / (R * stresses[body]) };
    });
    return pin.share > hole.share ? pin : hole;
  }

  // The arc is sought by halving in ln b; no arc is larger than that of c = cos^2(eps/2) below.
  function inHole(stresses, pair) {
    const share = Math.max(pair.w_i + pair.beta, 0);
    const c = (0.9 * Math.sqrt(2 * share)) / (1 + 1.17 * Math.sqrt(share));
    let low = Math.log(HERTZ_B), high = Math.min(Math.log((1 - c) / c) / 2, Math.log(LARGEST_B));
    if (!(nearer(Math.exp(high), stresses, pair).share > 1)) return { load: NaN, depth: NaN, body: "" };
    for (let step = 0; step < HALVINGS; step += 1) {
      const middle = (low + high) / 2;
      if (nearer(Math.exp(middle), stresses, pair).share > 1) high = middle;
      else low = middle;
    }
    return nearer(Math.exp(low), stresses, pair);
  }

  // The load in N/mm, the body and the depth in mm, from the yield stresses of hole and pin in MPa;
  // for rollers by Hertz's stresses.
  function first(stresses, pair) {
    if (Number.isNaN(pair.R)) return { load: NaN, depth: NaN, body: "" };
    if (pair.contact === "internal") return inHole(stresses, pair);
    const hertz = arcOf(HERTZ_B, { beta: 0, w_i: 0.5 }), { value, depth } = largest(hertz, pair.ratios.pin, "pin");
    const load = (Math.PI * ((stresses.pin * hertz.at(0)[0]) / value) ** 2 * pair.R) / pair.E_star;
    const halfWidth = Laws.limits.hertzHalfWidth(load, pair);
    return { load, depth: (depth / (2 * HERTZ_B)) * halfWidth, body: "either roller" };
  }

  return { first };
})();
