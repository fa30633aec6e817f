// The studio: the words of the scene as fields and sliders, and a server that solves them
// (docs/studio.md).
const Studio = (() => {
  'use strict';
  const $ = (id) => document.getElementById(id), { tag } = Panels, { ask, askJson } = Server;
  const { presets, modelOf, wordsOf, numbersOf, freed } = SceneWords;
  const tab = Math.random().toString(36).slice(2);
  const SOON_MS = 250;  // after the last change, the real solution is asked for

  let model, page = null, formats = [], chosen = null;
  let past = [], future = [];
  let failed = null;  // the field of the last refusal
  let kept = null;    // a solved scene that stays beside the one that is edited: { root, store }
  let dropped = null; // a measured file: { name, content, samples, values, sample, theta_in_deg }

  const short = (value) => String(Number(value.toPrecision(3)));

  // A slider, logarithmic where the thing is, with a field for its number.
  // free: where it is kept whether a fit may move the number.
  function slider(parent, { label, unit, min, max, log, value }, changed, free) {
    const box = tag('label', { class: 'control' }), head = tag('span', { class: 'label' }), name = tag('span', {}, unit ? `${label}, ${unit}` : label);
    const number = tag('input', { type: 'text', class: 'number', inputmode: 'decimal', 'aria-label': name.textContent, value: short(value) });
    const range = tag('input', { type: 'range', min: 0, max: 1, step: 0.002, 'aria-label': name.textContent });
    const toShare = (v) => (log ? Math.log(v / min) / Math.log(max / min) : (v - min) / (max - min));
    const fromShare = (s) => (log ? min * (max / min) ** s : min + s * (max - min));
    range.value = toShare(value);
    range.setAttribute('aria-valuetext', number.value);
    range.addEventListener('input', () => {
      number.value = short(fromShare(Number(range.value)));
      range.setAttribute('aria-valuetext', number.value);
      changed(number.value, false);
    });
    range.addEventListener('change', () => changed(number.value, true));
    number.addEventListener('change', () => {
      if (Number.isFinite(Number(number.value))) range.value = toShare(Number(number.value));
      changed(number.value, true);
    });
    head.append(name, number);
    box.append(head, range);
    if (free) {
      const all = free.owner.free ||= {}, press = button('fit', `let a fit move ${name.textContent}`, () => {
        all[free.name] = !all[free.name];
        press.setAttribute('aria-pressed', all[free.name]);
        drawMeasured();
      });
      press.classList.add('free');
      press.setAttribute('aria-pressed', Boolean(all[free.name]));
      head.insertBefore(press, number);
    }
    parent.append(box);
  }

  function mediumFields(card, owner, key, what) {
    const input = tag('input', { type: 'text', spellcheck: 'false', autocomplete: 'off', value: owner[key], 'aria-label': what });
    const sliders = tag('div');
    const drawSliders = () => {
      sliders.replaceChildren();
      numbersOf(owner[key]).forEach((found, i) => slider(sliders, found, (text, done) => {
        const now = numbersOf(owner[key])[i];
        if (!now) return;
        owner[key] = owner[key].slice(0, now.at) + text + owner[key].slice(now.at + now.length);
        input.value = owner[key];
        changed(done);
      }, { owner, name: `${key} ${i}` }));
    };
    input.addEventListener('focus', () => { chosen = { owner, key, input, drawSliders }; });
    input.addEventListener('change', () => {
      owner[key] = input.value.trim();
      drawSliders();
      changed(true);
    });
    card.append(input, sliders);
    drawSliders();
    if (!chosen) chosen = { owner, key, input, drawSliders };
  }

  function field(parent, owner, key, label, placeholder = '') {
    const box = tag('label', { class: 'field' }, label), input = tag('input', { type: 'text', value: owner[key], placeholder, spellcheck: 'false' });
    input.addEventListener('change', () => { owner[key] = input.value.trim(); changed(true); });
    box.append(input);
    parent.append(box);
    return input;
  }

  function choice(parent, label, choices, value, chose) {
    const box = tag('label', { class: 'field' }, label), select = tag('select', { style: 'width: 100%' });
    for (const [key, text] of choices) select.add(new Option(text, key));
    select.value = value;
    select.addEventListener('change', () => chose(select.value));
    box.append(select);
    parent.append(box);
  }

  function button(text, title, does, disabled = false) {
    const made = tag('button', { type: 'button', class: 'quiet', title, 'aria-label': title }, text);
    made.disabled = disabled;
    made.addEventListener('click', does);
    return made;
  }

  function draw() {
    chosen = null;
    const stack = $('studio-layers');
    stack.replaceChildren();
    const surface = tag('div', { class: 'layer' });
    surface.append(tag('span', { class: 'name' }, 'Surface'));
    const kind = model.boundary ? (model.boundary.startsWith('rough') ? 'rough' : 'smooth') : model.roughness && model.roughness !== '0' ? 'opaque' : 'none';
    choice(surface, 'What light meets first', [['none', 'nothing: bare particles'], ['smooth', 'smooth refracting boundary (varnish)'], ['rough', 'rough refracting boundary'], ['opaque', 'rough mirrors of the paper']], kind, (now) => {
      model.boundary = now === 'smooth' ? 'smooth' : now === 'rough' ? 'rough:0.2' : '';
      model.roughness = now === 'opaque' ? '0.3' : '';
      changed(true);
      draw();
    });
    if (kind === 'rough') slider(surface, { label: 'Slope parameter', min: 0.02, max: 1, log: true, value: parseFloat(model.boundary.slice(6)) || 0.2 }, (text, done) => {
      model.boundary = model.boundary.replace(/^rough:[^,]*/, `rough:${text}`);
      changed(done);
    });
    if (kind === 'opaque') slider(surface, { label: 'Slope parameter', min: 0.02, max: 1, log: true, value: parseFloat(model.roughness) || 0.3 }, (text, done) => {
      model.roughness = model.roughness.replace(/^[^,]*/, text);
      changed(done);
    });
    stack.append(surface);
    for (let i = model.layers.length - 1; i >= 0; --i) {
      const layer = model.layers[i], card = tag('div', { class: `layer${layer.on ? '' : ' off'}`, 'data-layer': i }), bar = tag('div', { class: 'bar' }), tools = tag('span', { class: 'tools' });
      const on = tag('input', { type: 'checkbox', 'aria-label': `layer ${i + 1} is there` });
      on.checked = layer.on;
      on.addEventListener('change', () => { layer.on = on.checked; changed(true); draw(); });
      const move = (by) => () => {
        model.layers.splice(i + by, 0, model.layers.splice(i, 1)[0]);
        changed(true);
        draw();
      };
      tools.append(on, button('↑', `layer ${i + 1} up`, move(1), i === model.layers.length - 1), button('↓', `layer ${i + 1} down`, move(-1), i === 0),
        button('×', `remove layer ${i + 1}`, () => { model.layers.splice(i, 1); changed(true); draw(); }));
      bar.append(tag('span', { class: 'name' }, `Layer ${i + 1}`), tools);
      card.append(bar);
      mediumFields(card, layer, 'words', `medium of layer ${i + 1}`);
      const depth = field(card, layer, 'depth', 'Depth: optical (0.5), or 40um, 2kg/m2, inf'), depthSlider = tag('div');
      const drawDepth = () => {
        const held = /^([0-9.eE+-]+)(.*)$/.exec(layer.depth);
        depthSlider.replaceChildren();
        if (!held || !(Number(held[1]) > 0)) return;
        slider(depthSlider, { label: held[2] && !held[2].startsWith('[') ? 'Thickness' : 'Optical depth', unit: held[2].replace(/^\[.*/, '').replace('um', 'µm'), min: Number(held[1]) / 100, max: Number(held[1]) * 100, log: true, value: Number(held[1]) }, (text, done) => {
          layer.depth = text + held[2];
          depth.value = layer.depth;
          changed(done);
        }, { owner: layer, name: 'depth' });
      };
      depth.addEventListener('change', drawDepth);
      drawDepth();
      card.append(depthSlider);
      stack.append(card);
    }
    const bottom = tag('div', { class: 'layer', 'data-layer': 'bottom' });
    bottom.append(tag('span', { class: 'name' }, 'Below everything'));
    choice(bottom, 'What lies there', [['base', 'a medium, infinitely deep'], ['substrate', 'a ground: black, none, lambert:0.5, mirror:Al']], model.below, (now) => {
      model.below = now;
      model.bottom = now === 'base' ? 'TiO2,radius=0.2' : 'lambert:0.5';
      changed(true);
      draw();
    });
    mediumFields(bottom, model, 'bottom', model.below === 'base' ? 'medium of the base' : 'ground');
    stack.append(bottom);
    const method = $('studio-method');
    method.replaceChildren();
    field(method, model, 'wavelengths', 'Wavelengths, nm');
    field(method, model, 'tolerance', 'Tolerance, of the largest value (1e-4 to 0.1); without one 0.01 for this page, 0.001 for what is downloaded', '0.01');
    const others = { text: Object.entries(model.more).map(([name, values]) => values.map((v) => (v === true ? name : `${name}=${v}`)).join('; ')).join('; ') };
    const input = field(method, others, 'text', 'Other words, with ; between them', 'host-index=1.33; missing-k-zero');
    input.addEventListener('change', () => {
      model.more = {};
      for (const word of input.value.split(';').map((w) => w.trim()).filter(Boolean)) {
        const at = word.indexOf('='), name = at < 0 ? word : word.slice(0, at);
        model.more[name] = [...(model.more[name] || []), at < 0 ? true : word.slice(at + 1)];
      }
      changed(true);
    });
    $('studio-undo').disabled = !past.length;
    $('studio-redo').disabled = !future.length;
  }

  // Every finished change is kept: here for undo, on the disk for tomorrow.
  let last = '';
  function changed(done) {
    if (done) {
      const now = JSON.stringify(model);
      if (now !== last) {
        past.push(last);
        if (past.length > 200) past.shift();
        future = [];
        last = now;
        save();
      }
      $('studio-undo').disabled = !past.length;
      $('studio-redo').disabled = !future.length;
    }
    solve(!done);
  }
  function step(from, to) {
    if (!from.length) return;
    to.push(last);
    last = from.pop();
    model = JSON.parse(last);
    draw();
    save();
    solve(false);
  }
  function save() {
    const { lampYaw, lampPitch, yaw, pitch, object, exposure, sky, surroundings, light, thetaIn, thetaOut, azimuth } = App.view;
    askJson('/api/save', { words: wordsOf(model), view: { model, camera: { lampYaw, lampPitch, yaw, pitch, object, exposure, sky, surroundings, light, thetaIn, thetaOut, azimuth } } }).catch(() => {});
  }

  // One request at a time while something is dragged; the server drops what a later one replaces.
  let running = false, waiting = false, timer = 0, number = 0;
  const latency = [];
  function solve(preview) {
    clearTimeout(timer);
    if (!preview) {
      waiting = false;  // no preview may come after the solution
      send(false);
      return;
    }
    timer = setTimeout(() => solve(false), SOON_MS);
    if (running) waiting = true;
    else send(true);
  }
  async function send(preview) {
    const mine = ++number, began = performance.now(), words = wordsOf(model);
    running = true;
    status(preview ? '' : 'solving ...');
    try {
      const reply = await askJson('/api/solve', { words, preview, tab });
      if (mine === number) {
        await show(reply, words);
        latency.push([preview, performance.now() - began]);
        document.body.dataset.solved = mine;
      }
    } catch (error) {
      // Requests may overtake each other: the last one must not be the one that the server drops.
      if (mine === number && error.status === 409) {
        send(preview);
        return;
      }
      if (mine === number) refuse(error);
    }
    if (mine !== number) return;
    running = false;
    if (waiting) {
      waiting = false;
      send(true);
    }
  }

  let touched = null;  // the field that was changed last
  const status = (text) => { if (text) $('studio-status').textContent = text; };
  function refuse(error) {
    failed = error.field || '';
    $('studio-error').hidden = false;
    $('studio-error').textContent = error.message || 'the studio does not answer: has it ended?';
    status('the last scene that could be solved is shown');
    document.body.dataset.refused = number;
    if (error.status === 422 && touched?.isConnected) {
      touched.classList.add('wrong');
      touched.setAttribute('aria-invalid', 'true');
    }
  }

  const parts = ['controls', 'objects', 'picture-controls', 'readouts', 'difference', 'direction-controls', 'point-charts', 'lobe-controls', 'lobes', 'polar', 'albedo-charts', 'swatches', 'media-charts', 'facts'];
  let shape = '';
  async function show({ data, preview, seconds, shortfalls }, words) {
    current = { ...await Data.load(data), words, drawdown: current?.drawdown };
    $('studio-error').hidden = true;
    for (const wrong of document.querySelectorAll('#studio .wrong')) {
      wrong.classList.remove('wrong');
      wrong.removeAttribute('aria-invalid');
    }
    document.body.classList.toggle('preview', preview);
    await drawPage();
    drawDown(preview);
    const poor = shortfalls.length ? `; not converged: ${shortfalls[0]}` : '';
    status(`${preview ? 'preview' : 'solved'} in ${seconds < 1 ? `${Math.round(1e3 * seconds)} ms` : `${seconds.toFixed(1)} s`}${poor}`);
  }

  let current = null;  // the last solution: { root, store }
  async function drawPage() {
    const scenes = [current, ...(kept ? [kept] : [])], [scene] = current.root.scenes;
    const root = { ...current.root, scenes: scenes.map((s, i) => (i ? { ...s.root.scenes[0], name: `kept: ${s.root.scenes[0].name}` } : s.root.scenes[0])) };
    const stores = scenes.map((s) => s.store), now = JSON.stringify(root.scenes.map((s) => [s.wavelength_nm, Boolean(s.illuminants)]));
    if (page && now === shape) {
      page.replace(root, stores);
      page.update();
    } else {
      parts.forEach((id) => $(id).replaceChildren());
      page = App.build(root, stores);
      shape = now;
      await page.drawn;
      $('title').textContent = root.scenes.map((s) => s.name).join(' beside ');
      document.body.dataset.ready = Math.round(performance.now());
    }
    page.scenes.forEach((each, i) => { each.drawdown = scenes[i].drawdown; });
    const had = page.scenes[0].measured?.length;
    const within = (nm) => nm >= scene.wavelength_nm[0] - 1 && nm <= scene.wavelength_nm[scene.wavelength_nm.length - 1] + 1;
    page.scenes[0].measured = dropped ? pointsOf(dropped).map((m) => ({ ...m, x: m.x.filter(within), y: m.y.filter((_, i) => within(m.x[i])) })) : [];
    if (dropped || had) page.changed('point', 'albedo');
    drawColours();
  }

  // The film on a contrast chart, where that is what is shown, of the scene and of the kept one. The one
  // before stays until the next is there.
  let asked = 0;
  async function drawDown(preview) {
    if (App.view.object !== 'drawdown' || !page) return;
    const mine = ++asked, light = App.view.light;
    const ask = async (words, quickly) => ({ light, preview: quickly, ...await askJson('/api/drawdown', { words, preview: quickly, light, tab: `${tab} drawdown` }) });
    try {
      const found = await ask(current.words, preview), other = kept && kept.drawdown?.light !== light ? await ask(kept.words, false) : kept?.drawdown;
      current.drawdown = found;  // of the solution that stands there by now
      if (kept) kept.drawdown = other;
    } catch (error) {
      if (mine !== asked) return;
      if (error.status === 409) {
        drawDown(preview);
        return;
      }
      current.drawdown = { light, why: error.message };
    }
    page.scenes.forEach((scene, i) => { scene.drawdown = (i ? kept : current).drawdown; });
    page.changed('picture');
    document.body.dataset.drawnDown = `${mine}${preview ? ' preview' : ''}`;
  }

  // All layers as many times as deep.
  function deepen(times) {
    for (const layer of model.layers) if (layer.on) layer.depth = layer.depth.replace(/^[0-9.eE+-]+/, (text) => String(Number((times * text).toPrecision(3))));
    draw();
    changed(true);
  }

  // Values of the chosen sample, one list for each chart that can show them.
  function pointsOf({ name, samples, values, sample }) {
    const lists = { albedo: [[], []], brdf: [[], []], through: [[], []] };
    for (const v of values) {
      if (v.sample !== sample || v.wavelength_nm === null || v.value === null) continue;
      const chart = { reflectance: 'albedo', transmittance: 'through', brdf: 'brdf', reflectance_factor: 'brdf' }[v.quantity];
      if (!chart) continue;
      lists[chart][0].push(v.wavelength_nm);
      lists[chart][1].push(v.quantity === 'reflectance_factor' ? v.value / Math.PI : v.value);
    }
    return Object.entries(lists).filter(([, [x]]) => x.length).map(([chart, [x, y]]) => ({ chart, x, y, name: `measured: ${samples[sample] || name}` }));
  }

  // The measured file: what it holds, and a fit of the numbers that are free.
  function drawMeasured() {
    const box = $('studio-measured');
    box.replaceChildren();
    const free = freed(model), count = Object.keys(free.unknowns).length;
    if (!dropped) return;
    if (dropped.samples.length > 1) {
      choice(box, 'Sample', dropped.samples.map((s, i) => [i, s || `${i + 1}`]), dropped.sample, (now) => {
        dropped.sample = Number(now);
        drawPage();
      });
    }
    const bar = tag('div', { class: 'bar' }), fit = button(count ? `Fit ${count} number${count > 1 ? 's' : ''}` : 'Fit: first press “fit” beside a number', 'fit the free numbers to the measured points', runFit, !count);
    bar.append(fit, button('Take away', 'take the measured points away', () => { dropped = null; drawMeasured(); drawPage(); }));
    box.append(tag('p', { class: 'small' }, [dropped.name, ...dropped.doubts].join('; ')), bar, tag('div', { id: 'studio-fitted', role: 'status' }));
  }

  async function runFit() {
    const { words, unknowns, places } = freed(model), nm = page.scenes[0].nm;
    status('fitting ...');
    try {
      const { name, content, theta_in_deg, quantity, sample } = dropped;
      const found = await askJson('/api/fit', { words, unknowns, tab, file: { name, content, quantity, theta_in_deg }, sample, from_nm: nm[0] - 0.5, to_nm: nm[nm.length - 1] + 0.5 });
      const lines = [];
      for (const v of found.values) {
        const { layer, key, index, label, unit } = places[v.unknown], owner = layer < 0 ? model : model.layers[layer], text = String(Number(v.value.toPrecision(5)));
        if (key === 'depth') owner.depth = owner.depth.replace(/^[0-9.eE+-]+/, text);
        else {
          const at = numbersOf(owner[key])[index];
          owner[key] = owner[key].slice(0, at.at) + text + owner[key].slice(at.at + at.length);
        }
        lines.push(`${label} of ${layer < 0 ? 'the bottom' : `layer ${layer + 1}`}: ${text}${v.standard_error === null ? '' : ` ± ${Number(v.standard_error.toPrecision(2))}`} ${unit}${v.note ? ` (${v.note})` : ''}`);
      }
      lines.push(`${found.used} values, root mean square of what is left ${Number(found.residual_rms.toPrecision(2))}${found.converged ? '' : `; no minimum was found: ${found.reason}`}`, ...found.notes);
      draw();
      changed(true);
      drawMeasured();
      $('studio-fitted').replaceChildren(...lines.map((line) => tag('p', { class: 'small' }, line)));
    } catch (error) {
      refuse(error);
    }
  }

  async function take(file) {
    try {
      const content = await new Promise((done, failed) => {
        const reader = new FileReader();
        reader.onload = () => done(reader.result.slice(reader.result.indexOf(',') + 1));
        reader.onerror = failed;
        reader.readAsDataURL(file);
      });
      const theta_in_deg = App.view.thetaIn, quantity = $('studio-quantity').value;
      const read = await askJson('/api/measured', { name: file.name, content, theta_in_deg, quantity });
      dropped = { name: file.name, content, theta_in_deg, quantity, sample: 0, ...read };
      $('studio-error').hidden = true;
      status(`${file.name}: ${read.values.length} values, ${read.format}`);
      drawMeasured();
      await drawPage();
    } catch (error) {
      refuse(error);
    }
  }

  // The picture as it stands, drawn anew just before: WebGL forgets it after each frame.
  function savePicture() {
    page.changed('picture');
    page.update();
    for (const { stage, scene, film } of page.objects) {
      (film.hidden ? stage.querySelector('canvas') : Drawdown.canvasOf(film)).toBlob((blob) => {
        const link = tag('a', { href: URL.createObjectURL(blob), download: scene.index ? 'kept.png' : 'scene.png' });
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 10000);
      });
    }
    status('scene.png is written');
  }

  // Colours of diffuse light and of the lamp, to copy.
  const ACESCG = [[0.613097, 0.339523, 0.04738], [0.070194, 0.916354, 0.013452], [0.020616, 0.10957, 0.869815]];  // of linear sRGB, Bradford
  function drawColours() {
    const box = $('studio-colours'), scene = page.scenes[0], light = scene.illuminants && App.lightOf(scene);
    box.replaceChildren();
    if (!light) return;
    box.append(tag('h2', {}, 'Colour'));
    for (const [name, spectrum] of [['diffuse light', Array.from(scene.spherical)], [`lamp at ${App.view.wholeThetaIn}°, all directions`, scene.plane.map((row) => row[App.view.wholeThetaIn])]]) {
      const rgb = Colour.linear(light, spectrum), bytes = rgb.map((v) => Math.round(255 * Colour.encode(v)));
      const fixed = (list, digits) => list.map((v) => v.toFixed(digits)).join(' ');
      const list = tag('dl', { 'data-light': name.startsWith('diffuse') ? 'diffuse' : 'lamp' });
      box.append(tag('span', { class: 'swatch', style: `background: ${Colour.css(rgb)}`, role: 'img', 'aria-label': `colour in ${name}` }), tag('p', { class: 'small' }, name), list);
      const rows = [['Lab', fixed(Colour.lab(light, spectrum), 2)], ['sRGB', `#${bytes.map((b) => b.toString(16).padStart(2, '0')).join('')}`], ['linear', fixed(rgb, 4)],
        ['ACEScg', fixed(ACESCG.map((row) => row.reduce((sum, m, i) => sum + m * rgb[i], 0)), 4)]];
      for (const [key, text] of rows) list.append(tag('dt', {}, key), tag('dd', { 'data-key': key }, text), button('Copy', `copy ${key} of ${name}`, () => copy(text)));
    }
  }

  async function copy(text) {
    try {
      await navigator.clipboard.writeText(text);
      status('copied');
    } catch {
      const area = tag('textarea');
      area.value = text;
      document.body.append(area);
      area.select();
      document.execCommand('copy');
      area.remove();
    }
  }

  async function write() {
    const kind = $('studio-kind').value;
    if (kind === 'picture') {
      savePicture();
      return;
    }
    status(`writing ${kind} ...`);
    try {
      const reply = await ask('/api/write', { words: wordsOf(model), kind });
      const name = /filename="([^"]*)"/.exec(reply.headers.get('Content-Disposition') || '')?.[1] || kind;
      const link = tag('a', { href: URL.createObjectURL(await reply.blob()), download: name });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10000);
      status(`${name} is written`);
    } catch (error) {
      refuse(error);
    }
  }

  // A material's name, into the medium that was chosen last.
  function putMaterial(name) {
    if (!chosen) return;
    const { owner, key, input, drawSliders } = chosen;
    // The first name of the words gives way; its sizes and amounts stay.
    owner[key] = /^[A-Za-z_][\w]*(?=$|[,\s@])/.test(owner[key]) ? owner[key].replace(/^[\w]+/, name) : `${name},radius=0.2`;
    input.value = owner[key];
    drawSliders();
    changed(true);
  }

  function begin(words) {
    model = modelOf({ ...words, wavelengths: [model.wavelengths], tolerance: [model.tolerance] });
    draw();
    changed(true);
  }

  async function start() {
    document.body.classList.add('studio');
    const state = await askJson('/api/state', {});
    model = state.view?.model || modelOf(state.words);
    if (state.view?.camera) Object.assign(App.view, state.view.camera);
    formats = state.formats;
    last = JSON.stringify(model);
    for (const [key, text] of [['report', 'page that anybody can open'], ['picture', 'picture as PNG'], ['albedo', 'albedo as CSV'], ...formats.map((f) => [f, `BRDF as ${f}`])]) $('studio-kind').add(new Option(text, key));
    $('studio-preset').add(new Option('Begin with ...', ''));
    presets.forEach(([name], i) => $('studio-preset').add(new Option(name, i)));
    $('studio-preset').addEventListener('change', ({ target }) => {
      if (target.value === '') return;
      begin(presets[target.value][1]);
      target.value = '';
    });
    $('studio-add').addEventListener('click', () => {
      model.layers.push({ words: 'SiO2,radius=0.2', depth: '0.5', on: true });
      draw();
      changed(true);
    });
    $('studio-undo').addEventListener('click', () => step(past, future));
    $('studio-redo').addEventListener('click', () => step(future, past));
    document.addEventListener('keydown', (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== 'z' || /^(INPUT|TEXTAREA)$/.test(event.target.tagName) && event.target.type === 'text') return;
      event.preventDefault();
      if (event.shiftKey) step(future, past);
      else step(past, future);
    });
    $('studio').addEventListener('change', ({ target }) => { if (target.type === 'text') touched = target; }, true);
    $('studio-keep').addEventListener('click', () => {
      kept = kept ? null : current;
      $('studio-keep').textContent = kept ? 'No comparison' : 'Keep, to compare';
      drawPage();
    });
    $('studio-file').addEventListener('change', ({ target }) => { if (target.files[0]) take(target.files[0]); target.value = ''; });
    document.addEventListener('change', ({ target }) => { if (['c-object', 'c-light'].includes(target.id)) drawDown(false); });
    document.addEventListener('take', ({ detail }) => deepen(detail));
    document.addEventListener('dragover', (event) => event.preventDefault());
    document.addEventListener('drop', (event) => {
      event.preventDefault();
      if (event.dataTransfer.files[0]) take(event.dataTransfer.files[0]);
    });
    $('studio-write').addEventListener('click', write);
    $('studio-find').addEventListener('input', () => Finder.find(putMaterial).catch(refuse));
    for (const each of document.querySelectorAll('[data-text]')) {
      each.addEventListener('click', async () => {
        try {
          const texts = await askJson('/api/texts', { words: wordsOf(model) });
          $('studio-text').hidden = false;
          $('studio-text').textContent = texts[each.dataset.text];
          await copy(texts[each.dataset.text]);
        } catch (error) {
          refuse(error);
        }
      });
    }
    draw();
    await send(false);
  }

  // For tests: what stands on the page, and how long each solution took until it was drawn, ms.
  return { start, begin, latency, get model() { return model; }, get words() { return wordsOf(model); }, get failed() { return failed; } };
})();
