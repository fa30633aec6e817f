// Everything below the pictures: values at a pair of directions, cuts, spectra, media, facts.
const Panels = (() => {
  'use strict';
  const PI = Math.PI, { number } = Chart;
  const tag = (name, attributes = {}, text) => {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    return element;
  };
  const cosine = (degrees) => Math.max(1e-3, Math.cos(degrees * PI / 180));
  const dashOf = (scene) => (scene.index ? '7 4' : '');
  // Fixed decimals, with no minus before a zero.
  const fixed = (value, digits) => {
    const text = value.toFixed(digits);
    return Number(text) === 0 ? text.replace('-', '') : text.replace('-', '−');
  };
  const labText = (lab) => lab.map((v) => fixed(v, 1)).join(', ');
  // The name of a curve, with its scene where there are two.
  const called = (scene, what) => (scene.alone ? what : what ? `${scene.name}: ${what}` : scene.name);

  // Points that were measured (the studio's), for one of the charts.
  const measuredOf = (scenes, chart) => scenes.flatMap((s) => (s.measured || []).filter((m) => m.chart === chart)
    .map((m, i) => ({ name: m.name, x: m.x, y: m.y, style: 2 + i % 4, points: true })));

  // Values of each scene at the chosen directions.
  class Readouts {
    constructor(parent, difference) {
      this.parent = parent;
      this.difference = difference;
    }

    draw(scenes, view, light) {
      const labs = [];
      this.parent.replaceChildren(...scenes.map((scene) => {
        const w = scene.near(view.wavelength), spectrum = scene.spectrumAt(view);
        const card = tag('div', { class: 'card', 'data-scene': scene.index });
        card.append(tag('h3', {}, scene.name));
        const rows = tag('dl', { class: 'values' });
        const row = (name, text, key, value) => rows.append(tag('dt', {}, name), tag('dd', { 'data-key': key, 'data-value': value }, text));
        row(`BRDF at ${scene.nm[w]} nm`, `${number(spectrum[w])} sr⁻¹`, 'brdf', spectrum[w]);
        row('of a white matt surface', `${number(100 * PI * spectrum[w])} %`, 'factor', PI * spectrum[w]);
        card.append(rows);
        if (light) {
          const factor = spectrum.map((v) => PI * v), lab = Colour.lab(light(scene), factor);
          labs.push(lab);
          row('CIE Lab', labText(lab), 'lab', lab.join(','));
          const rgb = Colour.linear(light(scene), factor), most = Math.max(1, ...rgb);
          card.append(tag('span', { class: 'swatch', style: `background: ${Colour.css(rgb.map((v) => v / most))}`, role: 'img', 'aria-label': 'its colour' }));
          if (most > 1.03) card.append(tag('p', { class: 'small' }, `brighter than the screen: its colour is shown at ${number(100 / most, 2)} %`));
        }
        return card;
      }));
      this.difference.replaceChildren();
      if (labs.length === 2) {
        const value = Colour.deltaE2000(labs[0], labs[1]);
        this.difference.append('Colour difference of the two at these directions: ', tag('b', { id: 'de2000', 'data-value': value }, `ΔE₀₀ = ${number(value, 3)}`));
      }
    }
  }

  // The plane of incidence: f over the angle of reflection, drawn around the point of incidence.
  class Polar {
    constructor(parent) {
      this.figure = tag('figure', { class: 'polar' });
      const caption = tag('figcaption');
      this.title = tag('h3');
      const button = tag('button', { type: 'button', class: 'quiet', title: 'Save the numbers of this cut as CSV' }, 'CSV');
      button.addEventListener('click', () => Chart.saveText('plane_of_incidence.csv', this.csv()));
      caption.append(this.title, button);
      this.plot = tag('div');
      this.legend = tag('div', { class: 'legend' });
      this.figure.append(caption, this.plot, this.legend);
      parent.append(this.figure);
      this.angles = Array.from({ length: 357 }, (_, i) => -89 + 0.5 * i);
      new ResizeObserver(() => requestAnimationFrame(() => this.last && this.width !== Math.min(760, this.plot.clientWidth) && this.draw(...this.last))).observe(this.plot);
    }

    csv() {
      const lines = [`# ${document.title}`, `# ${this.title.textContent}; angles from the normal, negative: the lamp's side`, 'curve,angle_deg,brdf_per_sr'];
      for (const c of this.curves) this.angles.forEach((angle, i) => lines.push(`"${c.name}",${angle},${c.values[i]}`));
      return lines.join('\n') + '\n';
    }

    draw(scenes, view) {
      this.last = [scenes, view];
      const width = this.width = Math.min(760, this.plot.clientWidth);
      if (!width) return;
      this.curves = scenes.map((scene) => {
        const w = scene.near(view.wavelength), muIn = cosine(view.thetaIn);
        return { name: called(scene, `${scene.nm[w]} nm`), scene,
          values: this.angles.map((a) => scene.solved.evaluateAt(w, muIn, cosine(a), a < 0 ? 180 : 0)) };
      });
      const top = Math.max(...this.curves.flatMap((c) => c.values)) || 1;
      const radius = LobeScale.of(view.lobeScale, top), r0 = width / 2 - 46, height = r0 + 62, x0 = width / 2, y0 = height - 26;
      this.plot.replaceChildren();
      const root = Chart.svg('svg', { width, height, viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': `BRDF in the plane of incidence; largest value ${number(top)} per steradian` }, this.plot);
      this.plot.firstChild.style.margin = '0 auto';
      for (const share of [0.25, 0.5, 0.75, 1]) {
        Chart.svg('path', { d: `M${x0 - share * r0} ${y0}A${share * r0} ${share * r0} 0 0 1 ${x0 + share * r0} ${y0}`, class: 'grid', fill: 'none' }, root);
        if (width > 460 || share === 0.5 || share === 1) Chart.svg('text', { x: x0 + share * r0, y: y0 + 17, class: 'tick middle' }, root, number(radius.inverse(share), 2));
      }
      for (let a = -90; a <= 90; a += 30) {
        const s = Math.sin(a * PI / 180), c = Math.cos(a * PI / 180);
        Chart.svg('line', { x1: x0, y1: y0, x2: x0 + r0 * s, y2: y0 - r0 * c, class: 'grid' }, root);
        if (Math.abs(a) < 90) Chart.svg('text', { x: x0 + (r0 + 15) * s, y: y0 - (r0 + 12) * c + 4, class: 'tick middle' }, root, `${Math.abs(a)}°`);
      }
      const t = view.thetaIn * PI / 180;
      Chart.svg('line', { x1: x0 - r0 * Math.sin(t), y1: y0 - r0 * Math.cos(t), x2: x0, y2: y0, class: 'line style5', 'stroke-dasharray': '2 4' }, root);
      for (const c of this.curves) {
        const path = c.values.map((v, i) => {
          const r = r0 * radius.share(v), a = this.angles[i] * PI / 180;
          return `${i ? 'L' : 'M'}${(x0 + r * Math.sin(a)).toFixed(1)} ${(y0 - r * Math.cos(a)).toFixed(1)}`;
        }).join('');
        Chart.svg('path', { d: path, class: `line style${c.scene.index}`, 'stroke-dasharray': dashOf(c.scene) || 'none' }, root);
      }
      this.title.textContent = `BRDF in the plane of incidence (sr⁻¹), lamp at ${view.thetaIn}°`;
      this.legend.replaceChildren(...this.curves.map((c) => {
        const key = tag('span', { class: 'key' });
        key.innerHTML = `<svg width="26" height="10" aria-hidden="true"><line x1="1" x2="25" y1="5" y2="5" class="line style${c.scene.index}"${c.scene.index ? ' stroke-dasharray="7 4"' : ''}/></svg>`;
        key.append(tag('span', {}, c.name));
        return key;
      }), tag('span', {}, '· · · from the lamp'));
    }
  }

  // Radii of lobes: in proportion to the value, or to its logarithm over three decades.
  const LobeScale = {
    of(kind, top) {
      if (kind === 'log') return { share: (v) => Math.max(0, 1 + Math.log10(Math.max(v, 1e-30) / top) / 3), inverse: (s) => top * 10 ** (3 * (s - 1)) };
      return { share: (v) => v / top, inverse: (s) => s * top };
    },
  };

  class Spectra {
    constructor(point, albedo, media) {
      const chart = (parent, title, yName, more) => new Chart.LineChart(parent, { title, xName: 'wavelength', xUnit: 'nm', yName, ...more });
      this.brdf = chart(point, 'BRDF at these directions', 'BRDF', { yUnit: 'sr⁻¹', zero: true, file: 'brdf_spectrum' });
      this.azimuth = new Chart.LineChart(point, { title: 'BRDF around the normal', xName: 'azimuth from the mirror side', xUnit: '°', yName: 'BRDF', yUnit: 'sr⁻¹', zero: true, file: 'brdf_azimuth' });
      this.albedo = chart(albedo, 'Albedo', 'share reflected', { zero: true, file: 'albedo_spectrum' });
      this.through = chart(albedo, 'Transmittance', 'share that passes', { zero: true, file: 'transmittance_spectrum' });
      this.angle = new Chart.LineChart(albedo, { title: 'Albedo and incidence', xName: 'angle of incidence', xUnit: '°', yName: 'share reflected', zero: true, file: 'albedo_incidence' });
      this.n = chart(media, 'Refractive index n', 'n', { file: 'n' });
      this.k = chart(media, 'Absorption index k', 'k', { log: 'wide', file: 'k' });
      this.single = chart(media, 'Single-scattering albedo', 'share scattered', { most: 1, file: 'single_scattering_albedo' });
      this.phase = new Chart.LineChart(media, { title: 'Phase function', xName: 'angle of scattering', xUnit: '°', yName: 'P (mean 1)', log: true, file: 'phase_function' });
    }

    drawPoint(scenes, view) {
      this.brdf.set([...scenes.map((s) => ({ name: called(s, s.alone ? 'BRDF' : ''), x: s.nm, y: s.spectrumAt(view), style: s.index, dash: dashOf(s) })), ...measuredOf(scenes, 'brdf')]);
      const azimuths = Array.from({ length: 91 }, (_, i) => 2 * i);
      this.azimuth.set(scenes.map((s) => {
        const w = s.near(view.wavelength);
        return { name: called(s, `${s.nm[w]} nm`), x: azimuths, style: s.index, dash: dashOf(s),
          y: azimuths.map((a) => s.solved.evaluateAt(w, cosine(view.thetaIn), cosine(view.thetaOut), a)) };
      }));
    }

    drawAlbedo(scenes, view, angles) {
      const spectra = (from, diffuse, plane) => from.flatMap((s) => [
        { name: called(s, 'diffuse light'), x: s.nm, y: s[diffuse], style: s.index },
        { name: called(s, `lamp at ${view.wholeThetaIn}°`), x: s.nm, y: s[plane].map((row) => row[view.wholeThetaIn]), style: s.index, dash: '3 4' }]);
      this.albedo.set([...spectra(scenes, 'spherical', 'plane'), ...measuredOf(scenes, 'albedo')]);
      const clear = scenes.filter((s) => s.sphericalThrough);
      this.through.figure.hidden = !clear.length;
      this.through.set([...spectra(clear, 'sphericalThrough', 'planeThrough'), ...measuredOf(clear, 'through')]);
      this.angle.set(scenes.map((s) => {
        const w = s.near(view.wavelength);
        return { name: called(s, `${s.nm[w]} nm`), x: angles, y: Array.from(s.plane[w]), style: s.index, dash: dashOf(s) };
      }));
    }

    drawMedia(scenes, view, angles) {
      const media = [], species = [];
      for (const scene of scenes) {
        for (const medium of scene.media) {
          const twice = media.find((m) => m.medium.name === medium.name && scenes.length > 1 && m.same(medium));
          if (!twice) media.push({ medium, scene, same: (other) => other.albedo.every((v, i) => v === medium.albedo[i]) });
          for (const one of medium.species) {
            if (!species.some((s) => s.one.name === one.name && s.scene === scene)) species.push({ one, scene });
          }
        }
      }
      const style = (i) => ({ style: i % 6, dash: i >= 6 ? '5 3' : '' });
      const unique = species.filter((s, i) => species.findIndex((t) => t.one.name === s.one.name && t.one.n[0] === s.one.n[0]) === i);
      this.n.set(unique.map(({ one, scene }, i) => ({ name: one.name, x: scene.nm, y: one.n, ...style(i) })));
      const absorbing = unique.filter(({ one }) => one.k.some((k) => k > 0));
      this.k.set(absorbing.map(({ one, scene }) => ({ name: one.name, x: scene.nm, y: one.k, ...style(unique.findIndex((u) => u.one === one)) })));
      this.n.figure.hidden = !unique.length;
      this.k.figure.hidden = !absorbing.length;
      const names = media.map(({ medium, scene }) => `${scenes.length > 1 ? scene.name + ', ' : ''}${medium.place}: ${medium.name}`);
      this.single.set(media.map(({ medium, scene }, i) => ({ name: names[i], x: scene.nm, y: medium.albedo, ...style(i) })));
      this.phase.set(media.map(({ medium, scene }, i) => {
        const w = scene.near(view.wavelength);
        return { name: `${names[i]}, ${scene.nm[w]} nm`, x: angles, y: medium.phaseAt(w), ...style(i) };
      }));
    }
  }

  // Swatches of diffuse light and of the lamp's incidence.
  function drawSwatches(parent, scenes, view, light) {
    parent.replaceChildren();
    if (!light) return;
    const table = tag('table', { class: 'colours' }), head = tag('tr');
    for (const name of ['Colour', '', 'X', 'Y', 'Z', 'L*', 'a*', 'b*']) head.append(tag('th', {}, name));
    table.append(head);
    const both = { diffuse: [], lamp: [] };
    for (const scene of scenes) {
      const of = { diffuse: Array.from(scene.spherical), lamp: scene.plane.map((row) => row[view.wholeThetaIn]) };
      for (const [kind, spectrum] of Object.entries(of)) {
        const l = light(scene), lab = Colour.lab(l, spectrum), row = tag('tr', { 'data-colour': `${scene.index}-${kind}` });
        both[kind].push(lab);
        const swatch = tag('td');
        swatch.append(tag('span', { class: 'swatch', style: `background: ${Colour.css(Colour.linear(l, spectrum))}` }));
        row.append(tag('td', {}, called(scene, kind === 'diffuse' ? 'diffuse light' : `lamp at ${view.wholeThetaIn}°`)), swatch);
        const xyz = ['x', 'y', 'z'].map((c) => l[c].reduce((sum, v, i) => sum + v * spectrum[i], 0));
        for (const v of xyz) row.append(tag('td', { 'data-value': v }, v.toFixed(4)));
        for (const v of lab) row.append(tag('td', { 'data-value': v }, fixed(v, 2)));
        table.append(row);
      }
    }
    if (scenes.length === 2) {
      for (const [kind, [a, b]] of Object.entries(both)) {
        const row = tag('tr'), value = Colour.deltaE2000(a, b), cell = tag('td', { colspan: 6, 'data-difference': kind, 'data-value': value }, `ΔE₀₀ = ${number(value, 3)}`);
        row.append(tag('td', {}, `difference, ${kind === 'diffuse' ? 'diffuse light' : `lamp at ${view.wholeThetaIn}°`}`), tag('td'), cell);
        table.append(row);
      }
    }
    parent.append(table);
  }

  const factNames = { scene: 'Scene', command: 'Command', units: 'Units', source: 'Source of the optical constants', particles: 'Particles', optical_depth: 'Optical depth',
    note: 'Note', tolerance: 'Tolerance', error_estimate: 'Estimated error of the solution', phase_noise: 'Noise of the phase function', method: 'Method', 'not converged': 'Not converged' };

  function drawFacts(parent, scenes, version) {
    parent.replaceChildren(...scenes.map((scene) => {
      const card = tag('div', { class: 'card facts', 'data-scene': scene.index }), list = tag('dl'), { variant } = scene;
      let last = '';
      const add = (name, text, code) => {
        const value = tag('dd', { class: text.length > 400 ? 'long' : '' });
        value.append(code ? tag('code', {}, text) : text);
        if (name !== last) list.append(tag('dt', {}, name));
        list.append(value);
        last = name;
      };
      for (const [name, text] of variant.facts || []) add(factNames[name] || name, text, name === 'command');
      add('Error of this page between the points of its tables', `${number(variant.interpolation_error, 2)} of the largest value at an incidence`);
      for (const { reason } of variant.omissions || []) add('Left out', reason);
      add('Program', version);
      card.append(tag('h3', {}, scene.name), list);
      return card;
    }));
  }

  return { Readouts, Polar, Spectra, LobeScale, drawSwatches, drawFacts, tag, cosine };
})();
