// plots: lines over time, one chart a group of series. The cursor of all of them is the clock's frame; a press in one
// moves it. Lines of a second run are dashed. A press on a line's name hides the line; a chart can be enlarged, and saved as a
// picture (SVG) or as its numbers (CSV).
"use strict";
view.plots = (() => {
  const { el, svg, clear } = view.dom;
  const { within, ticks } = view.numbers;
  const SMALL = 116, LARGE = 340, LEFT = 60, RIGHT = 10, TOP = 8, BOTTOM = 20;

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

  const save = (title, ending, type, text) => view.dom.save(`${title.replace(/[^\w.-]+/g, "_")}.${ending}`, new Blob([text], { type }));
  const quoted = (word) => /[",\r\n]/.test(word) ? `"${word.replace(/"/g, '""')}"` : word;

  class Chart {
    // group: { title, unit, lines: [{ name, run, times, values }] }
    constructor(group, seek) {
      Object.assign(this, { group, width: 0, height: SMALL, hidden: new Set() });
      this.now = el("span", { class: "chart-now" });
      const tool = (text, title, onclick) => el("button", { class: "chart-tool", title, onclick }, text);
      this.tools = el("span", { class: "chart-tools" }, tool("⤢", "larger or smaller", () => this.grow()),
        tool("SVG", "save the chart as a picture", () => save(group.title, "svg", "image/svg+xml", this.picture())),
        tool("CSV", "save the numbers", () => save(group.title, "csv", "text/csv", this.numbers())));
      this.svg = svg("svg", { class: "chart", role: "img", "aria-label": group.title });
      this.node = el("figure", {}, el("figcaption", {}, el("span", { class: "chart-title" }, group.title,
        group.unit ? el("small", {}, group.unit) : null), this.key(), this.now, this.tools), this.svg);
      const drag = (e) => { if (e.buttons & 1) seek(this.timeAt(e.offsetX)); };
      this.svg.addEventListener("pointerdown", (e) => { this.svg.setPointerCapture(e.pointerId); drag(e); });
      this.svg.addEventListener("pointermove", drag);
      new ResizeObserver(() => this.draw()).observe(this.node);
    }

    key() {
      const own = this.group.lines.filter((line) => line.run === 0);
      return el("span", { class: "key" }, own.length > 1
        ? own.map((line, k) => el("button", { class: `key-item line-${k % 6}`, title: "show or hide", "aria-pressed": "true",
          onclick: (e) => e.currentTarget.setAttribute("aria-pressed", this.toggle(line.name)) }, line.name)) : null);
    }

    // Whether the lines of that name are shown now.
    toggle(name) {
      if (!this.hidden.delete(name)) this.hidden.add(name);
      this.draw();
      return !this.hidden.has(name);
    }

    shows(line) { return !this.hidden.has(line.name); }

    grow() {
      this.height = this.height === SMALL ? LARGE : SMALL;
      this.draw();
    }

    // Its SVG with the colours of the page's style written into it, so that other programs draw it alike.
    picture() {
      const copy = this.svg.cloneNode(true), into = copy.querySelectorAll("*");
      this.svg.querySelectorAll("*").forEach((from, k) => {
        const style = getComputedStyle(from);
        for (const name of ["stroke", "fill", "stroke-width", "stroke-dasharray", "font-size", "font-family"]) {
          into[k].setAttribute(name, style.getPropertyValue(name));
        }
        into[k].removeAttribute("class");
      });
      copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
      copy.setAttribute("width", this.width);
      copy.prepend(svg("title", {}, this.group.title + (this.group.unit ? `, ${this.group.unit}` : "")));
      return copy.outerHTML;
    }

    // A row for each time of each run, a column for each line, empty where a number is not known.
    numbers() {
      const names = [...new Set(this.group.lines.map((line) => line.name))], rows = [];
      for (const run of new Set(this.group.lines.map((line) => line.run))) {
        const lines = names.map((name) => this.group.lines.find((line) => line.run === run && line.name === name));
        const { times } = lines.find((line) => line);
        times.forEach((t, k) => rows.push([run + 1, t, ...lines.map((line) => line && Number.isFinite(line.values[k]) ? line.values[k] : "")]));
      }
      return [["run", "time (s)", ...names].map((word) => quoted(String(word))), ...rows].map((row) => `${row.join(",")}\n`).join("");
    }

    colourOf(line) { return this.group.lines.filter((l) => l.run === line.run).indexOf(line) % 6; }

    range() {
      let low = Infinity, high = -Infinity, begin = Infinity, end = -Infinity;
      for (const line of this.group.lines) {
        if (this.shows(line)) for (const v of line.values) if (v !== null && Number.isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); }
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
      const { low, high, begin, end } = this.bounds, inner = width - LEFT - RIGHT, bottom = this.height - BOTTOM;
      this.x = (t) => LEFT + (t - begin) / (end - begin) * inner;
      this.y = (v) => bottom - (v - low) / (high - low) * (bottom - TOP);
      clear(this.svg).setAttribute("viewBox", `0 0 ${width} ${this.height}`);
      this.svg.setAttribute("height", this.height);
      for (const t of ticks(low, high, this.height === SMALL ? 5 : 9)) this.svg.append(
        svg("line", { class: t.value === 0 ? "zero" : "grid", x1: LEFT, x2: width - RIGHT, y1: this.y(t.value), y2: this.y(t.value) }),
        svg("text", { x: LEFT - 6, y: this.y(t.value) + 3.5, "text-anchor": "end" }, t.text));
      for (const t of ticks(begin, end, Math.floor(inner / 70))) this.svg.append(
        svg("text", { x: this.x(t.value), y: this.height - 5, "text-anchor": "middle" }, t.text));
      for (const line of this.group.lines) if (this.shows(line)) this.svg.append(svg("path", {
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
        const known = value !== null && Number.isFinite(value) && this.shows(line);
        this.dots[j].setAttribute("visibility", known ? "visible" : "hidden");
        if (known) {
          this.dots[j].setAttribute("cx", x);
          this.dots[j].setAttribute("cy", this.y(value));
        }
        if (this.shows(line)) said.push(within(value, (this.bounds.high - this.bounds.low) * 1e-4));
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
