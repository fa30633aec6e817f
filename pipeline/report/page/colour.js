// From spectra to colours (CIE 1931 observer), and how colours look on a screen.
const Colour = (() => {
  'use strict';

  const dot = (weights, spectrum) => {
    let sum = 0;
    for (let w = 0; w < spectrum.length; ++w) sum += weights[w] * spectrum[w];
    return sum;
  };

  const xyz = (light, spectrum) => [dot(light.x, spectrum), dot(light.y, spectrum), dot(light.z, spectrum)];

  // Linear sRGB of an eye adapted to the illuminant; a reflectance of 1 is (1, 1, 1).
  function linear(light, spectrum) {
    const [x, y, z] = xyz(light, spectrum), m = light.srgb;
    return [m[0] * x + m[1] * y + m[2] * z, m[3] * x + m[4] * y + m[5] * z, m[6] * x + m[7] * y + m[8] * z];
  }

  // Weights of each wavelength in red, green and blue.
  function linearWeights(light) {
    const m = light.srgb;
    return [0, 3, 6].map((row) =>
      light.x.map((_, w) => m[row] * light.x[w] + m[row + 1] * light.y[w] + m[row + 2] * light.z[w]));
  }

  // CIE 1976 (ISO/CIE 11664-4).
  function lab(light, spectrum) {
    const f = xyz(light, spectrum).map((value, i) => {
      const t = value / light.white[i];
      return t > 216 / 24389 ? Math.cbrt(t) : (24389 / 27 * t + 16) / 116;
    });
    return [116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])];
  }

  // CIEDE2000 with kL = kC = kH = 1, in the steps of Sharma, Wu & Dalal (2005).
  function deltaE2000([l1, a1, b1], [l2, a2, b2]) {
    const rad = Math.PI / 180, pow7 = (c) => Math.sqrt(c ** 7 / (c ** 7 + 25 ** 7));
    const g = 0.5 * (1 - pow7((Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2));
    const p1 = (1 + g) * a1, p2 = (1 + g) * a2, c1 = Math.hypot(p1, b1), c2 = Math.hypot(p2, b2);
    const hue = (b, a) => (a === 0 && b === 0 ? 0 : (Math.atan2(b, a) / rad + 360) % 360);
    const h1 = hue(b1, p1), h2 = hue(b2, p2);
    let step = h2 - h1, mean = h1 + h2;
    if (c1 * c2 === 0) step = 0;
    else {
      if (Math.abs(h1 - h2) > 180) mean += mean < 360 ? 360 : -360;
      mean /= 2;
      if (step > 180) step -= 360;
      if (step < -180) step += 360;
    }
    const l = (l1 + l2) / 2, c = (c1 + c2) / 2;
    const dh = 2 * Math.sqrt(c1 * c2) * Math.sin(step / 2 * rad);
    const t = 1 - 0.17 * Math.cos((mean - 30) * rad) + 0.24 * Math.cos(2 * mean * rad) +
      0.32 * Math.cos((3 * mean + 6) * rad) - 0.2 * Math.cos((4 * mean - 63) * rad);
    const sl = 1 + 0.015 * (l - 50) ** 2 / Math.sqrt(20 + (l - 50) ** 2);
    const sc = 1 + 0.045 * c, sh = 1 + 0.015 * c * t;
    const rotation = -Math.sin(60 * rad * Math.exp(-(((mean - 275) / 25) ** 2))) * 2 * pow7(c);
    const dl = (l2 - l1) / sl, dc = (c2 - c1) / sc, dhh = dh / sh;
    return Math.sqrt(dl * dl + dc * dc + dhh * dhh + rotation * dc * dhh);
  }

  // IEC 61966-2-1, clipped to [0, 1].
  function encode(value) {
    const v = Math.min(1, Math.max(0, value));
    return v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
  }
  const css = (rgb) => `rgb(${rgb.map((v) => Math.round(255 * encode(v))).join(' ')})`;

  // Viridis, from dark to light: legible to the colour-blind and in grey.
  const stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  function scale(t) {
    const at = Math.min(1, Math.max(0, t)) * (stops.length - 1), i = Math.min(stops.length - 2, Math.floor(at));
    return stops[i].map((from, c) => (from + (at - i) * (stops[i + 1][c] - from)) / 255);
  }

  return { linear, linearWeights, lab, deltaE2000, encode, css, scale };
})();
