// Line charts as SVG, with a cross-hair that the mouse, a finger or the arrow keys move.
const Chart = (() => {
  'use strict';
  const NS = 'http://www.w3.org/2000/svg';

  function svg(name, attributes, parent, text) {
    const element = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    if (parent) parent.appendChild(element);
    return element;
  }

  // Three or more significant digits, never a long tail.
  function number(value, digits = 4) {
    if (!Number.isFinite(value)) return '–';
    if (value === 0) return '0';
    const size = Math.abs(value);
    if (size < 1e-3 || size >= 1e5) {
      const [m, e] = value.toExponential(digits - 1).split('e');
      const exponent = String(Number(e)).replace('-', '⁻').replace(/\d/g, (d) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[d]);
      return `${m.replace('-', '−')}·10${exponent}`;
    }
    return value.toPrecision(digits).replace('-', '−');
  }

  // Round numbers from low to high.
  function ticks(low, high, wanted) {
    const rough = (high - low) / wanted, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 2.5, 5, 10].map((f) => f * power).find((s) => s >= rough * 0.999);
    const list = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) list.push(Number((k * step).toPrecision(12)));
    return list;
  }
  function powers(low, high, wanted) {
    const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
    const step = Math.max(1, Math.ceil((last - first) / wanted)), list = [];
    for (let e = first; e <= last; e += step) list.push(10 ** e);
    return list;
  }
  const tickText = (value, log) => {
    if (!log) return String(value).replace('-', '−');
    const e = Math.round(Math.log10(value));
    return e >= -2 && e <= 3 ? String(value) : '10' + String(e).replace('-', '⁻').replace(/\d/g, (d) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[d]);
  };

  class LineChart {
    // options: title, xName, yName, xUnit, yUnit, file; log: true, or 'wide': where values differ by
    // more than 30; zero: the axis starts at 0; most: the axis ends there
    constructor(parent, options) {
      this.options = options;
      this.figure = document.createElement('figure');
      this.figure.className = 'chart';
      this.figure.innerHTML = '<figcaption><h3></h3><button type="button" class="quiet">CSV</button></figcaption><div class="plot"></div><div class="legend"></div>';
      this.figure.querySelector('h3').textContent = options.title;
      const button = this.figure.querySelector('button');
      button.title = `Save the numbers of “${options.title}” as CSV`;
      button.addEventListener('click', () => this.save());
      this.plot = this.figure.querySelector('.plot');
      this.legend = this.figure.querySelector('.legend');
      this.plot.tabIndex = 0;
      this.plot.setAttribute('role', 'img');
      this.plot.addEventListener('pointermove', (event) => this.point(event));
      this.plot.addEventListener('pointerdown', (event) => this.point(event));
      this.plot.addEventListener('pointerleave', () => this.show(null));
      this.plot.addEventListener('keydown', (event) => this.key(event));
      parent.appendChild(this.figure);
      new ResizeObserver(() => requestAnimationFrame(() => this.width !== this.plot.clientWidth && this.draw())).observe(this.plot);
      this.series = [];
    }

    // series: { name, x, y, style: 0, 1, ... (colour), dash, points: true where they are circles }; the first has a line
    set(series) {
      this.series = series.filter((s) => s.x.length > 0);
      const values = this.series.flatMap((s) => Array.from(s.y)).filter((v) => v > 0);
      this.log = this.options.log === true || (this.options.log === 'wide' && Math.max(...values) > 30 * Math.min(...values));
      this.draw();
    }

    ranges() {
      const { zero, most } = this.options, { log } = this;
      const all = (key) => this.series.flatMap((s) => Array.from(s[key])).filter((v) => Number.isFinite(v) && (key === 'x' || !log || v > 0));
      const xs = all('x'), ys = all('y');
      const x = [Math.min(...xs), Math.max(...xs)];
      let y = ys.length ? [Math.min(...ys), Math.max(...ys)] : [0, 1];
      if (log) y = [10 ** Math.floor(Math.log10(y[0])), 10 ** Math.ceil(Math.log10(y[1] * 1.0001))];
      else {
        if (zero) y[0] = Math.min(0, y[0]);
        const room = y[1] - y[0] || Math.abs(y[1]) || 1;
        y = [zero && y[0] === 0 ? 0 : y[0] - 0.06 * room, Math.min(most || Infinity, y[1] + 0.06 * room)];
      }
      return { x, y };
    }

    draw() {
      const width = this.width = this.plot.clientWidth;
      if (!width || !this.series.length) return;
      const height = Math.round(Math.min(280, Math.max(200, width * 0.52)));
      const { x, y } = this.ranges(), { log } = this;
      const levels = log ? powers(y[0], y[1], 6) : ticks(y[0], y[1], 5);
      // Digits of 13 px are 8 px wide at most; the axis's name has 24 px beside them.
      const widest = Math.max(...levels.map((v) => tickText(v, log).length));
      const box = { left: Math.max(58, 32 + 8 * widest), right: width - 12, top: 10, bottom: height - 42 };
      const level = log ? Math.log10 : (v) => v;
      this.px = (v) => box.left + (v - x[0]) / (x[1] - x[0] || 1) * (box.right - box.left);
      this.py = (v) => box.bottom - (level(v) - level(y[0])) / (level(y[1]) - level(y[0])) * (box.bottom - box.top);
      this.box = box;
      this.plot.replaceChildren();
      const root = svg('svg', { width, height, viewBox: `0 0 ${width} ${height}` }, this.plot);
      for (const value of levels) {
        const at = this.py(value);
        svg('line', { x1: box.left, x2: box.right, y1: at, y2: at, class: 'grid' }, root);
        svg('text', { x: box.left - 8, y: at + 4, class: 'tick end' }, root, tickText(value, log));
      }
      for (const value of ticks(x[0], x[1], Math.max(3, Math.floor(width / 90)))) {
        const at = this.px(value);
        svg('line', { x1: at, x2: at, y1: box.bottom, y2: box.bottom + 5, class: 'axis' }, root);
        svg('text', { x: at, y: box.bottom + 19, class: 'tick middle' }, root, tickText(value, false));
      }
      svg('line', { x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom, class: 'axis' }, root);
      const { xName, xUnit, yName, yUnit } = this.options;
      svg('text', { x: (box.left + box.right) / 2, y: height - 6, class: 'name middle' }, root, xUnit ? `${xName} (${xUnit})` : xName);
      svg('text', { x: 14, y: (box.top + box.bottom) / 2, class: 'name middle', transform: `rotate(-90 14 ${(box.top + box.bottom) / 2})` },
        root, yUnit ? `${yName} (${yUnit})` : yName);
      for (const s of this.series) {
        if (s.points) {
          for (let i = 0; i < s.x.length; ++i) {
            if (Number.isFinite(s.y[i]) && (!log || s.y[i] > 0)) svg('circle', { cx: this.px(s.x[i]).toFixed(1), cy: this.py(s.y[i]).toFixed(1), r: 3, class: `mark style${s.style}` }, root);
          }
          continue;
        }
        let path = '';
        for (let i = 0, down = false; i < s.x.length; ++i) {
          const fits = Number.isFinite(s.y[i]) && (!log || s.y[i] > 0);
          if (fits) path += `${down ? 'L' : 'M'}${this.px(s.x[i]).toFixed(1)} ${this.py(s.y[i]).toFixed(1)}`;
          down = fits;
        }
        svg('path', { d: path, class: `line style${s.style}`, 'stroke-dasharray': s.dash || 'none' }, root);
      }
      this.cross = svg('g', { class: 'cross', visibility: 'hidden' }, root);
      this.root = root;
      this.show(null);
      this.plot.setAttribute('aria-label', `${this.options.title}: ${this.series.map((s) => s.name).join(', ')}. Arrow keys read values.`);
    }

    show(index) {
      this.at = index;
      const x = index === null ? null : this.series[0].x[index];
      this.legend.replaceChildren(...this.series.map((s) => {
        const item = document.createElement('span');
        item.className = 'key';
        const near = x === null ? -1 : this.nearest(s.x, x);
        const dash = s.dash ? ` stroke-dasharray="${s.dash}"` : '';
        item.innerHTML = s.points ? `<svg width="26" height="10" aria-hidden="true"><circle cx="13" cy="5" r="3" class="mark style${s.style}"/></svg><span></span><b></b>`
          : `<svg width="26" height="10" aria-hidden="true"><line x1="1" x2="25" y1="5" y2="5" class="line style${s.style}"${dash}/></svg><span></span><b></b>`;
        item.children[1].textContent = s.name;
        item.querySelector('b').textContent = near < 0 ? '' : number(s.y[near]);
        return item;
      }));
      this.cross.replaceChildren();
      this.cross.setAttribute('visibility', x === null ? 'hidden' : 'visible');
      if (x === null) return;
      const at = this.px(x);
      svg('line', { x1: at, x2: at, y1: this.box.top, y2: this.box.bottom, class: 'hair' }, this.cross);
      const right = at > (this.box.left + this.box.right) / 2;
      svg('text', { x: at + (right ? -6 : 6), y: this.box.top + 11, class: `tick ${right ? 'end' : ''}` }, this.cross,
        `${number(x)} ${this.options.xUnit || ''}`);
      for (const s of this.series) {
        const i = this.nearest(s.x, x), value = s.y[i];
        if (Number.isFinite(value) && (!this.log || value > 0))
          svg('circle', { cx: this.px(s.x[i]), cy: this.py(value), r: 3.5, class: `dot style${s.style}` }, this.cross);
      }
    }

    nearest(list, value) {
      let best = 0;
      for (let i = 1; i < list.length; ++i) if (Math.abs(list[i] - value) < Math.abs(list[best] - value)) best = i;
      return best;
    }

    point(event) {
      if (!this.series.length || !this.box) return;
      const at = event.clientX - this.plot.getBoundingClientRect().left, x = this.series[0].x;
      let best = 0;
      for (let i = 1; i < x.length; ++i) if (Math.abs(this.px(x[i]) - at) < Math.abs(this.px(x[best]) - at)) best = i;
      this.show(best);
    }

    key(event) {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!step || !this.series.length) return;
      event.preventDefault();
      const last = this.series[0].x.length - 1;
      this.show(Math.min(last, Math.max(0, this.at === null ? (step > 0 ? 0 : last) : this.at + step)));
    }

    save() {
      const { xName, xUnit, yName, yUnit, file } = this.options;
      const quote = (text) => `"${text.replace(/"/g, '""')}"`;
      const lines = [`# ${document.title}`, `# x: ${xName} ${xUnit || ''}; y: ${yName} ${yUnit || ''}`, 'curve,x,y'];
      for (const s of this.series) for (let i = 0; i < s.x.length; ++i) lines.push(`${quote(s.name)},${s.x[i]},${s.y[i]}`);
      saveText(`${file}.csv`, lines.join('\n') + '\n');
    }
  }

  function saveText(name, text) {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], { type: 'text/csv' }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  return { LineChart, number, svg, saveText };
})();
