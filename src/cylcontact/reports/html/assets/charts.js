// Charts in SVG, drawn at their width on the page so that the text keeps its size.
"use strict";

const Charts = (() => {
  const NS = "http://www.w3.org/2000/svg";
  const DASHES = ["", "7 4", "2 3", "10 3 2 3", "14 4", "4 2 1 2"];
  const SAMPLES = 181;

  function make(name, attributes, parent, text) {
    const node = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    if (text !== undefined) node.textContent = text;
    parent.append(node);
    return node;
  }

  function linear(from, to, low, high) {
    const at = (value) => low + ((value - from) / (to - from)) * (high - low);
    const values = [];
    const step = nice((to - from) / 5);
    for (let k = Math.ceil(from / step - 1e-9); k * step <= to * (1 + 1e-12); k += 1) values.push(k * step);
    return { at, values, from, to, sample: (k) => from + ((to - from) * k) / (SAMPLES - 1) };
  }
  function logarithmic(from, to, low, high) {
    const [a, b] = [Math.log(from), Math.log(to)];
    const at = (value) => low + ((Math.log(value) - a) / (b - a)) * (high - low);
    const values = [];
    for (let p = Math.ceil(a / Math.LN10 - 1e-9); p <= b / Math.LN10 + 1e-9; p += 1) values.push(10 ** p);
    return { at, values, from, to, sample: (k) => Math.exp(a + ((b - a) * k) / (SAMPLES - 1)) };
  }
  function nice(step) {
    const decade = 10 ** Math.floor(Math.log10(step));
    return [1, 2, 2.5, 5, 10].find((part) => part * decade >= step * 0.999) * decade;
  }

  // Axes with their grid; returns the scales and the layer for curves, clipped to the frame.
  function axes(svg, x, y, xLabel, yLabel) {
    svg.replaceChildren();
    const width = svg.clientWidth || 600, height = svg.clientHeight || 340;
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const box = { left: 58, right: width - 26, top: 22, bottom: height - 44 };
    const sx = x.scale(x.from, x.to, box.left, box.right);
    const sy = y.scale(y.from, y.to, box.bottom, box.top);
    const clip = `${svg.id}-clip`;
    make("rect", {
      x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top,
    }, make("clipPath", { id: clip }, make("defs", {}, svg)));
    let last = -Infinity;
    for (const value of sx.values) {
      const at = sx.at(value);
      make("line", { class: "grid", x1: at, x2: at, y1: box.top, y2: box.bottom }, svg);
      if (at - last > 44) {
        make("text", { x: at, y: box.bottom + 17, "text-anchor": "middle" }, svg, plain(value));
        last = at;
      }
    }
    for (const value of sy.values) {
      const at = sy.at(value);
      make("line", { class: "grid", x1: box.left, x2: box.right, y1: at, y2: at }, svg);
      make("text", { x: box.left - 7, y: at + 4, "text-anchor": "end" }, svg, plain(value));
    }
    const layer = make("g", { "clip-path": `url(#${clip})` }, svg);
    make("path", { class: "frame", d: `M${box.left} ${box.top}V${box.bottom}H${box.right}` }, svg);
    make("text", { class: "label", x: (box.left + box.right) / 2, y: height - 8, "text-anchor": "middle" }, svg, xLabel);
    make("text", { class: "label", x: 4, y: 13 }, svg, yLabel);
    return { sx, sy, box, layer, svg };
  }

  function curve(frame, points, slot, id) {
    let d = "", pen = false;
    for (const [x, y] of points) {
      const px = frame.sx.at(x), py = frame.sy.at(y);
      if (Number.isFinite(px) && Number.isFinite(py)) {
        d += `${pen ? "L" : "M"}${px.toFixed(2)} ${py.toFixed(2)}`;
        pen = true;
      } else pen = false;
    }
    make("path", {
      class: `curve c${slot % 6}`, "stroke-dasharray": dash(slot), d, "data-law": id,
    }, frame.layer);
  }
  const dash = (slot) => DASHES[slot % 6];

  function point(frame, x, y, slot) {
    if (!Number.isFinite(x) || !Number.isFinite(y)) return;
    make("circle", { class: `point c${slot % 6}`, r: 4.5, cx: frame.sx.at(x), cy: frame.sy.at(y) }, frame.layer);
  }

  // A line across the chart at a value of x or y, with a label on the given row.
  function mark(frame, axis, value, kind, word, row = 0) {
    const scale = axis === "x" ? frame.sx : frame.sy;
    if (!(value >= scale.from && value <= scale.to)) return;
    const at = scale.at(value), { box, layer } = frame;
    const ends = axis === "x"
      ? { x1: at, x2: at, y1: box.top, y2: box.bottom }
      : { x1: box.left, x2: box.right, y1: at, y2: at };
    make("line", { class: kind, ...ends }, layer);
    if (!word) return;
    const late = axis === "x" && at > box.right - 150;
    const place = axis === "x"
      ? { x: at + (late ? -6 : 6), y: box.top + 14 + 16 * row, "text-anchor": late ? "end" : "start" }
      : { x: box.right - 6, y: at - 5, "text-anchor": "end" };
    make("text", { class: "limit-text", ...place }, layer, word);
  }

  function shadeFrom(frame, axis, value) {
    const { box, sx, sy } = frame;
    const scale = axis === "x" ? sx : sy;
    if (!(value < scale.to)) return;
    const at = scale.at(Math.max(value, scale.from));
    const place = axis === "x"
      ? { x: at, y: box.top, width: box.right - at, height: box.bottom - box.top }
      : { x: box.left, y: box.top, width: box.right - box.left, height: at - box.top };
    make("rect", { class: "beyond", ...place }, frame.layer);
  }

  function plain(value) {
    if (value !== 0 && (Math.abs(value) >= 1e6 || Math.abs(value) < 1e-4)) return value.toExponential(0);
    // Thousands are separated from 10 000.
    return Number(value.toPrecision(6))
      .toLocaleString("en", { maximumFractionDigits: 6, useGrouping: Math.abs(value) >= 1e4 })
      .replaceAll(",", "\u2009").replace("-", "\u2212");
  }

  // Numbers as the page prints them: with a number of digits, or as signed percentages.
  function number(value, digits = 6) {
    if (value === Infinity) return "none";
    if (!Number.isFinite(value)) return "–";
    const size = Math.abs(value);
    if (size >= 1e7 || (size > 0 && size < 1e-4)) return value.toExponential(3).replace("-", "\u2212");
    return plain(Number(value.toPrecision(digits)));
  }
  const percent = (value) => (Number.isFinite(value)
    ? (Math.abs(value) < 0.005 ? "0.00" : (value > 0 ? "+" : "\u2212") + Math.abs(value).toFixed(Math.abs(value) < 100 ? 2 : 0)) : "–");

  return { axes, curve, dash, linear, logarithmic, make, mark, number, percent, plain, point, shadeFrom, SAMPLES };
})();
