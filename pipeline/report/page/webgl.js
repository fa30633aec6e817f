// A renderer of three.js on a canvas, with a clear background; throws where there is no WebGL 2.
const webglRenderer = (canvas) => {
  const context = canvas.getContext('webgl2', { antialias: true, alpha: true, preserveDrawingBuffer: true });
  if (!context || typeof THREE === 'undefined') throw new Error('no WebGL 2');
  const renderer = new THREE.WebGLRenderer({ canvas, context });
  renderer.setClearColor(0, 0);
  return renderer;
};
