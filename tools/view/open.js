// open: begins a page of recorded runs: its story is in the page.
"use strict";
(async () => {
  const story = JSON.parse(document.getElementById("story").textContent);
  await view.colours.load(story.colours);
  const sources = story.runs.map((run) => new view.recorded.Recorded(run));
  await Promise.all(sources.map((source) => source.ready));
  view.page = new view.app.App(sources, story);
})().catch(view.fail);
