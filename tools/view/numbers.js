// numbers: numbers as people read them, and round steps for axes.
"use strict";
view.numbers = (() => {
  const exponents = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
  const power = (e) => `10${[...String(e)].map((c) => exponents[c]).join("")}`;

  // Some significant digits; powers of ten where the number is large or small.
  const short = (value, digits = 4) => {
    if (value === null || value === undefined || Number.isNaN(value)) return "–";
    if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
    const size = Math.abs(value);
    if (size !== 0 && (size < 1e-3 || size >= 1e5)) {
      const [mantissa, exponent] = value.toExponential(Math.max(digits - 2, 0)).split("e");
      const m = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
      const tail = power(Number(exponent));
      return (m === "1" ? tail : m === "-1" ? `−${tail}` : `${m}·${tail}`).replace("-", "−");
    }
    return String(Number(value.toPrecision(digits))).replace("-", "−");
  };

  // With as many digits as the error leaves.
  const within = (value, error) => {
    if (value === null || !(error > 0) || !Number.isFinite(value)) return short(value, 6);
    const digits = Math.floor(Math.log10(Math.abs(value) / error)) + 1;
    return digits < 1 ? "0" : short(value, Math.min(digits, 7));
  };

  // 1, 2 or 5 times a power of ten, so that about `count` of them cover the range.
  const step = (range, count) => {
    const raw = range / Math.max(count, 1);
    const base = 10 ** Math.floor(Math.log10(raw));
    return base * [1, 2, 5, 10].find((m) => m * base >= raw * (1 - 1e-9));
  };

  // Round numbers from low to high; `text` has as many digits as tell them apart.
  const ticks = (low, high, count) => {
    if (!(high > low)) return [];
    const d = step(high - low, count);
    const list = [];
    for (let k = Math.ceil(low / d - 1e-9); k * d <= high + 1e-9 * d; k++) list.push(k === 0 ? 0 : k * d);
    const most = Math.max(...list.map(Math.abs), d);
    const digits = Math.max(1, Math.floor(Math.log10(most)) - Math.floor(Math.log10(d) + 1e-9) + 1);
    const scientific = (value) => value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5);
    return list.map((value) => ({ value, text: short(value, scientific(value) ? digits + 1 : digits) }));
  };

  return { short, within, step, ticks };
})();
