// begin: the name that all modules of the page share, and where failures are shown.
"use strict";
const view = {
  fail(error) {
    console.error(error);
    document.getElementById("note").textContent = `The page failed: ${error.message}`;
  },
};
