// light: the shading that surfaces, particles and lines share: one sun, a sky that is brighter above, and a little
// shine, in the camera's space; and the shadow that the sun casts on the floor, in the world's.
"use strict";
view.light = (() => {
  const SUN = new THREE.Vector3(-0.45, -0.55, 0.85).normalize();

  const uniforms = () => ({ up: { value: new THREE.Vector3() }, sun: { value: new THREE.Vector3() }, sunOfWorld: { value: SUN },
    floor: { value: 0 }, shade: { value: new THREE.Vector3() }, scale: { value: 1 } });

  const glsl = `
    uniform vec3 up, sun;
    vec3 lit(vec3 colour, vec3 normal, vec3 eye) {
      float sky = 0.5 + 0.5 * dot(normal, up);
      float direct = max(dot(normal, sun), 0.0);
      float shine = pow(max(dot(normal, normalize(sun + eye)), 0.0), 32.0);
      vec3 c = colour * colour; // about linear
      vec3 light = c * (0.26 + 0.36 * sky + 0.56 * direct) + 0.05 * shine;
      return sqrt(light);
    }`;

  // Where the sun casts a point of the world's space on the floor.
  const cast = `
    uniform float floor;
    uniform vec3 sunOfWorld;
    vec4 onFloor(vec4 p) { return vec4(p.xy - sunOfWorld.xy * (p.z - floor) / sunOfWorld.z, floor, 1.0); }`;

  // A shadow is drawn after the floor, which is transparent at its rim, and hides nothing that is above.
  const LAID = { transparent: true, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 };

  return { uniforms, glsl, cast, LAID, SUN };
})();
