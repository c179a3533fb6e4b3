// editor: the script: a text area whose letters are drawn in colours below it, and the line of a fault.
"use strict";
hooke.editor = (() => {
  const KEYS = new Set(("and break do else elseif end false for function goto if in local nil not or repeat return then true until "
    + "while").split(" "));
  // Long brackets, comments, strings, numbers, words (Lua 5.4 manual, 3.1); what is none of them is plain.
  const TOKEN = /(--\[(=*)\[[\s\S]*?(?:\]\2\]|$)|--[^\n]*)|(\[(=*)\[[\s\S]*?(?:\]\4\]|$)|"(?:\\[\s\S]|[^"\\\n])*"?|'(?:\\[\s\S]|[^'\\\n])*'?)|(0[xX][\da-fA-F.]+|\d+\.?\d*(?:[eE][+-]?\d+)?)|([A-Za-z_]\w*)/g;

  const piece = (kind, text) => {
    if (!kind) return document.createTextNode(text);
    const node = document.createElement("span");
    node.className = kind;
    node.textContent = text;
    return node;
  };

  // Pieces of a line or of more, by kind.
  const pieces = (text) => {
    const list = [];
    let at = 0;
    for (const m of text.matchAll(TOKEN)) {
      const kind = m[1] ? "comment" : m[3] ? "string" : m[5] ? "number" : KEYS.has(m[6]) ? "key" : "";
      if (!kind) continue;
      if (m.index > at) list.push(["", text.slice(at, m.index)]);
      list.push([kind, m[0]]);
      at = m.index + m[0].length;
    }
    if (at < text.length) list.push(["", text.slice(at)]);
    return list;
  };

  // Lines, each a list of nodes: a piece over several lines is cut.
  const linesOf = (text) => {
    const lines = [[]];
    for (const [kind, part] of pieces(text))
      part.split("\n").forEach((line, k) => {
        if (k) lines.push([]);
        if (line) lines[lines.length - 1].push(piece(kind, line));
      });
    return lines;
  };

  class Editor {
    constructor(area, inked) {
      Object.assign(this, { area, inked, fault: 0 });
      area.addEventListener("input", () => { this.fault = 0; this.ink(); });
      area.addEventListener("scroll", () => this.follow());
      area.addEventListener("keydown", (e) => {
        if (e.key !== "Tab" || e.shiftKey || e.ctrlKey || e.metaKey || e.altKey) return;
        e.preventDefault();
        area.setRangeText("  ", area.selectionStart, area.selectionEnd, "end");
        this.ink();
      });
    }

    get text() { return this.area.value; }
    set text(text) {
      this.area.value = text;
      this.area.scrollTop = this.area.scrollLeft = 0;
      this.fault = 0;
      this.ink();
    }

    // The line of a fault, from 1; 0: none.
    mark(line) {
      this.fault = line;
      this.ink();
      const marked = this.inked.querySelector(".fault");
      if (marked) this.area.scrollTop = Math.max(0, marked.offsetTop - this.area.clientHeight / 2);
    }

    ink() {
      const lines = linesOf(this.text).map((nodes, k) => {
        const line = piece(k + 1 === this.fault ? "fault" : "line", "");
        line.append(...nodes, "\n");
        return line;
      });
      this.inked.replaceChildren(...lines);
      this.follow();
    }

    follow() {
      this.inked.scrollTop = this.area.scrollTop;
      this.inked.scrollLeft = this.area.scrollLeft;
    }
  }

  return { Editor };
})();
