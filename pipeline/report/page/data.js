// The numbers of the page: inflated once, then read as typed arrays.
const Data = (() => {
  'use strict';

  async function inflate(base64, format) {
    const text = atob(base64.trim()), bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);  // Uint8Array.from takes 20 times as long
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format));
    return new Response(stream).arrayBuffer();
  }

  // {"f32": [offset, count]}
  const floats = (store, place) => new Float32Array(store.buffer, store.start + place.f32[0], place.f32[1]);

  // {"int": [offset, count]}: the sign in the lowest bit, seven bits a byte.
  function integers(store, place) {
    const [offset, count] = place.int;
    const bytes = new Uint8Array(store.buffer, store.start + offset);
    const values = new Int32Array(count);
    for (let i = 0, at = 0; i < count; ++i) {
      let value = 0, shift = 0, byte;
      do {
        byte = bytes[at++];
        value |= (byte & 127) << shift;
        shift += 7;
      } while (byte > 127);
      values[i] = (value >>> 1) ^ -(value & 1);
    }
    return values;
  }

  // A table as a few basis columns: value = sum_k basis[row * rank + k] coefficients[k * columns + c].
  function lowRank(store, table) {
    const { rows, rank, columns } = table;
    const scale = floats(store, table.scale), columnScale = floats(store, table.column_scale);
    const unit = floats(store, table.unit);
    const whole = integers(store, table.basis), factors = integers(store, table.coefficients);
    const basis = new Float32Array(rows * rank), coefficients = new Float64Array(rank * columns);
    for (let k = 0; k < rank; ++k) {
      for (let row = 0; row < rows; ++row) basis[row * rank + k] = scale[row] * whole[k * rows + row];
      for (let c = 0; c < columns; ++c)
        coefficients[k * columns + c] = unit[k] * columnScale[c] * factors[k * columns + c];
    }
    return { rows, rank, columns, basis, coefficients };
  }

  // Rows of a matrix with this many columns.
  function rowsOf(values, columns) {
    const rows = [];
    for (let at = 0; at < values.length; at += columns) rows.push(values.subarray(at, at + columns));
    return rows;
  }

  async function load(base64) {
    const buffer = await inflate(base64, 'deflate');
    const length = new DataView(buffer).getUint32(0, true);
    const root = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    return { root, store: { buffer, start: 4 + length } };
  }

  return { inflate, floats, integers, lowRank, rowsOf, load };
})();
