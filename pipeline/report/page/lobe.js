// The BRDF of one incidence as a surface over the hemisphere: the farther out, the larger.
const LobeView = (() => {
  'use strict';
  const PI = Math.PI, ZENITHS = 46, AZIMUTHS = 49;  // azimuths from 0 to 180 degrees, then mirrored

  // Zenith angles closer to each other near the mirror direction would follow a narrow lobe better;
  // an even grid of 2 degrees shows lobes of slope parameters from 0.1 on.
  const zenith = (i) => Math.min(89.5, 90 * i / (ZENITHS - 1)) * PI / 180;

  // BRDF at a wavelength over half of the hemisphere, [zenith][azimuth].
  function values(solved, thetaIn, w) {
    const muIn = Math.cos(thetaIn * PI / 180), all = new Float64Array(ZENITHS * AZIMUTHS);
    for (let i = 0; i < ZENITHS; ++i) {
      for (let a = 0; a < AZIMUTHS; ++a)
        all[i * AZIMUTHS + a] = solved.evaluateAt(w, muIn, Math.cos(zenith(i)), 180 * a / (AZIMUTHS - 1));
    }
    return all;
  }

  class View {
    constructor(canvas) {
      this.canvas = canvas;
      this.renderer = webglRenderer(canvas);
      this.camera = new THREE.OrthographicCamera(-1.15, 1.15, 1.0, -0.5, 0.1, 20);
      this.scene = new THREE.Scene();
      this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 0.75));
      this.sun = new THREE.DirectionalLight(0xffffff, 0.45);
      this.scene.add(this.sun);
      const columns = 2 * (AZIMUTHS - 1) + 1;
      this.columns = columns;
      this.geometry = new THREE.BufferGeometry();
      this.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * ZENITHS * columns), 3));
      this.geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(3 * ZENITHS * columns), 3));
      const index = [];
      for (let i = 0; i + 1 < ZENITHS; ++i) {
        for (let a = 0; a + 1 < columns; ++a) {
          const p = i * columns + a;
          index.push(p, p + columns, p + 1, p + 1, p + columns, p + columns + 1);
        }
      }
      this.geometry.setIndex(index);
      this.scene.add(new THREE.Mesh(this.geometry,
        new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide })));
      this.addGround();
    }

    addGround() {
      this.ground = new THREE.Group();
      const line = (points, colour) => {
        const shape = new THREE.BufferGeometry().setFromPoints(points.map((p) => new THREE.Vector3(...p)));
        const object = new THREE.Line(shape, new THREE.LineBasicMaterial({ color: colour }));
        this.ground.add(object);
        return object;
      };
      for (const radius of [0.5, 1]) {
        const circle = [];
        for (let i = 0; i <= 96; ++i) circle.push([radius * Math.cos(PI * i / 48), 0, radius * Math.sin(PI * i / 48)]);
        line(circle, 0x8a929c);
      }
      line([[-1, 0, 0], [1, 0, 0]], 0x8a929c);
      line([[0, 0, -1], [0, 0, 1]], 0x8a929c);
      this.ray = line([[0, 0, 0], [0, 1, 0]], 0xd55e00);
      this.mark = line([[0, 0, 0], [0, 1, 0]], 0x0072b2);
      this.scene.add(this.ground);
    }

    // @param amount  [zenith][azimuth] in [0, 1]: radius and colour
    // @param marked  { thetaOut, azimuth } in degrees
    draw(amount, thetaIn, marked, view) {
      const position = this.geometry.attributes.position, colour = this.geometry.attributes.color;
      for (let i = 0; i < ZENITHS; ++i) {
        for (let a = 0; a < this.columns; ++a) {
          const k = a < AZIMUTHS ? a : 2 * (AZIMUTHS - 1) - a, r = amount[i * AZIMUTHS + k];
          const theta = zenith(i), phi = PI * a / (AZIMUTHS - 1), p = i * this.columns + a;
          position.setXYZ(p, r * Math.sin(theta) * Math.cos(phi), r * Math.cos(theta), r * Math.sin(theta) * Math.sin(phi));
          colour.setXYZ(p, ...Colour.scale(r));
        }
      }
      position.needsUpdate = colour.needsUpdate = true;
      this.geometry.computeVertexNormals();
      const t = thetaIn * PI / 180, o = marked.thetaOut * PI / 180, f = marked.azimuth * PI / 180;
      const far = 1.08;
      this.setEnd(this.ray, -far * Math.sin(t), far * Math.cos(t), 0);
      this.setEnd(this.mark, far * Math.sin(o) * Math.cos(f), far * Math.cos(o), far * Math.sin(o) * Math.sin(f));
      const yaw = view.lobeYaw * PI / 180, pitch = view.lobePitch * PI / 180;
      this.camera.position.set(5 * Math.sin(yaw) * Math.cos(pitch), 5 * Math.sin(pitch), 5 * Math.cos(yaw) * Math.cos(pitch));
      this.camera.lookAt(0, 0, 0);
      this.sun.position.copy(this.camera.position).add(new THREE.Vector3(0, 3, 0));
      const width = this.canvas.clientWidth || 400;
      this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
      this.renderer.setSize(width, Math.round(width * 1.5 / 2.3), false);
      this.renderer.render(this.scene, this.camera);
    }

    setEnd(line, x, y, z) {
      const points = line.geometry.attributes.position;
      points.setXYZ(1, x, y, z);
      points.needsUpdate = true;
    }
  }

  return { View, values };
})();
