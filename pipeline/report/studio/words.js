// A scene as words of the command line, as the model of the studio's fields, and the numbers in it that
// have sliders.
const SceneWords = (() => {
  'use strict';

  const presets = [
    ['White paint', { substrate: ['lambert:0.05'], coat: ['TiO2,radius=0.13,volume=15% in PMMA@40um'], boundary: ['smooth'], 'missing-k-zero': [true] }],
    ['Haematite', { base: ['Fe2O3,radius=0.1'] }],
    ['Snow with soot', { base: ['H2O_ice,radius=200 + soot_diesel,radius=0.1,density=1.3,mass=1000ppb'] }],
    ['PTFE', { substrate: ['black'], coat: ['turbid:0.0005,150,0.9 in index:1.35@2mm'], boundary: ['smooth'] }],
    ['Gold on rutile', { base: ['TiO2,radius=0.2'], coat: ['Au,radius=0.03@0.5'], roughness: ['0.3'] }],
    ['Nothing, over black', { substrate: ['black'] }],
  ];

  // Words of the command line and back. Layers from the bottom up.
  function modelOf(words) {
    const first = (name) => (words[name] || [''])[0], known = ['base', 'substrate', 'coat', 'roughness', 'boundary', 'wavelengths', 'tolerance'];
    const split = (coat) => {
      const at = coat.lastIndexOf('@');
      return { words: coat.slice(0, at), depth: coat.slice(at + 1), on: true };
    };
    const more = Object.fromEntries(Object.entries(words).filter(([name]) => !known.includes(name)));
    return { below: words.substrate ? 'substrate' : 'base', bottom: first('substrate') || first('base'), layers: (words.coat || []).map(split),
      roughness: first('roughness'), boundary: first('boundary'), wavelengths: first('wavelengths') || '400:700:20', tolerance: first('tolerance'), more };
  }

  function wordsOf(m) {
    const words = { [m.below]: [m.bottom] }, on = m.layers.filter((l) => l.on);
    if (on.length) words.coat = on.map((l) => `${l.words}@${l.depth}`);
    for (const name of ['roughness', 'boundary', 'wavelengths', 'tolerance']) if (m[name] && m[name] !== '0') words[name] = [m[name]];
    return { ...words, ...m.more };
  }

  // Numbers of a medium that have a slider: where they stand in its words, and between what.
  const kinds = {
    radius: { label: 'Radius', unit: 'µm', min: 0.01, max: 1000, log: true }, variance: { label: 'Variance', min: 0.005, max: 1, log: true },
    volume: { label: 'Volume', min: 0.1, max: 70, log: true }, mass: { label: 'Mass', log: true }, number: { label: 'Number', log: true },
    density: { label: 'Density', unit: 'g/cm³', min: 0.1, max: 20, log: true },
  };
  const lists = {
    hg: [['Albedo', 0, 1], ['Asymmetry g', -0.99, 0.99]], isotropic: [['Albedo', 0, 1]], rayleigh: [['Albedo', 0, 1]], lambert: [['Albedo', 0, 1]],
    index: [['n', 1, 4], ['k', 1e-9, 10, true]], turbid: [['Absorption', 1e-6, 100, true], ['Reduced scattering', 1e-3, 1e4, true], ['Asymmetry g', -0.99, 0.99]],
  };
  const coatings = { '%': { min: 0.1, max: 100 }, nm: { min: 0.1, max: 1000 }, um: { min: 1e-4, max: 1 }, mm: {} };  // thickness of shells
  const NUMBER = '[-+]?(?:\\d+\\.?\\d*|\\.\\d+)(?:[eE][-+]?\\d+)?';
  function numbersOf(words) {
    const found = [];
    const add = (at, text, kind, unit = '') => {
      const value = Number(text);
      const range = kind.min === undefined ? { min: value / 100, max: value * 100 } : { min: Math.min(kind.min, value), max: Math.max(kind.max, value) };
      if (kind.log && !(value > 0)) return;
      found.push({ ...kind, ...range, at, length: text.length, value, unit: unit || kind.unit || '' });
    };
    for (const m of words.matchAll(new RegExp(`(${Object.keys(kinds).join('|')})=(${NUMBER})(%|um|nm|mm|ppm|ppb|ppt)?`, 'g')))
      add(m.index + m[1].length + 1, m[2], { ...kinds[m[1]], ...(m[1] === 'radius' && m[3] ? { min: undefined } : {}), ...(m[1] === 'volume' && m[3] !== '%' ? { min: 0.001, max: 0.7 } : {}) }, m[3]);
    for (const m of words.matchAll(new RegExp(`coating=([^@]*)@(${NUMBER})(%|um|nm|mm)`, 'g')))
      add(m.index + m[0].length - m[3].length - m[2].length, m[2], { label: `Coating of ${m[1]}`, ...coatings[m[3]], log: true }, m[3]);
    for (const m of words.matchAll(new RegExp(`\\b(${Object.keys(lists).join('|')}):(${NUMBER}(?:,${NUMBER})*)`, 'g'))) {
      let at = m.index + m[1].length + 1;
      m[2].split(',').forEach((text, i) => {
        const of = lists[m[1]][i];
        if (of) add(at, text, { label: of[0], min: of[1], max: of[2], log: of[3] });
        at += text.length + 1;
      });
    }
    // Of several species each number says whose it is.
    const starts = [...words.matchAll(/(?:^|\s\+\s)\s*([^\s,]+)/g)];
    if (starts.length > 1) {
      for (const one of found) {
        const [, name] = starts.findLast((m) => m.index <= one.at);
        one.label = `${name}: ${one.label.toLowerCase()}`;
      }
    }
    return found.sort((a, b) => a.at - b.at);
  }

  // The scene with {u1}, {u2}, ... in place of numbers that are free, and where their values belong.
  function freed(model) {
    const m = JSON.parse(JSON.stringify(model)), unknowns = {}, places = {};
    const bounds = (n) => (n.log ? `${n.value} in ${Math.max(n.min, n.value / 10)}:${Math.min(n.max, n.value * 10)} log` : `${n.value} in ${n.min}:${n.max}`);
    const add = (owner, key, found, where) => {
      const name = `u${Object.keys(unknowns).length + 1}`;
      unknowns[name] = bounds(found);
      places[name] = { ...where, label: found.label, unit: found.unit };
      owner[key] = `${owner[key].slice(0, found.at)}{${name}}${owner[key].slice(found.at + found.length)}`;
    };
    const words = (owner, key, layer) => numbersOf(owner[key]).map((n, i) => [n, i]).reverse().forEach(([n, i]) => {
      if (owner.free?.[`${key} ${i}`]) add(owner, key, n, { layer, key, index: i });
    });
    words(m, 'bottom', -1);
    m.layers.forEach((layer, i) => {
      if (!layer.on) return;
      words(layer, 'words', i);
      const held = /^[0-9.eE+-]+/.exec(layer.depth), value = held && Number(held[0]);
      if (layer.free?.depth && value > 0) add(layer, 'depth', { at: 0, length: held[0].length, value, min: value / 100, max: value * 100, log: true, label: 'Depth', unit: layer.depth.slice(held[0].length) }, { layer: i, key: 'depth' });
    });
    return { words: wordsOf(m), unknowns, places };
  }

  return { presets, modelOf, wordsOf, numbersOf, freed };
})();
