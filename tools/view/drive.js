// drive: what the user of a live page does to the run: start, pause, single frames, stop, its pace, the hand, and values
// of the scene's parameters, which hold from the run's next frame on, or from its start where that is still to come.
"use strict";
view.drive = (() => {
  const { el } = view.dom;
  const { short } = view.numbers;
  const PACES = [["0", "as fast as it can"], ["1", "real time"], ["0.25", "a quarter"], ["0.05", "a twentieth"]];
  const STRENGTHS = [["0.1", "soft"], ["1", "firm"], ["10", "strong"], ["100", "very strong"]];
  const STEPS = 1000;

  const ACTS = "A value that is changed here acts from the run's next frame on, and its summary says so. Where only a start can have it (how "
    + "many particles there are, their masses), another run begins; where they are at the start is only seen after a restart.";

  const exact = (p, v) => p.type === "integer" ? Math.round(v) : Number(v.toPrecision(4));

  // A slider's place from 0 to STEPS and its value; over three powers of ten or more it is logarithmic.
  const scale = (p) => {
    const wide = p.min > 0 && p.max / p.min >= 1000, size = p.max - p.min;
    return wide
      ? { value: (s) => exact(p, p.min * (p.max / p.min) ** (s / STEPS)), place: (v) => STEPS * Math.log(v / p.min) / Math.log(p.max / p.min) }
      : { value: (s) => exact(p, p.min + size * s / STEPS), place: (v) => STEPS * (v - p.min) / (size || 1) };
  };

  const slider = (p, changed) => {
    const s = scale(p), said = el("output", {});
    const input = el("input", { type: "range", min: 0, max: STEPS, step: 1, title: p.help, "aria-label": p.name,
      oninput: () => { said.textContent = short(s.value(Number(input.value))); },
      onchange: () => changed(s.value(Number(input.value))) });
    return { nodes: [input, said], set: (v) => { input.value = s.place(Number(v)); said.textContent = short(Number(v)); } };
  };
  const number = (p, changed) => {
    const input = el("input", { type: "number", step: "any", title: p.help, "aria-label": p.name, onchange: () => {
      if (Number.isFinite(input.valueAsNumber)) changed(input.valueAsNumber);
    } });
    return { nodes: [input], set: (v) => { input.value = v; } };
  };
  const flag = (p, changed) => {
    const input = el("input", { type: "checkbox", title: p.help, "aria-label": p.name, onchange: () => changed(input.checked) });
    return { nodes: [input], set: (v) => { input.checked = String(v) === "true"; } };
  };
  const text = (p, changed) => {
    const input = el("input", { type: "text", title: p.help, "aria-label": p.name, onchange: () => changed(input.value) });
    return { nodes: [input], set: (v) => { input.value = v; } };
  };

  const widget = (p, changed) => {
    if (p.type === "boolean") return flag(p, changed);
    if (p.type === "string") return text(p, changed);
    const limited = typeof p.min === "number" && typeof p.max === "number" && p.min < p.max;
    return limited ? slider(p, changed) : number(p, changed);
  };

  class Drive {
    // hand: chosen(on)
    constructor(node, hand) {
      const { ask } = view.link, { select, check, button } = view.controls;
      this.state = null;
      this.said = el("p", { class: "doing" });
      this.start = button("start", "run again from the start, with the values below", () => this.again({}));
      this.pause = button("pause", "stop at the next frame, or go on", () => ask(this.state.doing === "paused" ? "go" : "pause"));
      this.step = button("step", "one frame", () => ask("step"));
      this.stop = button("stop", "end the run, with its verdict", () => ask("stop"));
      this.pace = "1";
      this.strong = "1";
      this.paces = select("Pace", "the run's time against the clock", PACES, this.pace, (v) => {
        this.pace = v;
        ask("pace", { pace: Number(v) });
      });
      this.values = el("div", { class: "values" });
      this.restarts = el("p", { class: "restarts", hidden: true });
      this.notice = el("p", { class: "notice", role: "status", hidden: true });
      node.append(this.said, this.notice, el("div", { class: "drive-buttons" }, this.start, this.pause, this.step, this.stop), this.values, this.restarts,
        el("div", { class: "drive-buttons" }, this.paces, select("Hand", "how strongly it pulls", STRENGTHS, this.strong,
          (v) => { this.strong = v; }), check("take hold", "a press on a particle takes it, as with Shift", false, hand)));
    }

    strength() { return Number(this.strong); }

    again(values) {
      view.link.ask("pace", { pace: Number(this.pace) });
      view.link.ask("start", { values });
    }

    // The widgets, from the scene's own list; made once.
    offer(parameters) {
      this.widgets = parameters.map((p) => {
        const w = widget(p, (value) => view.link.ask("change", { values: { [p.name]: value } }));
        this.values.append(el("label", { class: "value", title: p.help }, el("span", {}, p.name), ...w.nodes));
        return { p, w };
      });
    }

    show(state) {
      if (!this.widgets) this.offer(state.parameters);
      this.state = state;
      const values = state.values || {}, running = state.doing !== "ended";
      for (const { p, w } of this.widgets)
        if (!w.nodes.includes(document.activeElement) || state.run !== this.run) w.set(p.name in values ? values[p.name] : p.value);
      this.run = state.run;
      this.pause.textContent = state.waiting && running ? "start" : state.doing === "paused" ? "go on" : "pause";
      this.start.hidden = !!state.waiting && running;
      this.notice.textContent = state.notice || "";
      this.notice.hidden = !state.notice;
      this.restarts.textContent = ACTS;
      this.restarts.hidden = !this.widgets.length || this.start.hidden;
      for (const b of [this.pause, this.step, this.stop]) b.disabled = !running;
      this.start.textContent = running ? "restart" : "start";
      const doing = state.waiting && running ? "it waits at its first frame: start" : state.doing;
      this.showMessage(state.error ? state.error : doing, state.error);
    }

    // Whether the hand can pull; what has ended does not move, and that is said.
    pulls() {
      const ended = !this.state || this.state.doing === "ended";
      if (ended) this.showMessage("the run has ended, so that a pull moves nothing: start it again, then pull", true);
      return !ended;
    }

    showMessage(text, wrong) {
      this.said.textContent = text;
      this.said.className = wrong ? "doing wrong" : "doing";
    }
  }

  return { Drive };
})();
