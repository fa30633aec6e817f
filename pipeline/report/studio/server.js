// Requests to the studio's server (docs/studio.md#the-protocol).
const Server = (() => {
  'use strict';

  async function ask(path, body) {
    const reply = await fetch(path, { method: 'POST', headers: { 'X-Studio-Token': StudioToken, 'Content-Type': 'application/json' }, body: JSON.stringify(body) });
    if (reply.ok) return reply;
    let said = { error: `the studio answered ${reply.status}` };
    try { said = await reply.json(); } catch { /* no text */ }
    throw Object.assign(new Error(said.error), { status: reply.status, field: said.field });
  }
  const askJson = async (path, body) => (await ask(path, body)).json();

  return { ask, askJson };
})();
