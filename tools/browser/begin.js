// begin: the name that all scripts of the page share, and its packed parts.
"use strict";
window.hooke = {
  // gzip and base64 (make.lua).
  async unpack(id) {
    const bytes = Uint8Array.from(atob(document.getElementById(id).textContent.trim()), (c) => c.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  },
  async text(id) { return new TextDecoder().decode(await this.unpack(id)); },
};
