// link: what the page of a run under way has from the server, and what it asks of it. All addresses are below the page's
// own, which has the token.
"use strict";
view.link = (() => {
  const get = async (name) => {
    const answer = await fetch(name, { cache: "no-store" });
    if (!answer.ok) throw new Error(`${name.replace(/\?.*/, "")}: ${answer.status}`);
    return answer;
  };
  const json = async (name) => (await get(name)).json();
  const bytes = async (name) => (await get(name)).arrayBuffer();

  // Nothing is lost that matters: what is asked again would be too late.
  const ask = (what, more) => fetch("command", { method: "POST", headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ do: what, ...more }) }).catch(() => {});

  const pause = (ms) => new Promise((go) => setTimeout(go, ms));

  // Calls heard(state) for every version of the state that the page is ready for; lost(true) while nobody answers.
  const follow = async (heard, lost) => {
    let version = 0, missed = 0;
    for (;;) {
      try {
        const answer = await get(`state?after=${version}`);
        if (missed) lost(false);
        missed = 0;
        if (answer.status === 204) continue;
        version = answer.headers.get("Version");
        await heard(await answer.json());
      } catch (error) {
        if (!(error instanceof TypeError)) view.fail(error); // a TypeError is fetch's word for no answer
        if (++missed === 2) lost(true);
        await pause(Math.min(300 * missed, 5000));
      }
    }
  };

  return { json, bytes, ask, follow };
})();
