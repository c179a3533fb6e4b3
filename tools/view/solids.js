// solids: what particles bounce off: spheres, boxes, cylinders, capsules, meshes, planes. Each has a geometry of its true
// size, made once, and the place of each frame: its centre and the directions of its axes. A plane is a disc with a grid,
// as large as the motion asks for; a level one at rest is the floor itself (stage.js).
"use strict";
view.solids = (() => {
  const { material, shape, object } = view.buffers;
  const ROUND = 48; // corners of a circle

  const vertex = `
    varying vec3 vNormal, vEye;
    void main() {
      vec4 p = modelViewMatrix * vec4(position, 1.0);
      vNormal = normalMatrix * normal;
      vEye = -p.xyz;
      gl_Position = projectionMatrix * p;
    }`;
  const fragment = `
    varying vec3 vNormal, vEye;
    uniform vec3 own;
    uniform float opacity;
    ${view.light.glsl}
    void main() {
      if (opacity < 1.0 && !gl_FrontFacing) discard; // one veil, not that of the far side as well
      vec3 normal = normalize(vNormal);
      gl_FragColor = vec4(lit(own, gl_FrontFacing ? normal : -normal, normalize(vEye)), opacity);
    }`;
  const shadowVertex = `
    ${view.light.cast}
    void main() { gl_Position = projectionMatrix * viewMatrix * onFloor(modelMatrix * vec4(position, 1.0)); }`;
  const shadowFragment = "uniform vec3 shade; void main() { gl_FragColor = vec4(shade, 1.0); }";

  const along = (made) => made.rotateX(Math.PI / 2); // from y, the axis of three.js, to z

  const capsule = (radius, half) => {
    const points = [], quarter = ROUND / 4;
    for (const end of [-1, 1])
      for (let k = 0; k <= quarter; k++) {
        const angle = (end < 0 ? k - quarter : k) / quarter * Math.PI / 2;
        points.push(new THREE.Vector2(Math.max(radius * Math.cos(angle), 1e-9 * radius),
          end * (half - radius) + radius * Math.sin(angle)));
      }
    return along(new (shape("Lathe"))(points, ROUND));
  };

  const mesh = ({ vertices, faces }) => {
    const made = new THREE.BufferGeometry(), corners = new Float32Array(3 * faces.length), normals = corners.slice();
    faces.forEach((v, k) => corners.set(vertices.subarray(3 * v, 3 * v + 3), 3 * k));
    new view.surface.Creases(vertices.length / 3, faces).find(vertices, normals, 0);
    made.setAttribute("position", new THREE.BufferAttribute(corners, 3));
    made.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    return made;
  };

  // a, b, c: from the centre to the surface along the axes
  const shapes = {
    sphere: (solid, [a]) => new (shape("Sphere"))(a, ROUND, ROUND / 2),
    box: (solid, [a, b, c]) => new (shape("Box"))(2 * a, 2 * b, 2 * c),
    cylinder: (solid, [a, , c]) => along(new (shape("Cylinder"))(a, a, 2 * c, ROUND)),
    capsule: (solid, [a, , c]) => capsule(a, c),
    mesh,
  };

  const axis = (places, at, k) => new THREE.Vector3(places[at + 3 + 3 * k], places[at + 4 + 3 * k], places[at + 5 + 3 * k]);

  // Where the body is whose numbers begin at `at`.
  const place = (object3d, places, at) => {
    object3d.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(...[0, 1, 2].map((k) =>
      axis(places, at, k).normalize())));
    object3d.position.set(places[at], places[at + 1], places[at + 2]);
  };

  // The motion's box with the solids at the first frame, but for those beside which the motion would be lost.
  const around = (box, source) => {
    const most = 2 * box.getSize(new THREE.Vector3()).length(), places = source.solidsAt(0), all = box.clone();
    source.solids.forEach(({ kind }, k) => {
      const centre = new THREE.Vector3(...places.subarray(12 * k, 12 * k + 3)), own = new THREE.Box3();
      if (kind === "plane" || kind === "mesh") return;
      for (let c = 0; c < 8; c++) own.expandByPoint([0, 1, 2].reduce((sum, j) =>
        sum.addScaledVector(axis(places, 12 * k, j), c >> j & 1 ? 1 : -1), centre.clone()));
      if (own.getSize(new THREE.Vector3()).length() < most) all.union(own);
    });
    return all;
  };

  const Z = new THREE.Vector3(0, 0, 1);

  class Solids {
    constructor(source, uniforms) {
      Object.assign(this, { source, uniforms, mesh: new THREE.Object3D(), shadow: new THREE.Object3D(), parts: [],
        planes: [], bodies: [] }); // no groups of three.js, which would be drawn in an order of their own
    }

    // Another run may have other ones.
    make(places) {
      this.of = this.source.solids;
      this.parts = [];
      this.planes = [];
      this.bodies = [];
      for (const group of [this.mesh, this.shadow]) group.remove(...group.children);
      this.of.forEach((solid, k) => {
        if (solid.kind === "plane") this.addPlane(12 * k);
        else this.addBody(solid, places, 12 * k);
      });
    }

    add(group, body, at) {
      body.renderOrder = group.renderOrder;
      group.add(body);
      this.parts.push({ body, at });
    }

    addBody(solid, places, at) {
      const made = shapes[solid.kind](solid, [0, 1, 2].map((k) => axis(places, at, k).length()));
      const side = solid.hollow ? THREE.BackSide : THREE.DoubleSide;
      const own = Object.assign({ own: { value: new THREE.Vector3(...view.colours.thing("body")) }, opacity: { value: 1 } }, this.uniforms);
      const body = object(THREE.Mesh, made, material(vertex, fragment, own, { side })), { position } = made.attributes;
      made.computeBoundingSphere();
      this.add(this.mesh, body, at);
      this.bodies.push({ group: solid.group, object: body, x: position.array, count: position.count, index: made.index && made.index.array,
        sphere: made.boundingSphere, rigid: solid.body, side: solid.hollow ? view.sight.BACK : view.sight.FRONT });
      if (!solid.hollow) this.add(this.shadow, object(THREE.Mesh, made, material(shadowVertex, shadowFragment, this.uniforms,
        { side: THREE.DoubleSide, ...view.light.LAID })), at);
    }

    addPlane(at) {
      const disc = new view.floor.Floor();
      this.mesh.add(disc.mesh);
      this.planes.push({ disc, at });
    }

    show(frame, on) {
      if (this.of !== this.source.solids) this.make(frame.solids);
      this.mesh.visible = this.shadow.visible = on;
      for (const { body, at } of this.parts) place(body, frame.solids, at);
      for (const { disc, at } of this.planes) this.lay(disc.mesh, frame.solids, at);
    }

    // Whether rigid bodies have the colours of their groups; those of the first, which has no name, have that of all.
    colour(byGroup) {
      for (const { group, object: { material: { uniforms } } } of this.bodies)
        uniforms.own.value.fromArray(byGroup && group > 1 ? view.colours.group(group - 1) : view.colours.thing("body"));
    }

    // While they hide more than half of a sample of the motion from the eye obstacles are transparent, and hide nothing from it.
    // points(): of the sample, for the camera; found where there are obstacles only
    fade(camera, points) {
      const obstacles = this.bodies.filter((one) => !one.rigid);
      if (!this.mesh.visible || !obstacles.length) return;
      this.mesh.updateWorldMatrix(true, true);
      view.sight.opacities(camera, points(), obstacles).forEach((opacity, k) => {
        const { material: own } = obstacles[k].object;
        own.uniforms.opacity.value = opacity;
        Object.assign(own, { transparent: opacity < 1, depthWrite: opacity === 1 });
      });
    }

    // What hides what is behind it, as sight.js has it. The particles of a rigid body are within it, and are to be taken there: it hides
    // what is behind its far side.
    blockers() {
      const seen = this.mesh.visible ? this.bodies.filter(({ object: { material: own } }) => !own.transparent) : [];
      return seen.map((one) => one.rigid ? { ...one, side: view.sight.BACK } : one);
    }

    // Of each particle of a frame whether it is within a rigid body, which is drawn.
    within({ x, n, solids: places }) {
      const inside = new Uint8Array(n), at = new THREE.Vector3();
      for (const one of this.mesh.visible ? this.bodies.filter(({ rigid }) => rigid) : []) {
        place(one.object, places, this.parts.find(({ body }) => body === one.object).at);
        const { position, quaternion } = one.object, back = quaternion.clone().conjugate();
        for (let i = 0; i < n; i++)
          if (!inside[i] && one.sphere.containsPoint(at.fromArray(x, 3 * i).sub(position).applyQuaternion(back)))
            inside[i] = view.sight.encloses(one, at) ? 1 : 0;
      }
      return inside;
    }

    // The disc lies where the motion is nearest to its plane.
    lay(disc, places, at) {
      const normal = axis(places, at, 2).normalize(), { low, high } = this.source.bounds;
      const middle = new THREE.Vector3(...low.map((v, c) => (v + high[c]) / 2));
      const off = middle.clone().sub(new THREE.Vector3(...places.subarray(at, at + 3))).dot(normal);
      disc.quaternion.setFromUnitVectors(Z, normal);
      disc.position.copy(middle.addScaledVector(normal, -off));
    }

    // The height, in the world, of the highest plane that is level; undefined: none is. That one is the floor.
    level(matrixWorld, floorless) {
      const turned = new THREE.Quaternion().setFromRotationMatrix(matrixWorld);
      let best;
      for (const { disc } of this.planes) {
        const up = Z.clone().applyQuaternion(disc.mesh.quaternion).applyQuaternion(turned);
        if (!(up.z > 1 - 1e-6)) continue;
        const height = disc.mesh.position.clone().applyMatrix4(matrixWorld).z;
        if (!best || height > best.height) best = { height, disc };
      }
      for (const { disc } of this.planes) disc.mesh.visible = !best || best.disc !== disc || Boolean(floorless);
      return best && best.height;
    }

    // radius: of the discs; theme: the page's colours
    paint(radius, theme) {
      for (const { disc } of this.planes) {
        disc.place(0, 0, radius);
        disc.paint(theme);
      }
    }
  }

  return { Solids, around };
})();
