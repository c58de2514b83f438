// Contact laws computed in the page from the JSON that Python exported: each law is a list of
// assignments in a small notation, with its coefficients. Units are mm, N and MPa throughout.
"use strict";

const Laws = (() => {
  const FUNCTIONS = {
    log: Math.log, log1p: Math.log1p, exp: Math.exp, sqrt: Math.sqrt, sin: Math.sin,
    cos: Math.cos, atan: Math.atan, max: Math.max,
  };
  const NUMBERS = { pi: Math.PI, nan: NaN, inf: Infinity };
  const BINDING = {
    "or": 1, "and": 2, "<": 3, "<=": 3, ">": 3, ">=": 3, "+": 4, "-": 4, "*": 5, "/": 5, "**": 7,
  };
  const OPERATIONS = {
    "or": (a, b) => a || b, "and": (a, b) => a && b,
    "<": (a, b) => a < b, "<=": (a, b) => a <= b, ">": (a, b) => a > b, ">=": (a, b) => a >= b,
    "+": (a, b) => a + b, "-": (a, b) => a - b, "*": (a, b) => a * b, "/": (a, b) => a / b,
    // JavaScript's ** takes NaN to the power of 0 for 1, and 1 to that of NaN for NaN; so does C.
    "**": (a, b) => a ** b,
  };
  const TOKEN = /\s*(\d+\.?\d*(?:e[+-]?\d+)?|\.\d+(?:e[+-]?\d+)?|[A-Za-z_]\w*|\*\*|[<>]=?|[-+*/(),])/gy;

  // Compile text to a function of the named values, without eval, so that data cannot run.
  function compile(text) {
    const tokens = tokenise(text);
    let at = 0;

    function conditional() {
      const value = binary(0);
      if (tokens[at] !== "if") return value;
      at += 1;
      const test = binary(0);
      expect("else");
      const other = conditional();
      return (names) => (test(names) ? value(names) : other(names));
    }
    function binary(least) {
      let left = unary();
      while (BINDING[tokens[at]] > least) {
        const operator = tokens[at];
        at += 1;
        // Powers alone group to the right.
        const right = binary(BINDING[operator] - (operator === "**" ? 1 : 0));
        const apply = OPERATIONS[operator], first = left;
        left = (names) => apply(first(names), right(names));
      }
      return left;
    }
    function unary() {
      if (tokens[at] !== "-") return atom();
      at += 1;
      const value = binary(BINDING["*"]); // binds less than a power, more than a product
      return (names) => -value(names);
    }
    function atom() {
      const token = tokens[at];
      at += 1;
      if (token === "(") {
        const inside = conditional();
        expect(")");
        return inside;
      }
      if (/^[\d.]/.test(token)) {
        const number = Number(token);
        return () => number;
      }
      if (tokens[at] === "(") return call(token);
      if (Object.hasOwn(NUMBERS, token)) return () => NUMBERS[token];
      return (names) => names[token];
    }
    function call(name) {
      if (!Object.hasOwn(FUNCTIONS, name)) throw new Error(`no function ${name}`);
      const values = [];
      do {
        at += 1;
        values.push(conditional());
      } while (tokens[at] === ",");
      expect(")");
      const apply = FUNCTIONS[name];
      return (names) => apply(...values.map((value) => value(names)));
    }
    function expect(token) {
      if (tokens[at] !== token) throw new Error(`${token} is missing in ${text}`);
      at += 1;
    }

    const whole = conditional();
    if (at !== tokens.length) throw new Error(`cannot read ${tokens[at]} in ${text}`);
    return whole;
  }

  function tokenise(text) {
    const tokens = [];
    TOKEN.lastIndex = 0;
    while (TOKEN.lastIndex < text.length) {
      const match = TOKEN.exec(text);
      if (!match) throw new Error(`cannot read ${text}`);
      tokens.push(match[1]);
    }
    return tokens;
  }

  // The lower branch of Lambert's W in x = -exp(-1 - g): W = -1 - w with w - ln(1 + w) = g >= 0.
  // Barry's closed-form start and Newton steps on w - ln(1 + w) - g.
  function lambertWm1(x) {
    if (!(x >= -1 / Math.E && x < 0)) return NaN;
    const g = -Math.log(-x) - 1;
    if (g <= 0) return -1;
    let w = g + Math.sqrt(2 * g);
    for (let step = 0; step < 50; step += 1) {
      const next = w - ((w - Math.log1p(w) - g) * (1 + w)) / w;
      if (!(next > 0) || Math.abs(next - w) <= 1e-16 * w) break;
      w = next;
    }
    return -1 - w;
  }

  // A law from its exported document: load and stiffness by penetration, penetration by load.
  // Johnson's takes the reach of unlike bodies in place of dR, which is all that it needs dR for.
  function exported(document, johnson = false) {
    const steps = document.steps.map((step) => {
      const cut = step.indexOf(" = ");
      return [step.slice(0, cut), compile(step.slice(cut + 3))];
    });
    const conditions = document.conditions.map(compile);
    const namesOf = (pair) => ({ ...document.constants, ...pair, ...(johnson && { dR: pair.reach_dR }) });

    function both(penetration, pair) {
      const names = { ...namesOf(pair), penetration };
      if (penetration < 0) return [0, 0];
      if (!conditions.every((holds) => holds(names))) return [NaN, NaN];
      for (const [name, value] of steps) names[name] = value(names);
      return [names.f, names.k];
    }
    const law = {
      load: (penetration, pair) => both(penetration, pair)[0],
      stiffness: (penetration, pair) => both(penetration, pair)[1],
    };
    const limit = steps.find(([name]) => name === "f_max");
    if (!limit) return { ...law, ...unlimited(both) };
    const { kappa, load_factor: B = 1, penetration_factor: D = 1 } = document.constants;
    return { ...law, ...logarithmic(kappa * D / B, (pair) => B * limit[1](namesOf(pair))) };
  }

  // Logarithmic laws, delta = kappa/(pi E*) f (ln(Lambda E*/f) + c), are explicit in the load:
  // Lambda E* e^c is e times the largest load, and the share of that keeps all digits near the end.
  function logarithmic(kappa, maxLoad) {
    const compliance = (pair) => kappa / (Math.PI * pair.E_star);
    function penetration(f, pair) {
      const highest = maxLoad(pair);
      if (!(f >= 0 && f <= highest)) return NaN;
      return f === 0 ? 0 : compliance(pair) * f * (Math.log(highest / f) + 1);
    }
    return { penetration, maxLoad, maxPenetration: (pair) => compliance(pair) * maxLoad(pair) };
  }

  // The other laws have no largest load; the limit is NaN where such a law is undefined.
  function unlimited(both) {
    const limit = (pair) => (Number.isNaN(both(pair.dR, pair)[0]) ? NaN : Infinity);
    return {
      penetration: (f, pair) => inverted(both, f, pair), maxLoad: limit, maxPenetration: limit,
    };
  }

  // The penetration at a load, for laws that grow without end: Newton's method on logarithms,
  // kept inside a bracket that always holds the root.
  function inverted(both, f, pair) {
    if (f === 0) return both(0, pair)[0] === 0 ? 0 : NaN;
    if (!(f > 0)) return NaN;
    let low = -60, high = 30; // of ln(delta/dR)
    let x = Math.log(f / (pair.E_star * pair.dR));
    for (let step = 0; step < 200; step += 1) {
      const delta = Math.exp(x) * pair.dR;
      const [value, stiffness] = both(delta, pair);
      if (Number.isNaN(value)) return NaN;
      const miss = Math.log(value / f);
      if (miss === 0) return delta;
      if (miss > 0) high = Math.min(high, x);
      else low = Math.max(low, x);
      const exponent = (stiffness * delta) / value;
      let next = x - miss / exponent;
      if (!(next > low && next < high)) next = (low + high) / 2;
      if (Math.abs(next - x) < 4e-16 * Math.max(1, Math.abs(x))) return Math.exp(next) * pair.dR;
      x = next;
    }
    return Math.exp(x) * pair.dR;
  }

  // Persson's conformal contact of like bodies, in the load; see laws/conformal.py for the formulas.
  // u = tan^2(eps/2) is found by Newton's method in the spread t = u/(U - u).
  const U = 0.8346152454776572;
  function perssonArc(t) {
    const left = U / (1 + t), u = t * left, ratio = left / (1 + u);
    const n = 2 * (U + u) + Math.log1p(ratio) / (ratio * (1 + u));
    return { u, v: 1 + u, log: Math.log1p(u), n, perLoad: n / (2 * Math.PI * (1 + u)) };
  }
  function perssonArcOfLoad(phi) {
    const small = 1 / (Math.PI * U), large = (4 * U + 1 / (1 + U)) / (2 * Math.PI * (1 + U));
    let t = phi * (large + (small - large) / (1 + 0.796 * phi));
    for (let step = 0; step < 3; step += 1) {
      const { u, v, log, n, perLoad } = perssonArc(t);
      t += (phi * perLoad - t) / (((1 + 2 * u) * (2 + u - log)) / (v * U * n));
    }
    return perssonArc(t);
  }
  const persson = {
    penetration(f, pair) {
      if (pair.unlike) return NaN;
      if (f === 0) return 0;
      if (!(f > 0)) return NaN;
      const { u, v, log } = perssonArcOfLoad(f / (pair.E_star * pair.dR));
      const common = Math.log(4) + log - Math.log(u) - (2 - 0.5 / v) / v;
      return (f / (Math.PI * pair.E_star)) * (common + log / (2 * u * v));
    },
    stiffness(_penetration, pair, f) {
      if (pair.unlike || !(f >= 0)) return NaN;
      if (f === 0) return 0;
      const { u, v, log } = perssonArcOfLoad(f / (pair.E_star * pair.dR));
      const common = Math.log(4) + log - Math.log(u) - (2 - 0.5 / v) / v;
      const top = (1 + u * v) * log - (1 - u) ** 2 * v;
      return (Math.PI * pair.E_star) / (common + top / (v ** 2 * (1 + v - log)));
    },
    maxLoad: (pair) => (pair.unlike ? NaN : Infinity),
    maxPenetration: (pair) => (pair.unlike ? NaN : Infinity),
  };

  // Any law of the page's data.
  const ofEntry = ({ document, johnson }) => (document ? exported(document, johnson) : persson);

  // E*, R, Dundurs' parameters and what the limits need; R is NaN where only dR is known. `pin`
  // is body j, of the same material if it is left out.
  function pairOf({ contact, E, nu, pin = { E, nu }, dR, R_i, length }) {
    const gap = contact === "internal" ? R_i - dR : dR - R_i;
    const R_j = gap > 0 ? gap : NaN;
    const modulus_i = E / (1 - nu * nu), modulus_j = pin.E / (1 - pin.nu * pin.nu);
    const total = modulus_i + modulus_j;
    const w_i = modulus_j / total, w_j = modulus_i / total;
    const part = (share, ratio) => (share * (1 - 2 * ratio)) / (2 - 2 * ratio);
    const alpha = w_j - w_i, beta = part(w_j, pin.nu) - part(w_i, nu);
    return {
      contact, dR, R_i, R_j, length, alpha, beta, w_i, w_j,
      ratios: { hole: nu, pin: pin.nu },
      unlike: pin.E !== E || pin.nu !== nu,
      E_star: (modulus_i / total) * modulus_j,
      R: (R_i * R_j) / dR,
      // Johnson's reach over 4 pi; known without the radii for bodies of equal moduli.
      reach_dR: alpha === 0 ? dR : dR * (R_i / R_j) ** -alpha,
    };
  }

  const limits = {
    // Eq 7: the peak of Hertz's pressure.
    hertzStress: (f, pair) => Math.sqrt((f * pair.E_star) / (Math.PI * pair.R)),
    hertzHalfWidth: (f, pair) => 2 * Math.sqrt((f * pair.R) / (Math.PI * pair.E_star)),
    // Eq 8.
    johnsonLoad: (pair) => (4 * Math.PI * pair.E_star * pair.reach_dR) / (Math.E * Math.E),
    johnsonPenetration: (pair) => (4 * pair.reach_dR) / (Math.E * Math.E),
  };

  // Johnson's load by Lambert's W, an independent check of the exported steps.
  function johnsonLoad(penetration, pair) {
    const x = (-Math.E * penetration) / (4 * pair.reach_dR);
    return (-Math.PI * pair.E_star * penetration) / lambertWm1(x);
  }

  return {
    compile, exported, inverted, johnsonLoad, lambertWm1, limits, ofEntry, pairOf,
  };
})();
