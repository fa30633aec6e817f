// The drawdown: a film over the black and the white half of a contrast chart, drawn in place of the
// object. In light from all around every place of a half has one colour, so nothing is shaded.
const Drawdown = (() => {
  'use strict';
  const { tag } = Panels;

  // The elements of a card, made once: the button keeps the keyboard's focus while numbers change.
  function parts(box) {
    if (box.film) return box.film;
    const chart = tag('div', { class: 'chart-halves', role: 'img' }), halves = ['black', 'white'].map((name) => {
      const half = tag('span', { class: 'half' }), film = tag('span', { class: 'film', 'data-over': name });
      half.append(film);
      chart.append(half);
      return { half, film };
    });
    const values = tag('dl', { class: 'values' }), why = tag('p', { class: 'small', role: 'status' });
    const take = tag('button', { type: 'button', class: 'quiet take' }, 'Take the depth that hides');
    take.addEventListener('click', () => box.film.hide && box.dispatchEvent(new CustomEvent('take', { detail: box.film.hide, bubbles: true })));
    box.append(chart, values, why, take);
    box.film = { chart, halves, values, why, take };
    return box.film;
  }

  // weights: of each wavelength in the three colours of the picture; light: an illuminant of the page.
  function draw(box, scene, light, weights) {
    const made = parts(box), { chart, halves, values, why, take } = made, found = scene.drawdown;
    const is = Boolean(found && !found.why && light && found.over_black.length === scene.nm.length);
    chart.hidden = values.hidden = !is;
    made.hide = is && found.relative_depth;
    take.hidden = !is || scene.index > 0;
    take.disabled = !made.hide;
    chart.classList.toggle('preview', Boolean(is && found.preview));
    why.textContent = is ? 'as a sphere of 8° sees it, gloss included; the margins are the bare chart (black 0, white 80 %)' : found?.why || 'being solved ...';
    if (!is) return;
    const dot = (row, spectrum) => row.reduce((sum, w, i) => sum + w * spectrum[i], 0);
    const colour = (spectrum) => Colour.css(weights.map((row) => dot(row, spectrum)));
    const over = [found.over_black, found.over_white];
    const bare = [scene.nm.map(() => 0), scene.nm.map(() => found.white)];
    halves.forEach(({ half, film }, i) => {
      half.style.background = colour(bare[i]);
      film.style.background = colour(over[i]);
    });
    const [black, white] = over.map((spectrum) => dot(light.y, spectrum)), ratio = 100 * black / white;
    const { number } = Chart, rows = [
      ['Contrast ratio', `${ratio.toFixed(1)} %`, 'contrast', ratio],
      ['Y over black', (100 * black).toFixed(2), 'y-black', black],
      ['Y over white', (100 * white).toFixed(2), 'y-white', white],
      ['ΔE₀₀ of the halves', number(Colour.deltaE2000(...over.map((s) => Colour.lab(light, s))), 3), 'halves', '']];
    const { thickness_um: thickness, relative_depth: depth } = found;
    rows.push(['Hides (98 %) at', thickness ? `${number(thickness, 3)} µm` : depth ? `${number(depth, 3)} times this depth` : found.preview ? '...' : 'no depth', 'hiding', thickness || depth || '']);
    if (found.spreading_rate_m2_per_l) rows.push(['One litre of dry film covers', `${number(found.spreading_rate_m2_per_l, 3)} m²`, 'spreading', found.spreading_rate_m2_per_l]);
    values.replaceChildren(...rows.flatMap(([name, text, key, value]) => [tag('dt', {}, name), tag('dd', { 'data-key': key, 'data-value': value }, text)]));
    chart.setAttribute('aria-label', `Drawdown of ${scene.name}: over black Y ${(100 * black).toFixed(1)}, over white Y ${(100 * white).toFixed(1)}, contrast ratio ${ratio.toFixed(1)} %`);
  }

  // The chart as it stands, to be saved.
  function canvasOf(box) {
    const HALF = 400, HEIGHT = 720, MARGIN = 72, canvas = tag('canvas', { width: 2 * HALF, height: HEIGHT }), context = canvas.getContext('2d');
    box.film.halves.forEach(({ half, film }, i) => {
      context.fillStyle = half.style.background;
      context.fillRect(i * HALF, 0, HALF, HEIGHT);
      context.fillStyle = film.style.background;
      context.fillRect(i * HALF, MARGIN, HALF, HEIGHT - 2 * MARGIN);
    });
    return canvas;
  }

  return { draw, canvasOf };
})();
