// dom: elements from names, attributes and children. Text becomes text nodes only, so that no name of a scene is ever
// read as markup.
"use strict";
view.dom = (() => {
  const SVG = "http://www.w3.org/2000/svg";

  const fill = (node, attributes, children) => {
    for (const [name, value] of Object.entries(attributes || {})) {
      if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
      else if (value !== undefined && value !== null && value !== false) node.setAttribute(name, value === true ? "" : value);
    }
    node.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
    return node;
  };

  return {
    el: (name, attributes, ...children) => fill(document.createElement(name), attributes, children),
    svg: (name, attributes, ...children) => fill(document.createElementNS(SVG, name), attributes, children),
    // Hands a file to the browser's downloads.
    save: (name, blob) => {
      const url = URL.createObjectURL(blob);
      fill(document.createElement("a"), { href: url, download: name }, []).click();
      setTimeout(() => URL.revokeObjectURL(url), 10000);
    },
    clear: (node) => { node.replaceChildren(); return node; },
  };
})();
