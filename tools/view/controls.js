// controls: what is drawn and how it is coloured: the choices above the 3D view.
"use strict";
view.controls = (() => {
  const { el } = view.dom;

  const select = (label, title, options, chosen, change) => {
    const node = el("select", { title, onchange: () => change(node.value) },
      options.map(([value, text]) => el("option", { value, selected: value === chosen }, text)));
    return el("label", { class: "choice" }, el("span", {}, label), node);
  };
  const check = (label, title, on, change) => {
    const box = el("input", { type: "checkbox", checked: on, onchange: () => change(box.checked) });
    return el("label", { class: "check", title }, box, label);
  };
  const button = (text, title, press) => el("button", { title, onclick: press }, text);

  // One of several: buttons side by side.
  const choice = (title, options, chosen, change) => {
    const list = options.map(([value, text]) => el("button", { "aria-pressed": String(value === chosen), onclick: () => {
      list.forEach((b, k) => b.setAttribute("aria-pressed", options[k][0] === value));
      change(value);
    } }, text));
    return el("div", { class: "segmented", role: "group", "aria-label": title }, list);
  };

  return { select, check, button, choice };
})();
