// With ?selftest=... the page checks itself and writes what it shows into #selftest, for the tests.
const SelfTest = (() => {
  'use strict';
  const errors = [];
  window.addEventListener('error', (event) => errors.push(event.message));
  window.addEventListener('unhandledrejection', (event) => errors.push(String(event.reason)));
  const real = console.error;
  console.error = (...words) => {
    errors.push(words.join(' '));
    real(...words);
  };

  const data = (selector) => Array.from(document.querySelectorAll(selector), (e) => e.dataset.value.split(',').map(Number));

  // Mean of linear RGB over the pixels of a picture that show the object, and how many there are.
  function meanColour(canvas) {
    const copy = document.createElement('canvas');
    copy.width = canvas.width;
    copy.height = canvas.height;
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const { data: bytes } = context.getImageData(0, 0, copy.width, copy.height), sum = [0, 0, 0];
    let count = 0;
    for (let i = 0; i < bytes.length; i += 4) {
      if (bytes[i + 3] < 255) continue;
      ++count;
      for (let c = 0; c < 3; ++c) {
        const v = bytes[i + c] / 255;
        sum[c] += v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
      }
    }
    return { rgb: sum.map((v) => v / count), share: count / (copy.width * copy.height) };
  }

  // Largest difference of the picture's interpolation from the BRDF itself, over the largest value.
  function interpolation({ scenes, objects, view, pictureWeights }) {
    const lamp = ObjectView.lampInView(view), gamma = Math.acos(lamp[2]);
    return scenes.map((scene, s) => {
      const weights = pictureWeights(scene);
      let worst = 0, largest = 0;
      for (let y = -0.95; y < 1; y += 0.1) {
        for (let x = -0.95; x < 1; x += 0.1) {
          const r2 = x * x + y * y;
          if (r2 > 0.98) continue;
          const normal = [x, y, Math.sqrt(1 - r2)], out = normal[2], into = x * lamp[0] + y * lamp[1] + out * lamp[2];
          if (into < 0.02) continue;
          const sines = Math.sqrt((1 - into * into) * (1 - out * out));
          const azimuth = Math.acos(Math.min(1, Math.max(-1, (into * out - lamp[2]) / sines))) * 180 / Math.PI;
          const exact = scene.solved.evaluate(into, out, azimuth, true);
          const here = ObjectView.shade(objects[s].drawn.table, scene.solved, lamp, gamma, 0, normal);
          for (let c = 0; c < 3; ++c) {
            let sum = 0;
            for (let w = 0; w < exact.length; ++w) sum += weights[c][w] * exact[w] * Math.PI * into;
            worst = Math.max(worst, Math.abs(sum - here[c]));
            largest = Math.max(largest, Math.abs(sum));
          }
        }
      }
      return worst / largest;
    });
  }

  // ?selftest=thetaIn,thetaOut,azimuth;...  Every step goes through the controls of the page.
  async function run(page) {
    const asked = new URLSearchParams(location.search).get('selftest');
    if (asked === null) return;
    const { view, scenes, objects, parts, changed, update } = page;
    page.drawAll();
    const frame = () => new Promise((done) => setTimeout(done, 0));
    const result = { ready_ms: Number(document.body.dataset.ready), three: typeof THREE !== 'undefined', is3d: objects.map((o) => o.is3d), values: [] };
    const set = (id, value) => {
      const input = document.getElementById(id);
      input.value = value;
      input.dispatchEvent(new Event('input'));
    };
    for (const triple of asked.split(';').filter(Boolean)) {
      const [thetaIn, thetaOut, azimuth] = triple.split(',').map(Number);
      set('c-thetaIn', thetaIn);
      set('c-thetaOut', thetaOut);
      set('c-azimuth', azimuth);
      update();
      await frame();
      result.values.push({ thetaIn, thetaOut, azimuth, shown: data('[data-key=brdf]'), lab: data('[data-key=lab]'), de2000: data('#de2000'),
        spectra: scenes.map((scene) => Array.from(scene.spectrumAt(view))),
        // Cuts and lobes are made of this.
        single: scenes.map((s) => s.solved.evaluateAt(s.near(view.wavelength), Panels.cosine(view.thetaIn), Panels.cosine(view.thetaOut), view.azimuth)) });
    }
    result.wavelength_nm = view.wavelength;
    result.albedo = scenes.map((s) => ({ incidence_deg: view.wholeThetaIn, plane: s.plane.map((row) => row[view.wholeThetaIn]), spherical: Array.from(s.spherical) }));
    result.colours = Array.from(document.querySelectorAll('[data-colour]'), (row) => ({ of: row.dataset.colour, values: Array.from(row.querySelectorAll('[data-value]'), (e) => Number(e.dataset.value)) }));
    Object.assign(view, { yaw: 0, pitch: 0, lampYaw: -35, lampPitch: 30, exposure: -1, sky: 0 });
    changed(...parts.object);
    update();
    result.interpolation = interpolation(page);
    result.pictures = objects.map(({ stage }) => meanColour(stage.querySelector('canvas')));
    // A click in the middle of the sphere: the camera looks along the normal there.
    const stage = objects[0].stage, box = stage.getBoundingClientRect();
    const click = { clientX: box.left + box.width / 2, clientY: box.top + box.height / 2, pointerId: 1, bubbles: true };
    stage.setPointerCapture = () => {};
    stage.dispatchEvent(new PointerEvent('pointerdown', click));
    stage.dispatchEvent(new PointerEvent('pointerup', click));
    update();
    result.picked = { thetaIn: view.thetaIn, thetaOut: view.thetaOut, azimuth: view.azimuth, shown: data('[data-key=brdf]') };
    result.members = scenes.map((s) => s.variants.length);
    const slider = document.getElementById('c-member');
    if (slider) {
      set('c-member', slider.max);
      update();
      result.last_member = { label: scenes[0].variant.label, picked: data('[data-key=brdf]') };
    }
    result.overflow_px = document.documentElement.scrollWidth - document.documentElement.clientWidth;
    result.errors = errors;
    document.getElementById('selftest').textContent = JSON.stringify(result);
  }

  return { run };
})();
