// plots: lines over time, one chart a group of series. The cursor of all of them is the clock's frame; a press in one
// moves it. Lines of a second run are dashed.
"use strict";
view.plots = (() => {
  const { el, svg, clear } = view.dom;
  const { within, ticks } = view.numbers;
  const HEIGHT = 116, LEFT = 60, RIGHT = 10, TOP = 8, BOTTOM = 20;

  // The least and the largest of each pixel column, so that no peak is lost.
  const path = (times, values, x, y, width) => {
    let text = "", pen = false, column = -1, low, high, lastY;
    const flush = () => {
      if (low === undefined) return;
      text += `${pen ? "L" : "M"}${column} ${y(low).toFixed(1)}`;
      if (high !== low) text += `L${column} ${y(high).toFixed(1)}`;
      if (lastY !== high) text += `L${column} ${y(lastY).toFixed(1)}`;
      pen = true;
    };
    const dense = times.length > 2 * width;
    for (let k = 0; k < times.length; k++) {
      const v = values[k];
      if (v === null || !Number.isFinite(v)) { if (dense) flush(); pen = false; low = undefined; column = -1; continue; }
      const at = dense ? Math.round(x(times[k])) : x(times[k]).toFixed(1);
      if (dense && at === column) {
        low = Math.min(low, v); high = Math.max(high, v); lastY = v;
        continue;
      }
      if (dense) flush();
      column = at; low = high = lastY = v;
      if (!dense) { text += `${pen ? "L" : "M"}${at} ${y(v).toFixed(1)}`; pen = true; }
    }
    if (dense) flush();
    return text;
  };

  class Chart {
    // group: { title, unit, lines: [{ name, run, times, values }] }
    constructor(group, seek) {
      Object.assign(this, { group, width: 0 });
      this.now = el("span", { class: "chart-now" });
      this.svg = svg("svg", { class: "chart", height: HEIGHT, role: "img", "aria-label": group.title });
      this.node = el("figure", {}, el("figcaption", {}, el("span", { class: "chart-title" }, group.title,
        group.unit ? el("small", {}, group.unit) : null), this.key(), this.now), this.svg);
      const drag = (e) => { if (e.buttons & 1) seek(this.timeAt(e.offsetX)); };
      this.svg.addEventListener("pointerdown", (e) => { this.svg.setPointerCapture(e.pointerId); drag(e); });
      this.svg.addEventListener("pointermove", drag);
      new ResizeObserver(() => this.draw()).observe(this.node);
    }

    key() {
      const own = this.group.lines.filter((line) => line.run === 0);
      return el("span", { class: "key" }, own.length > 1
        ? own.map((line, k) => el("span", { class: `key-item line-${k % 6}` }, line.name)) : null);
    }

    colourOf(line) { return this.group.lines.filter((l) => l.run === line.run).indexOf(line) % 6; }

    range() {
      let low = Infinity, high = -Infinity, begin = Infinity, end = -Infinity;
      for (const line of this.group.lines) {
        for (const v of line.values) if (v !== null && Number.isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); }
        if (line.times.length) { // a run that has just begun may have none
          begin = Math.min(begin, line.times[0]);
          end = Math.max(end, line.times[line.times.length - 1]);
        }
      }
      if (!(low <= high)) [low, high] = [0, 1];
      if (!(begin <= end)) [begin, end] = [0, 1];
      const size = Math.max(Math.abs(low), Math.abs(high));
      if (high - low <= 1e-12 * size) { low -= size * 0.1 || 1; high += size * 0.1 || 1; } // a constant but for rounding
      const margin = 0.06 * (high - low);
      return { low: low - margin, high: high + margin, begin, end: end > begin ? end : begin + 1 };
    }

    timeAt(px) {
      const { begin, end } = this.bounds, share = (px - LEFT) / (this.width - LEFT - RIGHT);
      return begin + Math.min(Math.max(share, 0), 1) * (end - begin);
    }

    draw() {
      const width = this.node.clientWidth;
      if (!width) return;
      this.width = width;
      this.bounds = this.range();
      const { low, high, begin, end } = this.bounds, inner = width - LEFT - RIGHT, bottom = HEIGHT - BOTTOM;
      this.x = (t) => LEFT + (t - begin) / (end - begin) * inner;
      this.y = (v) => bottom - (v - low) / (high - low) * (bottom - TOP);
      clear(this.svg).setAttribute("viewBox", `0 0 ${width} ${HEIGHT}`);
      for (const t of ticks(low, high, 5)) this.svg.append(
        svg("line", { class: t.value === 0 ? "zero" : "grid", x1: LEFT, x2: width - RIGHT, y1: this.y(t.value), y2: this.y(t.value) }),
        svg("text", { x: LEFT - 6, y: this.y(t.value) + 3.5, "text-anchor": "end" }, t.text));
      for (const t of ticks(begin, end, Math.floor(inner / 70))) this.svg.append(
        svg("text", { x: this.x(t.value), y: HEIGHT - 5, "text-anchor": "middle" }, t.text));
      for (const line of this.group.lines) this.svg.append(svg("path", {
        class: `line line-${this.colourOf(line)}${line.run ? " second" : ""}`, d: path(line.times, line.values, this.x, this.y, inner) }));
      this.cursor = svg("line", { class: "cursor", y1: TOP, y2: bottom });
      this.dots = this.group.lines.map((line) => svg("circle", { r: 3, class: `dot line-${this.colourOf(line)}` }));
      this.svg.append(this.cursor, ...this.dots);
      if (this.at) this.show(...this.at);
    }

    // k: the frame of each run at the clock's time
    show(t, k) {
      this.at = [t, k];
      if (!this.cursor) return;
      const x = this.x(Math.min(Math.max(t, this.bounds.begin), this.bounds.end));
      this.cursor.setAttribute("x1", x);
      this.cursor.setAttribute("x2", x);
      const said = [];
      this.group.lines.forEach((line, j) => {
        const value = line.values[Math.min(k[line.run], line.values.length - 1)];
        const known = value !== null && Number.isFinite(value);
        this.dots[j].setAttribute("visibility", known ? "visible" : "hidden");
        if (known) {
          this.dots[j].setAttribute("cx", x);
          this.dots[j].setAttribute("cy", this.y(value));
        }
        said.push(within(value, (this.bounds.high - this.bounds.low) * 1e-4));
      });
      this.now.textContent = said.length <= 4 ? said.join("   ") : "";
    }
  }

  // All charts of the groups, in the node; show(t, k) moves their cursors.
  const make = (node, groups, seek) => {
    const charts = groups.map((group) => new Chart(group, seek));
    clear(node).append(...charts.map((chart) => chart.node));
    return { show: (t, k) => charts.forEach((chart) => chart.show(t, k)), draw: () => charts.forEach((chart) => chart.draw()) };
  };

  return { make };
})();
