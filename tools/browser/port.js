// port: the view of a run inside of the page that runs it: what link.js has from a server is asked of that page.
"use strict";
window.view = view; // for the page
view.link = parent.hooke.page.linked();
document.querySelector("h1").textContent = parent.hooke.page.title;
