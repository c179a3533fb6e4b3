// timeline: the buttons and the slider of the clock, and the keyboard.
"use strict";
view.timeline = (() => {
  const { el } = view.dom;
  const SPEEDS = [0.05, 0.1, 0.25, 0.5, 1, 2, 4];

  const icon = (path) => view.dom.svg("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" }, view.dom.svg("path", { d: path }));
  const PLAY = "M4 2.5v11l9.5-5.5z", PAUSE = "M4 2.5h3v11H4zM9 2.5h3v11H9z";

  const make = (node, clock) => {
    const button = el("button", { class: "play", title: "play or pause (space)", onclick: () => clock.play() });
    const slider = el("input", { type: "range", min: 0, max: clock.end, value: 0, step: 1, "aria-label": "frame",
      oninput: () => { clock.play(false); clock.seek(Number(slider.value)); } });
    const step = (by, text, title) => el("button", { title, onclick: () => { clock.play(false); clock.seek(clock.k + by); } }, text);
    const speed = el("select", { title: "speed", "aria-label": "speed", onchange: () => { clock.speed = Number(speed.value); } },
      SPEEDS.map((s) => el("option", { value: s, selected: s === 1 }, `${s}×`)));
    const loop = el("input", { type: "checkbox", onchange: () => { clock.loop = loop.checked; } });
    const time = el("output", { class: "time" });
    node.append(button, step(-1, "‹", "one frame back (left arrow)"), step(1, "›", "one frame on (right arrow)"), slider, time,
      speed, el("label", { class: "loop" }, loop, "loop"));

    let pressed = null;
    const press = () => {
      if (pressed === clock.playing) return; // a new icon would be laid out and drawn again, with every picture
      pressed = clock.playing;
      button.replaceChildren(icon(pressed ? PAUSE : PLAY));
      button.setAttribute("aria-pressed", pressed);
    };
    const update = () => {
      slider.max = clock.end;
      slider.value = clock.k;
      slider.style.setProperty("--done", `${100 * clock.k / Math.max(clock.end, 1)}%`);
      time.textContent = `${clock.source.time(clock.k).toFixed(3)} s · frame ${clock.k}`;
      press();
    };
    update();
    return { update };
  };

  const keys = (clock) => document.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || /^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName) && e.target.type !== "range") return;
    const leap = e.shiftKey ? 10 : 1;
    const act = { " ": () => clock.play(), ArrowLeft: () => clock.seek(clock.k - leap), ArrowRight: () => clock.seek(clock.k + leap),
      Home: () => clock.seek(0), End: () => clock.seek(clock.end) }[e.key];
    if (!act) return;
    e.preventDefault();
    if (e.key !== " ") clock.play(false);
    act();
  });

  return { make, keys };
})();
