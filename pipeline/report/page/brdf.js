// The solved BRDF at any directions: the same sums as CompactTable::evaluate of the program.
const Brdf = (() => {
  'use strict';
  const PI = Math.PI;

  // Place of a share of [0, 1] among nodes at sin^2(pi x / 2), x = 0 ... 1.
  const place = (share) => 2 / PI * Math.asin(Math.sqrt(Math.min(1, Math.max(0, share))));

  // Six neighbouring nodes of `count` and their Lagrange weights.
  const factor = [-1 / 120, 1 / 24, -1 / 12, 1 / 12, -1 / 24, 1 / 120];
  function sixNodes(at, count) {
    const first = Math.min(count - 6, Math.max(0, Math.floor(at) - 2)), t = at - first;
    const weight = factor.map((f, i) => {
      for (let j = 0; j < 6; ++j) if (j !== i) f *= t - j;
      return f;
    });
    return { first, weight };
  }

  // A function of a cosine, given at nodes.
  function atCosine(values, mu, offset = 0, count = values.length) {
    const { first, weight } = sixNodes(place(mu) * (count - 1), count);
    let sum = 0;
    for (let k = 0; k < 6; ++k) sum += weight[k] * values[offset + first + k];
    return sum;
  }

  const cosTheta = (muIn, muOut, azimuthDeg) => Math.min(1, Math.max(-1,
    -muIn * muOut + Math.sqrt((1 - muIn * muIn) * (1 - muOut * muOut)) * Math.cos(azimuthDeg * PI / 180)));

  class Solved {
    constructor(store, table, wavelengths) {
      this.wavelengths = wavelengths;
      this.cosines = table.cosines;
      this.orders = Data.integers(store, table.orders);
      this.firstRow = new Int32Array(this.orders.length);
      for (let p = 1; p < this.orders.length; ++p) this.firstRow[p] = this.firstRow[p - 1] + this.orders[p - 1];
      this.multiple = Data.lowRank(store, table.multiple);
      this.angles = table.angles;
      this.slants = table.slants;
      this.firstQ = table.first_q;
      this.lastQ = table.last_q;
      if (this.angles) this.once = Data.lowRank(store, table.once);
      if (table.in) {
        this.in = Data.floats(store, table.in);
        this.out = Data.floats(store, table.out);
      }
      const lobe = table.lobe;
      if (lobe) {
        this.lobe = { ...lobe, masking: Data.floats(store, lobe.masking), fresnel: Data.floats(store, lobe.fresnel),
          scale: lobe.scale && Data.floats(store, lobe.scale) };
        this.nodes = this.lobe.masking.length;
      }
    }

    // (1/pi times) the reflection function of the layers under the surface, at every wavelength.
    // cosOfAngle: cos of the scattering angle where the caller knows it, to use what is cached.
    layers(muIn, muOut, azimuthDeg, cosOfAngle = cosTheta(muIn, muOut, azimuthDeg)) {
      const W = this.wavelengths, sum = new Float64Array(W);
      this.addMultiple(muIn, muOut, azimuthDeg, sum);
      if (this.angles) this.addOnce(muIn, muOut, cosOfAngle, sum);
      for (let w = 0; w < W; ++w) {
        sum[w] /= PI;
        if (this.in) {
          const n = this.in.length / W;
          sum[w] *= atCosine(this.in, muIn, w * n, n) * atCosine(this.out, muOut, w * n, n);
        }
      }
      return sum;
    }

    addMultiple(muIn, muOut, azimuthDeg, sum) {
      const { rank, basis, coefficients } = this.multiple, n = this.cosines, W = this.wavelengths;
      const a = sixNodes(place(muIn) * (n - 1), n), b = sixNodes(place(muOut) * (n - 1), n);
      const inBasis = new Float64Array(rank), c1 = Math.cos(azimuthDeg * PI / 180);
      for (let i = 0; i < 6; ++i) {
        for (let o = 0; o < 6; ++o) {
          const low = Math.min(a.first + i, b.first + o), high = Math.max(a.first + i, b.first + o);
          const pair = low * n - low * (low - 1) / 2 + high - low;
          const weight = a.weight[i] * b.weight[o];
          let cosM = weight, before = weight * c1;  // cos(m phi), m = 0, and that of m = -1
          let at = this.firstRow[pair] * rank;
          for (let m = this.orders[pair]; m > 0; --m) {
            for (let k = 0; k < rank; ++k) inBasis[k] += cosM * basis[at++];
            const next = 2 * c1 * cosM - before;
            before = cosM;
            cosM = next;
          }
        }
      }
      const scale = 1 / (muIn + muOut);
      for (let k = 0; k < rank; ++k) {
        for (let w = 0; w < W; ++w) sum[w] += scale * inBasis[k] * coefficients[k * W + w];
      }
    }

    // Light scattered once by this angle: [slant][wavelength]; the last angle is kept.
    onceAtAngle(cosOfAngle) {
      if (this.cached && this.cached.cosOfAngle === cosOfAngle) return this.cached.values;
      const { rank, columns, basis, coefficients } = this.once;
      const angle = sixNodes(place(Math.acos(cosOfAngle) / PI) * (this.angles - 1), this.angles);
      const values = new Float64Array(columns);
      for (let k = 0; k < rank; ++k) {
        let sum = 0;
        for (let i = 0; i < 6; ++i) sum += angle.weight[i] * basis[(angle.first + i) * rank + k];
        for (let c = 0; c < columns; ++c) values[c] += sum * coefficients[k * columns + c];
      }
      this.cached = { cosOfAngle, values };
      return values;
    }

    addOnce(muIn, muOut, cosOfAngle, sum) {
      const W = this.wavelengths, scale = 1 / (4 * (muIn + muOut));
      const values = this.onceAtAngle(cosOfAngle);
      if (this.slants === 1) {
        for (let w = 0; w < W; ++w) sum[w] += scale * values[w];
        return;
      }
      const q = Math.min(this.lastQ, 1 / muIn + 1 / muOut);
      const slant = sixNodes(Math.log(q / this.firstQ) / Math.log(this.lastQ / this.firstQ) * (this.slants - 1), this.slants);
      for (let k = 0; k < 6; ++k) {
        const at = (slant.first + k) * W;
        for (let w = 0; w < W; ++w) sum[w] += scale * slant.weight[k] * values[at + w];
      }
    }

    // G / (4 mu_in mu_out) of the surface, and Fresnel's share with it, from wavelength `first` on.
    lobeWithoutDensity(muIn, muOut, cosHalf, cosFacet, first = 0, last = this.wavelengths) {
      const { masking, fresnel, scale, shadowing } = this.lobe, n = this.nodes;
      const a = atCosine(masking, muIn), b = atCosine(masking, muOut);
      let g = 1 / (a * b);
      if (shadowing === 'correlated') g = 1 / (a * muOut + b * muIn - muIn * muOut);
      if (shadowing === 'v-cavity') g = Math.min(1, 2 * cosHalf * Math.min(muIn, muOut) / cosFacet) / (muIn * muOut);
      const values = new Float64Array(last - first);
      for (let w = first; w < last; ++w) {
        values[w - first] = 0.25 * g * atCosine(fresnel, cosFacet, w * n, n);
        if (scale) values[w - first] *= atCosine(scale, muIn, w * n, n) * atCosine(scale, muOut, w * n, n);
      }
      return values;
    }

    // Density of the facets' normals.
    density(cosHalf) {
      const { ggx, alpha } = this.lobe, cos2 = cosHalf * cosHalf;
      const t = (1 - cos2) / cos2 / (alpha * alpha);
      return (ggx ? 1 / ((1 + t) * (1 + t)) : Math.exp(-t)) / (PI * alpha * alpha * cos2 * cos2);
    }

    // BRDF [1/sr] at every wavelength.
    // inPicture: with the narrow lobe that stands for the mirror reflection of a smooth boundary.
    evaluate(muIn, muOut, azimuthDeg, inPicture = false) {
      const values = this.layers(muIn, muOut, azimuthDeg);
      if (!this.lobe || (this.lobe.only_in_pictures && !inPicture)) return values;
      const lobe = this.lobeOf(muIn, muOut, azimuthDeg, 0, this.wavelengths);
      for (let w = 0; w < values.length; ++w) values[w] += lobe[w];
      return values;
    }

    lobeOf(muIn, muOut, azimuthDeg, first, last) {
      const length = Math.sqrt(Math.max(1e-12, 2 - 2 * cosTheta(muIn, muOut, azimuthDeg)));
      const cosHalf = Math.min(1, (muIn + muOut) / length), d = this.density(cosHalf);
      return this.lobeWithoutDensity(muIn, muOut, cosHalf, 0.5 * length, first, last).map((v) => d * v);
    }

    // Both tables at one wavelength, without their bases; the last one is kept.
    tablesAt(w) {
      if (this.one && this.one.w === w) return this.one;
      const W = this.wavelengths, { rank, rows, basis, coefficients } = this.multiple;
      const multiple = new Float64Array(rows);
      for (let row = 0; row < rows; ++row) {
        for (let k = 0; k < rank; ++k) multiple[row] += basis[row * rank + k] * coefficients[k * W + w];
      }
      let once = null;
      if (this.angles) {
        once = new Float64Array(this.angles * this.slants);
        const { rank: n, columns, basis: b, coefficients: c } = this.once;
        for (let a = 0; a < this.angles; ++a) {
          for (let k = 0; k < n; ++k) {
            for (let s = 0; s < this.slants; ++s) once[a * this.slants + s] += b[a * n + k] * c[k * columns + s * W + w];
          }
        }
      }
      return this.one = { w, multiple, once };
    }

    // evaluate() at one wavelength, for many directions.
    evaluateAt(w, muIn, muOut, azimuthDeg) {
      const { multiple, once } = this.tablesAt(w), n = this.cosines;
      const a = sixNodes(place(muIn) * (n - 1), n), b = sixNodes(place(muOut) * (n - 1), n);
      const c1 = Math.cos(azimuthDeg * PI / 180);
      let sum = 0;
      for (let i = 0; i < 6; ++i) {
        for (let o = 0; o < 6; ++o) {
          const low = Math.min(a.first + i, b.first + o), high = Math.max(a.first + i, b.first + o);
          const pair = low * n - low * (low - 1) / 2 + high - low;
          let cosM = a.weight[i] * b.weight[o], before = cosM * c1, at = this.firstRow[pair];
          for (let m = this.orders[pair]; m > 0; --m) {
            sum += cosM * multiple[at++];
            const next = 2 * c1 * cosM - before;
            before = cosM;
            cosM = next;
          }
        }
      }
      if (once) {
        const angle = sixNodes(place(Math.acos(cosTheta(muIn, muOut, azimuthDeg)) / PI) * (this.angles - 1), this.angles);
        const q = Math.min(this.lastQ, 1 / muIn + 1 / muOut), S = this.slants;
        const slant = S === 1 ? { first: 0, weight: [1] }
          : sixNodes(Math.log(q / this.firstQ) / Math.log(this.lastQ / this.firstQ) * (S - 1), S);
        for (let i = 0; i < 6; ++i) {
          slant.weight.forEach((weight, k) => { sum += 0.25 * angle.weight[i] * weight * once[(angle.first + i) * S + slant.first + k]; });
        }
      }
      sum /= PI * (muIn + muOut);
      if (this.in) {
        const nodes = this.in.length / this.wavelengths;
        sum *= atCosine(this.in, muIn, w * nodes, nodes) * atCosine(this.out, muOut, w * nodes, nodes);
      }
      return this.lobe && !this.lobe.only_in_pictures ? sum + this.lobeOf(muIn, muOut, azimuthDeg, w, w + 1)[0] : sum;
    }
  }

  return { Solved, place, sixNodes, atCosine };
})();
