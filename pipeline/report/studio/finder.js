// The search for materials: names at once, then chips of their colours.
const Finder = (() => {
  'use strict';
  const $ = (id) => document.getElementById(id), { tag } = Panels, { askJson } = Server;

  // take: what a chosen name is for.
  async function find(take) {
    const text = $('studio-find').value.trim(), list = $('studio-found');
    if (!text) {
      list.replaceChildren();
      return;
    }
    const { materials } = await askJson('/api/materials', { text });
    if (text !== $('studio-find').value.trim()) return;
    list.replaceChildren(...materials.map((m) => {
      const one = tag('button', { type: 'button' });
      one.append(tag('span', { class: 'chip', 'data-chip': m.name, 'aria-hidden': 'true' }), tag('b', {}, m.name), ` ${m.title}, ${Math.round(m.from_nm)} to ${Math.round(m.to_nm)} nm${m.k_known ? '' : ', n alone'}`);
      one.addEventListener('click', () => take(m.name));
      return one;
    }));
    if (!materials.length) list.append(tag('p', { class: 'small' }, `nothing is called '${text}'`));
    await fillChips(list, materials.map((m) => m.name));
  }

  // Chips come after the names, some at a time: each is solved once, and kept.
  const chips = new Map();
  async function fillChips(list, names) {
    const CHIPS_AT_ONCE = 6;
    for (let first = 0; first < names.length; first += CHIPS_AT_ONCE) {
      const some = names.slice(first, first + CHIPS_AT_ONCE), unknown = some.filter((name) => !chips.has(name));
      if (unknown.length) Object.entries((await askJson('/api/chips', { names: unknown })).chips).forEach(([name, chip]) => chips.set(name, chip));
      for (const name of some) {
        const place = list.querySelector(`[data-chip="${CSS.escape(name)}"]`), chip = chips.get(name);
        if (!place) return;  // another list stands there by now
        if (!chip) continue;
        place.style.background = chip.hex;
        place.dataset.of = chip.of;
        place.closest('button').title = chip.of === 'mirror' ? 'the colour of its polished face' : 'the colour of much of it, spheres of 0.15 µm, in a binder';
      }
    }
  }

  return { find };
})();
