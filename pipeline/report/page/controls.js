// Sliders and lists with their labels; each changes one word of the view.
const Controls = (() => {
  'use strict';
  const made = [];

  // options: key, label, min, max, step, text(value), title
  function slider(parent, view, options, changed) {
    const label = document.createElement('label');
    label.className = 'control';
    label.innerHTML = '<span class="label"><span></span><output></output></span><input type="range">';
    label.querySelector('.label > span').textContent = options.label;
    const input = label.querySelector('input'), output = label.querySelector('output');
    const { min, max, step } = options;
    Object.assign(input, { min, max, step, id: `c-${options.key}` });
    input.setAttribute('aria-label', options.label);
    if (options.title) label.title = options.title;
    const show = () => {
      input.value = view[options.key];
      output.textContent = options.text(view[options.key]);
      input.setAttribute('aria-valuetext', output.textContent);
    };
    input.addEventListener('input', () => {
      view[options.key] = Number(input.value);
      show();
      changed(options.key);
    });
    parent.appendChild(label);
    made.push(show);
    show();
    return input;
  }

  // options: key, label, choices: [[value, text], ...]
  function list(parent, view, options, changed) {
    const label = document.createElement('label');
    label.className = 'control';
    label.innerHTML = '<span class="label"><span></span></span><select></select>';
    label.querySelector('.label > span').textContent = options.label;
    const select = label.querySelector('select');
    select.id = `c-${options.key}`;
    for (const [value, text] of options.choices) select.add(new Option(text, value));
    const show = () => { select.value = view[options.key]; };
    select.addEventListener('change', () => {
      view[options.key] = select.value;
      changed(options.key);
    });
    parent.appendChild(label);
    made.push(show);
    show();
    return select;
  }

  // Turning by dragging, or by arrow keys; with Shift `second` moves in place of `first`.
  function turnable(element, first, second, clicked) {
    let last = null, moved = 0, buttonOrShift = false;
    element.tabIndex = 0;
    element.addEventListener('pointerdown', (event) => {
      element.setPointerCapture(event.pointerId);
      last = [event.clientX, event.clientY];
      moved = 0;
      buttonOrShift = event.shiftKey || event.button === 2;
    });
    element.addEventListener('pointermove', (event) => {
      if (!last) return;
      const dx = event.clientX - last[0], dy = event.clientY - last[1];
      moved += Math.abs(dx) + Math.abs(dy);
      last = [event.clientX, event.clientY];
      if (moved > 4) (buttonOrShift ? second : first)(dx * 0.5, dy * 0.5);
    });
    const end = (event) => {
      if (last && moved <= 4 && event.type === 'pointerup' && clicked) {
        const box = element.getBoundingClientRect();
        clicked(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height);
      }
      last = null;
    };
    element.addEventListener('pointerup', end);
    element.addEventListener('pointercancel', end);
    element.addEventListener('contextmenu', (event) => event.preventDefault());
    element.addEventListener('keydown', (event) => {
      const step = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, -5], ArrowDown: [0, 5] }[event.key];
      if (!step) return;
      event.preventDefault();
      (event.shiftKey ? second : first)(...step);
    });
  }

  return { slider, list, turnable, refresh: () => made.forEach((show) => show()) };
})();
