// buffers: arrays of a geometry that grow when more particles come, and are filled anew every frame.
"use strict";
view.buffers = (() => {
  // The array of the attribute, with room for `count` items.
  const array = (geometry, name, size, count, each) => {
    let attribute = geometry.attributes[name];
    if (!attribute || attribute.count < count) {
      const room = new Float32Array(Math.ceil(Math.max(count, 1) * 1.2) * size);
      attribute = each ? new THREE.InstancedBufferAttribute(room, size) : new THREE.BufferAttribute(room, size);
      attribute.setUsage(THREE.DynamicDrawUsage);
      geometry.setAttribute(name, attribute);
    }
    attribute.needsUpdate = true;
    return attribute.array;
  };

  const material = (vertex, fragment, uniforms, more) => new THREE.ShaderMaterial(
    Object.assign({ vertexShader: vertex, fragmentShader: fragment, uniforms }, more));

  // An object that is always drawn: its bounds change every frame.
  const object = (Kind, geometry, with_) => {
    const made = new Kind(geometry, with_);
    made.frustumCulled = false;
    return made;
  };

  // Of a simple shape, by the name that older and newer versions of three.js have for it.
  const shape = (name) => THREE[`${name}BufferGeometry`] || THREE[`${name}Geometry`];

  return { array, material, object, shape };
})();
