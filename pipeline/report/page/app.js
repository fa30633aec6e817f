// The page: one view (what is chosen), the scenes, and who draws what again when the view changes.
const App = (() => {
  'use strict';
  const PI = Math.PI, { tag, cosine } = Panels;

  const view = {
    member: 0, wavelength: 550, light: 'd65', show: 'colour', thetaIn: 30, thetaOut: 45, azimuth: 0, wholeThetaIn: 30,
    object: 'sphere', exposure: -0.25, sky: 0.2, surroundings: 'room', yaw: 0, pitch: 0, lampYaw: -40, lampPitch: 40,
    lobeYaw: 20, lobePitch: 25, lobeScale: 'linear', normal: null,
  };

  // A scene of the page; what belongs to one member of its family is read when it is shown.
  class Scene {
    constructor(data, index, store) {
      this.index = index;
      this.take(data, store);
    }

    take(data, store) {
      Object.assign(this, { store, name: data.name, description: data.description, varied: data.varied,
        nm: data.wavelength_nm, illuminants: data.illuminants, variants: data.variants, read: [] });
    }

    choose(member) {
      const i = Math.min(member, this.variants.length - 1), { store, nm } = this, W = nm.length;
      this.variant = this.variants[i];
      if (!this.read[i]) {
        const { table, albedo, sky, media } = this.variant, f = (place) => Data.floats(store, place);
        this.read[i] = {
          solved: new Brdf.Solved(store, table, W),
          plane: Data.rowsOf(f(albedo.plane), f(albedo.plane).length / W),
          spherical: f(albedo.spherical),
          planeThrough: albedo.plane_through && Data.rowsOf(f(albedo.plane_through), f(albedo.plane_through).length / W),
          sphericalThrough: albedo.spherical_through && f(albedo.spherical_through),
          sky: Data.rowsOf(f(sky), f(sky).length / W),
          mirror: albedo.mirror && Data.rowsOf(f(albedo.mirror), f(albedo.mirror).length / W),
          media: !media ? this.media || [] : media.map((m) => {
            const phase = Data.integers(store, m.log_phase), angles = phase.length / W;
            return { place: m.place, name: m.name, albedo: f(m.albedo), asymmetry: f(m.asymmetry),
              species: m.species.map((s) => ({ name: s.name, n: f(s.n), k: f(s.k) })),
              phaseAt: (w) => Array.from(phase.subarray(w * angles, (w + 1) * angles), (v) => 10 ** (v / 1000)) };
          }),
        };
      }
      Object.assign(this, this.read[i]);
    }

    near(wavelength) {
      let best = 0;
      this.nm.forEach((v, i) => { if (Math.abs(v - wavelength) < Math.abs(this.nm[best] - wavelength)) best = i; });
      return best;
    }

    spectrumAt({ thetaIn, thetaOut, azimuth }) { return this.solved.evaluate(cosine(thetaIn), cosine(thetaOut), azimuth); }
  }

  const lightOf = (scene) => scene.illuminants.find((l) => l.key === view.light);

  // Weights of each wavelength in the three colours of the picture.
  function pictureWeights(scene) {
    if (view.show === 'colour') return Colour.linearWeights(lightOf(scene));
    const one = scene.nm.map((_, w) => (w === scene.near(view.wavelength) ? 1 : 0));
    return [one, one, one];
  }

  // Directions at a normal in the camera's frame; null where the lamp or the camera does not reach.
  function directionsAt(normal, lamp) {
    const muOut = normal[2], muIn = normal[0] * lamp[0] + normal[1] * lamp[1] + normal[2] * lamp[2];
    if (muOut <= 0.01 || muIn <= 0.01) return null;
    const sines = Math.sqrt((1 - muIn * muIn) * (1 - muOut * muOut));
    const cosAzimuth = sines > 1e-9 ? Math.min(1, Math.max(-1, (muIn * muOut - lamp[2]) / sines)) : 1;
    const degrees = (radians) => Math.round(radians * 1800 / PI) / 10;
    return { thetaIn: degrees(Math.acos(muIn)), thetaOut: degrees(Math.acos(muOut)), azimuth: degrees(Math.acos(cosAzimuth)) };
  }

  // stores: the numbers of each scene.
  function build(root, stores) {
    const $ = (id) => document.getElementById(id);
    const scenes = root.scenes.map((data, index) => new Scene(data, index, stores[index]));
    scenes.forEach((scene) => {
      scene.alone = scenes.length === 1;
      scene.choose(view.member);
    });
    const coloured = scenes.every((scene) => scene.illuminants), two = scenes.length > 1;
    if (!coloured) view.show = 'wavelength';
    for (const id of ['main', 'objects', 'readouts', 'lobes', 'facts']) {
      $(id).classList.toggle('two', two);
      $(id).classList.toggle('one', !two);
    }
    const titled = document.title !== scenes.map((s) => s.name).join(' beside ');
    if (titled) $('title').textContent = document.title;
    else $('title').replaceChildren(...scenes.flatMap((s, i) => (i ? [tag('span', { class: 'versus' }, ' beside '), s.name] : [s.name])));
    const nm = scenes[0].nm;
    view.wavelength = nm[scenes[0].near(550)];

    let pending = false;
    const dirty = new Set();
    const changed = (...what) => {
      what.forEach((w) => dirty.add(w));
      if (pending) return;
      pending = true;
      requestAnimationFrame(() => { pending = false; update(); });
    };
    const parts = {
      member: ['picture', 'point', 'lobe', 'albedo', 'media', 'facts'], wavelength: ['picture', 'point', 'lobe', 'albedo', 'media'], light: ['picture', 'point', 'albedo'],
      show: ['picture'], thetaIn: ['point', 'lobe', 'albedo'], thetaOut: ['point', 'mark'], azimuth: ['point', 'mark'], object: ['picture'], exposure: ['picture'],
      sky: ['picture'], surroundings: ['picture'], lampYaw: ['picture'], lampPitch: ['picture'], lobeScale: ['lobe'],
    };
    const onControl = (key) => {
      if (['thetaIn', 'thetaOut', 'azimuth', 'lampYaw', 'lampPitch', 'object'].includes(key)) view.normal = null;
      changed(...parts[key]);
    };

    // Above everything: what all parts share.
    const degrees = (v) => `${v}°`.replace('-', '−');
    const family = scenes.find((s) => s.variants.length > 1);
    if (family) {
      Controls.slider($('controls'), view, { key: 'member', label: family.varied, min: 0, max: family.variants.length - 1, step: 1,
        text: (v) => String(Number(family.variants[Math.min(v, family.variants.length - 1)].value.toPrecision(4))) }, onControl);
    }
    const place = { get wavelengthIndex() { return scenes[0].near(view.wavelength); }, set wavelengthIndex(i) { view.wavelength = nm[i]; } };
    if (nm.length > 1) {
      Controls.slider($('controls'), place, { key: 'wavelengthIndex', label: 'Wavelength', min: 0, max: nm.length - 1, step: 1, text: (i) => `${nm[i]} nm` }, () => onControl('wavelength'));
    }
    Controls.slider($('controls'), view, { key: 'thetaIn', label: 'Angle of incidence', min: 0, max: 88, step: 1, text: degrees }, onControl);
    if (coloured) {
      Controls.list($('controls'), view, { key: 'light', label: 'Light', choices: scenes[0].illuminants.map((l) => [l.key, l.name]) }, onControl);
    }

    // Pictures.
    const wants3d = !new URLSearchParams(location.search).has('flat');
    const objects = scenes.map((scene) => {
      const card = tag('div', { class: 'card object', 'data-scene': scene.index }), stage = tag('div', { class: 'stage', role: 'img' });
      stage.setAttribute('aria-label', `${scene.description}, lit. Arrow keys turn it, with Shift they move the lamp.`);
      const canvas = tag('canvas'), marker = tag('div', { class: 'marker' });
      const film = tag('div', { class: 'drawdown', hidden: '' });
      stage.append(canvas, marker);
      card.append(tag('h3', {}, scene.name), stage, film);
      $('objects').append(card);
      const made = ObjectView.make(canvas, wants3d);
      marker.hidden = true;
      Controls.turnable(stage, (dx, dy) => {
        view.yaw = (view.yaw - dx) % 360;
        view.pitch = Math.min(90, Math.max(-90, view.pitch + dy));
        view.normal = null;
        changed('picture');
      }, (dx, dy) => {
        view.lampYaw = Math.min(180, Math.max(-180, view.lampYaw + dx));
        view.lampPitch = Math.min(89, Math.max(-89, view.lampPitch - dy));
        view.normal = null;
        Controls.refresh();
        changed('picture');
      }, (x, y) => pick(made.drawn.normalAt(x, y), x, y));
      return { scene, stage, marker, film, ...made };
    });
    const is3d = objects.every((o) => o.is3d);
    function pick(normal, x, y) {
      const found = normal && directionsAt(normal, ObjectView.lampInView(view));
      if (!found) return;
      Object.assign(view, found, { normal: [x, y] });
      Controls.refresh();
      changed('point', 'lobe', 'albedo', 'marker');
    }
    const hintOfObject = 'Drag to turn; with Shift, or by its two sliders, the lamp moves. Click a place to read its directions, its value and its colour.' +
      (is3d ? '' : ' (Without WebGL 2: a sphere drawn by the processor.)');
    // The studio draws the film of a scene down on a contrast chart, too.
    const drawsDown = () => view.object === 'drawdown' && typeof Drawdown !== 'undefined';
    const row = $('picture-controls');
    if (coloured) Controls.list(row, view, { key: 'show', label: 'Picture shows', choices: [['colour', 'its colour'], ['wavelength', 'one wavelength']] }, onControl);
    const shapes = [['sphere', 'sphere'], ...(is3d ? [['knot', 'knot'], ['vase', 'vase']] : []), ...(typeof Drawdown === 'undefined' ? [] : [['drawdown', 'drawdown on black and white']])];
    if (shapes.length > 1) Controls.list(row, view, { key: 'object', label: 'Object', choices: shapes }, onControl);
    Controls.slider(row, view, { key: 'lampYaw', label: 'Lamp left, right', min: -180, max: 180, step: 1, text: (v) => degrees(Math.round(v)) }, onControl);
    Controls.slider(row, view, { key: 'lampPitch', label: 'Lamp down, up', min: -89, max: 89, step: 1, text: (v) => degrees(Math.round(v)) }, onControl);
    Controls.slider(row, view, { key: 'sky', label: 'Light from all around', min: 0, max: 1, step: 0.05, text: (v) => `${Math.round(100 * v)} %` }, onControl);
    Controls.list(row, view, { key: 'surroundings', label: 'Surroundings', choices: [['room', 'room with two lights'], ['even', 'even sky']] }, onControl);
    Controls.slider(row, view, { key: 'exposure', label: 'Exposure', min: -4, max: 4, step: 0.25, text: (v) => `${v > 0 ? '+' : ''}${v} EV`.replace('-', '−') }, onControl);
    const noteOfPicture = () => drawsDown() ? 'Light from all around. The layers of the scene lie on the chart in place of what is below them.' : 'One distant lamp, no shadows cast, no light from one part to another. A white matt surface that faces the lamp is white at 0 EV; ' +
      'light is multiplied by 2 to the power of the exposure, clipped and written as sRGB, without any other tone curve.' +
      (view.surroundings === 'room' ? ' The room is there to be mirrored: its light on matt parts and its blurred image in rough ones are approximations; in an even sky they are exact.' : '') +
      (scenes.some((s) => s.solved.lobe && s.solved.lobe.only_in_pictures) ? ' The lamp’s mirror image in a smooth boundary is drawn as a lobe of slope parameter 0.02; the values below are without it.' : '');

    // Values at directions.
    Controls.slider($('direction-controls'), view, { key: 'thetaOut', label: 'Angle of reflection', min: 0, max: 88, step: 1, text: degrees }, onControl);
    Controls.slider($('direction-controls'), view, { key: 'azimuth', label: 'Azimuth (0° mirror, 180° lamp)', min: 0, max: 180, step: 1, text: degrees }, onControl);
    const readouts = new Panels.Readouts($('readouts'), $('difference'));
    const spectra = new Panels.Spectra($('point-charts'), $('albedo-charts'), $('media-charts'));

    // Lobes.
    const lobes = [];
    if (is3d) {
      for (const scene of scenes) {
        const card = tag('div', { class: 'card', 'data-scene': scene.index }), stage = tag('div', { class: 'stage lobe', role: 'img', 'aria-label': `Lobe of ${scene.name}; arrow keys turn it` });
        const canvas = tag('canvas');
        stage.append(canvas);
        card.append(tag('h3', {}, scene.name), stage);
        $('lobes').append(card);
        lobes.push({ scene, canvas });
        const turn = (dx, dy) => {
          view.lobeYaw -= dx;
          view.lobePitch = Math.min(89, Math.max(-20, view.lobePitch + dy));
          changed('mark');
        };
        Controls.turnable(stage, turn, turn);
      }
    }
    $('lobe-hint').textContent = is3d
      ? 'The distance from the middle of the disc, and the colour from violet to yellow, are the BRDF in that direction, on one scale for all scenes. Orange: where the light comes from; blue: the chosen direction of reflection. Drag to turn.'
      : 'The plane of incidence.';
    Controls.list($('lobe-controls'), view, { key: 'lobeScale', label: 'Length of the lobe', choices: [['linear', 'in proportion to the BRDF'], ['log', 'its logarithm, three decades']] }, onControl);
    const polar = new Panels.Polar($('polar'));

    function drawPicture() {
      const lamp = ObjectView.lampInView(view), down = drawsDown();
      $('object-hint').textContent = down ? 'The film over the black and the white half of a contrast chart.' : hintOfObject;
      for (const key of ['lampYaw', 'lampPitch', 'sky', 'surroundings', 'exposure']) $(`c-${key}`).closest('label').hidden = down;
      for (const { scene, drawn, marker, stage, film } of objects) {
        stage.hidden = down;
        film.hidden = !down;
        if (down) {
          Drawdown.draw(film, scene, coloured && lightOf(scene), coloured && pictureWeights(scene));
          continue;
        }
        const gamma = ObjectView.bake(scene, lamp, pictureWeights(scene), drawn.table);
        drawn.draw(scene, lamp, gamma, view);
        if (!view.normal) marker.hidden = true;
      }
    }

    function drawMarkers() {
      for (const { marker } of objects) {
        marker.hidden = !view.normal;
        if (view.normal) Object.assign(marker.style, { left: `${50 * (1 + view.normal[0])}%`, top: `${50 * (1 - view.normal[1])}%` });
      }
    }

    let amounts = [];
    function drawLobes(again) {
      lobes.forEach((each) => { each.lobe ||= new LobeView.View(each.canvas); });
      if (again) {
        const all = lobes.map(({ scene }) => LobeView.values(scene.solved, view.thetaIn, scene.near(view.wavelength)));
        const top = Math.max(...all.map((values) => values.reduce((a, b) => Math.max(a, b), 0))) || 1;
        const scale = Panels.LobeScale.of(view.lobeScale, top);
        amounts = all.map((values) => values.map(scale.share));
      }
      lobes.forEach(({ lobe }, i) => lobe.draw(amounts[i], view.thetaIn, view, view));
    }

    // Parts below the screen are drawn when they are nearly there, or printed: the first picture comes sooner.
    const sectionOf = { lobe: 'lobes', albedo: 'albedo-charts', media: 'media-charts' }, unseen = new Set(Object.keys(sectionOf));
    function draw(...what) {
      what.forEach((w) => { unseen.delete(w); dirty.add(w); });
      update();
    }
    const drawAll = () => draw(...unseen);
    function drawWhatIsSeen() {
      const inSection = new Map(Array.from(unseen, (what) => [$(sectionOf[what]).closest('section'), what]));
      const observer = new IntersectionObserver((entries) => {
        draw(...entries.filter((e) => e.isIntersecting).map((e) => inSection.get(e.target)).filter((what) => unseen.has(what)));
      }, { rootMargin: '200px' });
      for (const section of inSection.keys()) observer.observe(section);
      window.addEventListener('beforeprint', drawAll);
    }

    const light = coloured ? lightOf : null;
    function update() {
      const wanted = new Set(Array.from(dirty).filter((what) => !unseen.has(what === 'mark' ? 'lobe' : what)));
      dirty.clear();
      view.wholeThetaIn = Math.min(89, Math.round(view.thetaIn));
      if (wanted.has('facts')) {
        scenes.forEach((scene) => scene.choose(view.member));
        $('subtitle').replaceChildren(...scenes.map((s) => tag('span', {}, [s.name !== s.description ? `${s.name}: ${s.description}` : titled ? s.name : '',
          s.variant.label && `shown: ${s.variant.label}`].filter(Boolean).join('; '))));
      }
      if (wanted.has('picture')) {
        $('picture-note').textContent = noteOfPicture();
        drawPicture();
      }
      drawMarkers();
      if (wanted.has('point')) {
        readouts.draw(scenes, view, light);
        spectra.drawPoint(scenes, view);
      }
      if (wanted.has('lobe')) {
        drawLobes(true);
        polar.draw(scenes, view);
      } else if (wanted.has('mark')) drawLobes(false);
      if (wanted.has('albedo')) {
        spectra.drawAlbedo(scenes, view, root.albedo_angles_deg);
        Panels.drawSwatches($('swatches'), scenes, view, light);
      }
      if (wanted.has('media')) spectra.drawMedia(scenes, view, root.phase_angles_deg);
      if (wanted.has('facts')) {
        Panels.drawFacts($('facts'), scenes, root.version);
        const poor = scenes.filter((s) => !s.variant.converged).map((s) => s.name);
        $('warning').hidden = !poor.length;
        $('warning').textContent = `Not converged to the tolerance: ${poor.join(', ')}. Values are shown as they are; “How it was computed” says where they miss it.`;
      }
    }

    // The same scenes solved anew, at the same wavelengths.
    function replace(again, stores) {
      Object.assign(root, again);
      scenes.forEach((scene, i) => scene.take(again.scenes[i], stores[i]));
      scenes.forEach((scene) => scene.choose(view.member));
      $('title').textContent = scenes.map((s) => s.name).join(' beside ');
      for (const card of document.querySelectorAll('#objects h3, #lobes h3')) card.textContent = scenes[card.parentNode.dataset.scene].name;
      // The studio's previews are without facts and media: those that stand there stay.
      changed(...parts.member.filter((what) => scenes.every((s) => s.variant.facts) || !['media', 'facts'].includes(what)));
    }

    window.addEventListener('resize', () => changed('picture', 'mark'));
    const drawn = (async () => {
      draw('facts', 'picture');
      await new Promise((done) => setTimeout(done, 0));
      draw('point');
      drawWhatIsSeen();
    })();
    return { drawn, drawAll, view, scenes, objects, changed, update, parts, lightOf, pictureWeights, replace };
  }

  function chooseTheme() {
    const button = document.getElementById('theme'), asked = new URLSearchParams(location.search).get('theme');
    const set = (theme) => {
      document.documentElement.dataset.theme = theme;
      button.textContent = theme === 'dark' ? 'Light' : 'Dark';
    };
    set(asked || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light'));
    button.addEventListener('click', () => set(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'));
  }

  async function start() {
    chooseTheme();
    try {
      const three = document.getElementById('three').textContent, live = typeof Studio !== 'undefined';
      const [library, loaded] = await Promise.all([three.trim() && Data.inflate(three, 'gzip'),
        live ? null : Data.load(document.getElementById('data').textContent)]);
      if (library) (0, eval)(new TextDecoder().decode(library));
      if (live) {
        await Studio.start();
        return;
      }
      const page = build(loaded.root, loaded.root.scenes.map(() => loaded.store));
      await page.drawn;
      document.body.dataset.ready = Math.round(performance.now());
      if (typeof SelfTest !== 'undefined') await SelfTest.run(page);
    } catch (error) {
      const warning = document.getElementById('warning');
      warning.hidden = false;
      warning.textContent = typeof DecompressionStream === 'undefined'
        ? 'This browser cannot unpack the page’s numbers (it has no DecompressionStream); browsers from May 2023 on can.'
        : `The page could not be shown: ${error.message}`;
      console.error(error);
    }
  }

  return { start, build, view, lightOf };
})();
