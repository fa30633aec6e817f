// A lit object. Lamp and camera are far away, so that the colour of a place depends on its normal
// alone: it is computed from the whole spectrum on a small grid of normals, in the coordinates in
// which planets are measured (longitude from the camera towards the lamp, latitude across), and
// interpolated in the shader, or without WebGL by the processor. The narrow lobe of a surface is
// drawn at every pixel.
const ObjectView = (() => {
  'use strict';
  const PI = Math.PI, NX = 24, NY = 14, ROWS = 2 * NY + 2;
  const LEAST = 1e-3;  // cosine that stands for the horizon

  // A direction of the room as the camera sees it: x right, y up, z to the camera.
  function inView(view, [x0, y0, z0]) {
    const yaw = -view.yaw * PI / 180, pitch = view.pitch * PI / 180;
    const x = x0 * Math.cos(yaw) + z0 * Math.sin(yaw), z1 = -x0 * Math.sin(yaw) + z0 * Math.cos(yaw);
    return [x, y0 * Math.cos(pitch) - z1 * Math.sin(pitch), y0 * Math.sin(pitch) + z1 * Math.cos(pitch)];
  }
  function lampInView(view) {
    const ly = view.lampYaw * PI / 180, lp = view.lampPitch * PI / 180;
    return inView(view, [Math.sin(ly) * Math.cos(lp), Math.sin(lp), Math.cos(ly) * Math.cos(lp)]);
  }

  // The surroundings, mean radiance 1: a room that is brighter towards the ceiling, with two square
  // lights. Matt parts are lit by what comes from there, mirrors show it, rough ones blurred.
  // [direction of its middle, of its side, half its width, of its height]
  const ROOM = { middle: 0.55, rise: 0.45, light: 4, boxes: [[[-0.64, 0.6, 0.48], [0.6, 0, 0.8], 0.36, 0.5], [[0.8, 0.36, 0.48], [0.514, 0, -0.857], 0.22, 0.8]] };
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const vec3 = (v) => `vec3(${v.map((c) => c.toFixed(6)).join(', ')})`;
  const ROOM_SHADER = `
    float inBox(vec3 d, vec3 middle, vec3 side, vec3 up, vec2 size, float blur) {
      float far = dot(d, middle);
      vec2 at = abs(vec2(dot(d, side), dot(d, up))) / max(far, 1e-3), edge = vec2(0.01 + blur);
      vec2 inside = (1.0 - smoothstep(size - edge, size + edge, at)) / (1.0 + edge * edge / (size * size));
      return far > 0.0 ? inside.x * inside.y : 0.0;
    }
    float seenOfRoom(vec3 d, float blur) {
      return ${ROOM.middle} + ${ROOM.rise} * d.y / (1.0 + blur) + ${ROOM.light.toFixed(1)} * (${ROOM.boxes.map(([m, s, w, h]) =>
        `inBox(d, ${vec3(m)}, ${vec3(s)}, ${vec3(cross(m, s))}, vec2(${w}, ${h}), blur)`).join(' + ')});
    }
    float lightFromRoom(vec3 n) {
      return ${ROOM.middle} + ${(ROOM.rise * 2 / 3).toFixed(4)} * n.y + ${ROOM.boxes.map(([m, , w, h]) =>
        `${(ROOM.light * 4 * w * h / PI).toFixed(4)} * max(0.0, dot(n, ${vec3(m)}))`).join(' + ')};
    }`;
  // The same two by the processor.
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  function seenOfRoom(d, blur) {
    let sum = ROOM.middle + ROOM.rise * d[1] / (1 + blur);
    for (const [m, s, w, h] of ROOM.boxes) {
      const far = dot(d, m), edge = 0.01 + blur;
      if (far <= 0) continue;
      let share = ROOM.light;
      for (const [axis, size] of [[s, w], [cross(m, s), h]]) {
        const t = Math.min(1, Math.max(0, (size + edge - Math.abs(dot(d, axis)) / Math.max(far, 1e-3)) / (2 * edge)));
        share *= t * t * (3 - 2 * t) / (1 + edge * edge / (size * size));
      }
      sum += share;
    }
    return sum;
  }
  const lightFromRoom = (n) => ROOM.middle + ROOM.rise * 2 / 3 * n[1] + ROOM.boxes.reduce((sum, [m, , w, h]) => sum + ROOM.light * 4 * w * h / PI * Math.max(0, dot(n, m)), 0);
  const roomInView = (view) => [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => inView(view, axis));
  // How far what a scene mirrors is blurred.
  const blurOf = ({ lobe }) => (lobe ? 1.5 * lobe.alpha : 0);

  // Table of colours over normals: RGBA rows of NX: layers (NY rows), lobe (NY rows), sky (one), and what of it
  // is mirrored (one).
  function bake(scene, lamp, weights, table) {
    const { solved, sky, mirror } = scene, W = solved.wavelengths;
    const gamma = Math.acos(Math.min(1, Math.max(-1, lamp[2]))), cosOfAngle = -Math.cos(gamma);
    const write = (x, y, spectrum, factor) => {
      for (let c = 0; c < 3; ++c) {
        let sum = 0;
        for (let w = 0; w < W; ++w) sum += weights[c][w] * spectrum[w];
        table[4 * (y * NX + x) + c] = factor * sum;
      }
    };
    const share = (k, count) => Math.sin(PI / 2 * k / (count - 1)) ** 2;
    const cosFacet = Math.cos(gamma / 2);
    for (let x = 0; x < NX; ++x) {
      const longitude = gamma - PI / 2 + share(x, NX) * (PI - gamma);
      for (let y = 0; y < NY; ++y) {
        const cosLatitude = share(y, NY);
        const out = Math.max(LEAST, cosLatitude * Math.cos(longitude));
        const into = Math.max(LEAST, cosLatitude * Math.cos(longitude - gamma));
        const sines = Math.sqrt((1 - into * into) * (1 - out * out));
        const cosAzimuth = sines > 0 ? Math.min(1, Math.max(-1, (cosOfAngle + into * out) / sines)) : 1;
        const factor = PI * (into + out);
        write(x, y, solved.layers(into, out, Math.acos(cosAzimuth) * 180 / PI, cosOfAngle), factor);
        if (!solved.lobe) continue;
        const cosHalf = Math.min(1, (into + out) / (2 * cosFacet));
        write(x, NY + y, solved.lobeWithoutDensity(into, out, cosHalf, cosFacet), factor);
      }
      const mu = share(x, NX), spectrum = sky.map((values) => Brdf.atCosine(values, mu));
      write(x, 2 * NY, spectrum, 1);
      // Of a rough surface about what facets along the surface mirror.
      const degrees = Math.min(88.999, Math.acos(mu) * 180 / PI), at = Math.floor(degrees), beyond = degrees - at, n = solved.nodes;
      write(x, 2 * NY + 1, spectrum.map((all, w) => Math.min(all, mirror ? (1 - beyond) * mirror[w][at] + beyond * mirror[w][at + 1]
        : solved.lobe ? Brdf.atCosine(solved.lobe.fresnel, mu, w * n, n) : 0)), 1);
    }
    return gamma;
  }

  // Radiance of a white surface that faces the lamp = 1; linear RGB at a normal in the camera's frame.
  // room: the axes of the room in the camera's frame; none: a sky that is everywhere alike
  function shade(table, solved, lamp, gamma, skyLight, normal, room) {
    const out = normal[2], into = normal[0] * lamp[0] + normal[1] * lamp[1] + normal[2] * lamp[2];
    const rgb = [0, 0, 0];
    if (out <= 0) return rgb;
    const sum = (sixX, sixY, row, factor) => {
      for (let j = 0; j < 6; ++j) {
        for (let i = 0; i < 6; ++i) {
          const at = 4 * ((row + sixY.first + j) * NX + sixX.first + i), weight = factor * sixX.weight[i] * sixY.weight[j];
          for (let c = 0; c < 3; ++c) rgb[c] += weight * table[at + c];
        }
      }
    };
    if (into > 0) {
      const flat = Math.hypot(lamp[0], lamp[1]), ex = flat > 1e-6 ? lamp[0] / flat : 1, ey = flat > 1e-6 ? lamp[1] / flat : 0;
      const along = normal[0] * ex + normal[1] * ey;
      const longitude = Math.atan2(along, out), cosLatitude = Math.hypot(along, out);
      const sixX = Brdf.sixNodes(Brdf.place((longitude - gamma + PI / 2) / (PI - gamma)) * (NX - 1), NX);
      const sixY = Brdf.sixNodes(Brdf.place(cosLatitude) * (NY - 1), NY), factor = into / (into + out);
      sum(sixX, sixY, 0, factor);
      if (solved.lobe) {
        const cosHalf = Math.min(1, (into + out) / (2 * Math.cos(gamma / 2)));
        sum(sixX, sixY, NY, factor * solved.density(cosHalf));
      }
    }
    if (skyLight > 0) {
      const six = Brdf.sixNodes(Brdf.place(out) * (NX - 1), NX), inRoom = (v) => room.map((axis) => dot(axis, v));
      const matt = room ? lightFromRoom(inRoom(normal)) : 1;
      const mirrored = (room ? seenOfRoom(inRoom([2 * out * normal[0], 2 * out * normal[1], 2 * out * out - 1]), blurOf(solved)) : 1) - matt;
      for (let i = 0; i < 6; ++i) {
        const at = 4 * (2 * NY * NX + six.first + i), weight = skyLight * six.weight[i];
        for (let c = 0; c < 3; ++c) rgb[c] += weight * (matt * table[at + c] + mirrored * table[at + 4 * NX + c]);
      }
    }
    return rgb;
  }

  const vertex = 'varying vec3 vNormal; void main() { vNormal = normalMatrix * normal;' +
    ' gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }';
  const fragment = `
    uniform highp sampler2D colours;
    uniform vec3 lamp;
    uniform float lampAngle, gain, skyLight, alpha, blur;
    uniform bool hasLobe, ggx, hasRoom;
    uniform vec3 room[3];
    varying vec3 vNormal;
    const int NX = ${NX}, NY = ${NY};
    float place(float share) { return ${(2 / PI).toFixed(9)} * asin(sqrt(clamp(share, 0.0, 1.0))); }
    int first(float at, int count) { return clamp(int(floor(at)) - 2, 0, count - 6); }
    void weights(float t, out float w[6]) {
      float f[6] = float[6](-1.0/120.0, 1.0/24.0, -1.0/12.0, 1.0/12.0, -1.0/24.0, 1.0/120.0);
      for (int i = 0; i < 6; ++i) {
        w[i] = f[i];
        for (int j = 0; j < 6; ++j) if (j != i) w[i] *= t - float(j);
      }
    }
    ${ROOM_SHADER}
    vec3 inRoom(vec3 v) { return vec3(dot(room[0], v), dot(room[1], v), dot(room[2], v)); }
    float encode(float v) {
      v = clamp(v, 0.0, 1.0);
      return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055;
    }
    void main() {
      vec3 n = normalize(vNormal);
      float outer = max(n.z, 0.0), inner = dot(n, lamp);
      vec3 rgb = vec3(0.0);
      float wx[6], wy[6];
      if (inner > 0.0 && outer > 0.0) {
        float flat_ = length(lamp.xy);
        vec2 e = flat_ > 1e-6 ? lamp.xy / flat_ : vec2(1.0, 0.0);
        float along = dot(n.xy, e);
        float x = place((atan(along, outer) - lampAngle + ${(PI / 2).toFixed(9)}) / (${PI.toFixed(9)} - lampAngle)) * float(NX - 1);
        float y = place(length(vec2(along, outer))) * float(NY - 1);
        int x0 = first(x, NX), y0 = first(y, NY);
        weights(x - float(x0), wx);
        weights(y - float(y0), wy);
        float density = 0.0;
        if (hasLobe) {
          float c = min(1.0, (inner + outer) / (2.0 * cos(0.5 * lampAngle))), c2 = c * c;
          float t = (1.0 - c) * (1.0 + c) / c2 / (alpha * alpha);
          density = (ggx ? 1.0 / ((1.0 + t) * (1.0 + t)) : exp(-t)) / (${PI.toFixed(9)} * alpha * alpha * c2 * c2);
        }
        for (int j = 0; j < 6; ++j) {
          for (int i = 0; i < 6; ++i) {
            float w = wx[i] * wy[j];
            rgb += w * texelFetch(colours, ivec2(x0 + i, y0 + j), 0).rgb;
            if (hasLobe) rgb += w * density * texelFetch(colours, ivec2(x0 + i, NY + y0 + j), 0).rgb;
          }
        }
        rgb *= inner / (inner + outer);
      }
      if (skyLight > 0.0) {
        float x = place(outer) * float(NX - 1);
        int x0 = first(x, NX);
        weights(x - float(x0), wx);
        float matt = hasRoom ? lightFromRoom(inRoom(n)) : 1.0;
        float mirrored = (hasRoom ? seenOfRoom(inRoom(2.0 * outer * n - vec3(0.0, 0.0, 1.0)), blur) : 1.0) - matt;
        for (int i = 0; i < 6; ++i)
          rgb += skyLight * wx[i] * (matt * texelFetch(colours, ivec2(x0 + i, 2 * NY), 0).rgb + mirrored * texelFetch(colours, ivec2(x0 + i, 2 * NY + 1), 0).rgb);
      }
      rgb *= gain;
      gl_FragColor = vec4(encode(rgb.r), encode(rgb.g), encode(rgb.b), 1.0);
    }`;

  function geometry(name) {
    if (name === 'knot') return new THREE.TorusKnotBufferGeometry(0.56, 0.2, 320, 48, 2, 3);
    if (name === 'vase') {
      const profile = [];
      for (let i = 0; i <= 64; ++i) {
        const t = i / 64, y = -0.95 + 1.9 * t;
        profile.push(new THREE.Vector2(0.3 + 0.38 * Math.sin(PI * Math.pow(t, 0.8)) ** 2 + 0.14 * t ** 6, y));
      }
      profile.unshift(new THREE.Vector2(0.001, -0.95));
      const rim = profile[profile.length - 1].x;  // closed by a lid: it has no inside to be seen
      for (const share of [0.99, 0.97, 0.5, 0.001]) profile.push(new THREE.Vector2(share * rim, 0.96 + 0.06 * (1 - share)));
      return new THREE.LatheBufferGeometry(profile, 128);
    }
    return new THREE.SphereBufferGeometry(1, 192, 96);
  }

  // Draws with WebGL 2 into a canvas.
  class Drawn3d {
    constructor(canvas) {
      this.canvas = canvas;
      this.renderer = webglRenderer(canvas);
      this.camera = new THREE.OrthographicCamera(-1.06, 1.06, 1.06, -1.06, 0.1, 10);
      this.camera.position.z = 5;
      this.table = new Float32Array(4 * NX * ROWS);
      this.texture = new THREE.DataTexture(this.table, NX, ROWS, THREE.RGBAFormat, THREE.FloatType);
      this.texture.minFilter = this.texture.magFilter = THREE.NearestFilter;
      this.texture.generateMipmaps = false;
      this.material = new THREE.ShaderMaterial({ vertexShader: vertex, fragmentShader: fragment, side: THREE.DoubleSide,
        uniforms: { colours: { value: this.texture }, lamp: { value: new THREE.Vector3() }, lampAngle: { value: 0 }, gain: { value: 1 },
          skyLight: { value: 0 }, alpha: { value: 1 }, hasLobe: { value: false }, ggx: { value: false }, blur: { value: 0 }, hasRoom: { value: false },
          room: { value: [0, 1, 2].map(() => new THREE.Vector3()) } } });
      this.mesh = new THREE.Mesh(geometry('sphere'), this.material);
      this.scene = new THREE.Scene();
      this.scene.add(this.mesh);
      this.object = 'sphere';
    }

    draw(scene, lamp, gamma, view) {
      const size = this.canvas.clientWidth || 400;
      this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
      this.renderer.setSize(size, size, false);
      if (view.object !== this.object) {
        this.mesh.geometry.dispose();
        this.mesh.geometry = geometry(view.object);
        this.object = view.object;
      }
      const u = this.material.uniforms, lobe = scene.solved.lobe;
      u.lamp.value.set(...lamp);
      u.lampAngle.value = gamma;
      u.gain.value = 2 ** view.exposure;
      u.skyLight.value = view.sky;
      u.hasLobe.value = Boolean(lobe);
      u.ggx.value = Boolean(lobe && lobe.ggx);
      u.alpha.value = lobe ? lobe.alpha : 1;
      u.blur.value = blurOf(scene.solved);
      u.hasRoom.value = view.surroundings === 'room';
      roomInView(view).forEach((axis, i) => u.room.value[i].set(...axis));
      this.texture.needsUpdate = true;
      this.mesh.rotation.set(view.pitch * PI / 180, -view.yaw * PI / 180, 0, 'XYZ');
      this.renderer.render(this.scene, this.camera);
    }

    // Normal at a place of the picture (-1 to 1 each way), or null beside the object.
    normalAt(x, y) {
      const ray = new THREE.Raycaster();
      ray.setFromCamera(new THREE.Vector2(x, y), this.camera);
      const hit = ray.intersectObject(this.mesh)[0];
      if (!hit) return null;
      const normals = this.mesh.geometry.attributes.normal, points = this.mesh.geometry.attributes.position;
      const at = (attribute, i) => new THREE.Vector3().fromBufferAttribute(attribute, i);
      const { a, b, c } = hit.face, local = this.mesh.worldToLocal(hit.point.clone());
      const share = new THREE.Vector3();
      new THREE.Triangle(at(points, a), at(points, b), at(points, c)).getBarycoord(local, share);
      const normal = at(normals, a).multiplyScalar(share.x).addScaledVector(at(normals, b), share.y).addScaledVector(at(normals, c), share.z);
      return normal.transformDirection(this.mesh.matrixWorld).toArray();
    }
  }

  // Draws the sphere without WebGL, more coarsely.
  class DrawnFlat {
    constructor(canvas) {
      this.canvas = canvas;
      this.table = new Float32Array(4 * NX * ROWS);
      this.size = 240;
    }

    draw(scene, lamp, gamma, view) {
      const n = this.canvas.width = this.canvas.height = this.size, context = this.canvas.getContext('2d');
      const image = context.createImageData(n, n), gain = 2 ** view.exposure, room = view.surroundings === 'room' ? roomInView(view) : null;
      for (let row = 0; row < n; ++row) {
        for (let column = 0; column < n; ++column) {
          const x = 1.06 * (2 * (column + 0.5) / n - 1), y = 1.06 * (1 - 2 * (row + 0.5) / n), r2 = x * x + y * y;
          if (r2 >= 1) continue;
          const rgb = shade(this.table, scene.solved, lamp, gamma, view.sky, [x, y, Math.sqrt(1 - r2)], room);
          const at = 4 * (row * n + column);
          for (let c = 0; c < 3; ++c) image.data[at + c] = 255 * Colour.encode(gain * rgb[c]) + 0.5;
          image.data[at + 3] = 255;
        }
      }
      context.putImageData(image, 0, 0);
    }

    normalAt(x, y) {
      const a = 1.06 * x, b = 1.06 * y, r2 = a * a + b * b;
      return r2 < 1 ? [a, b, Math.sqrt(1 - r2)] : null;
    }
  }

  // The canvas and how it is drawn on: { drawn, is3d }.
  function make(canvas, wants3d) {
    try {
      if (wants3d) return { drawn: new Drawn3d(canvas), is3d: true };
    } catch (error) {
      const fresh = canvas.cloneNode(false);  // one that gave a WebGL context gives no other
      canvas.replaceWith(fresh);
      canvas = fresh;
    }
    return { drawn: new DrawnFlat(canvas), is3d: false };
  }

  return { lampInView, bake, shade, make };
})();
