// open: begins a page of recorded runs: its data are in the page.
"use strict";
(async () => {
  const pageData = JSON.parse(document.getElementById("page-data").textContent);
  await view.colours.load(pageData.shared);
  const sources = pageData.runs.map((run) => new view.recorded.Recorded(run));
  await Promise.all(sources.map((source) => source.ready));
  view.page = new view.app.App(sources, pageData);
})().catch(view.fail);
