// report: what the run says of itself: verdict with its reason, figures, what each plugin cost, warnings, parameters.
"use strict";
view.report = (() => {
  const { el } = view.dom;
  const { short } = view.numbers;
  const WORDS = { ok: "ok", inaccurate: "inaccurate", diverged: "diverged", interrupted: "interrupted" };

  const rows = (pairs) => el("dl", {}, pairs.filter((pair) => pair).map(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));
  const with_ = (value, text) => value === null || value === undefined ? null : text(value);
  const row = (name, value, unit) => with_(value, (v) => [name, `${short(v)}${unit ? ` ${unit}` : ""}`]);

  // Options of the command line are not broken in two.
  const whole = (text) => text.split(/(--\w+ [\w.+-]+)/).map((part, k) => k % 2 ? el("span", { class: "option" }, part) : part);

  // What options with a value are where there is no command line: settings of the scene, which have the same names.
  const settings = (text) => {
    const found = [...text.matchAll(/--(dt|tol|accuracy) ([\d.][\d.e+-]*)|--(integrator|solver) (\w+)/g)]
      .map(([, number, value, name, word]) => number ? `${number} = ${value}` : `${name} = "${word}"`);
    return [...new Set(found)].map((one) => `hooke.scene { ${one} }`);
  };
  const inScene = (text) => {
    const list = settings(text);
    return list.length ? el("p", { class: "in-scene" }, `In the scene: ${list.join(", or ")}`) : null;
  };

  const verdict = (s) => {
    if (!s) return el("div", { class: "verdict unknown" }, el("strong", {}, "no verdict"),
      el("p", {}, "The run has not ended, or was ended from outside: there is no summary.json in its folder."));
    return el("div", { class: `verdict ${WORDS[s.verdict] || "unknown"}` }, el("strong", {}, s.verdict),
      el("p", {}, whole(s.reason || s.checked || "")), inScene(s.reason || s.checked || ""));
  };

  const figures = (s) => rows([
    ["integrator", s.integrator + (s.solver ? `, ${s.solver}` : "")],
    row("particles", s.particles), row("steps", s.steps), s.step ? ["step", s.step] : null,
    row("energy drift", s.energy && s.energy.drift), row("momentum drift", s.momentum_drift),
    row("largest strain", s.max_strain), row("estimated error", s.error_estimate, "m"),
    row("error", s.exact_error, "m"), row("wall time", s.wall_s, "s"),
  ]);

  const costs = (s) => {
    const list = s.plugins.filter((p) => p.seconds > 0).sort((a, b) => b.seconds - a.seconds).slice(0, 12);
    if (!list.length) return null;
    const most = list[0].seconds;
    return el("section", {}, el("h2", {}, "Cost by plugin"), el("table", { class: "costs" }, list.map((p) => {
      const bar = el("span", { class: "cost-bar" });
      bar.style.width = `${100 * p.seconds / most}%`;
      return el("tr", {}, el("td", {}, p.label, p.label === p.name ? null : el("small", {}, p.name)), el("td", { class: "bar" }, bar),
        el("td", { class: "number" }, `${short(p.seconds, 3)} s`));
    })));
  };

  const warnings = (s) => s.warnings.length
    ? el("section", {}, el("h2", {}, "Warnings"), el("ul", { class: "warnings" }, s.warnings.map((w) => el("li", {}, w)))) : null;

  const parameters = (s) => {
    const list = Object.entries(s.origin || {}).filter(([what]) => /^the (parameter |seed$)/.test(what))
      .map(([what, value]) => [what.replace(/^the (parameter )?/, ""), value]);
    return list.length ? el("section", {}, el("h2", {}, "Parameters"), rows(list)) : null;
  };

  // What there is beside the verdict and the warnings.
  const details = (s) => s ? [figures(s), costs(s), parameters(s)] : null;

  return { verdict: (s) => [verdict(s), s ? warnings(s) : null], details };
})();
