// Runs in the browser: loads a GLB with three.js, and tells where its vertices are and what a picture of it shows.
import * as THREE from 'three';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';

// The mesh of an organ, or those of its parts; vertices count over them in order.
function meshes_of(node) {
  return node.isMesh ? [node] : node.children.filter((child) => child.isMesh)
    .sort((a, b) => a.userData.part - b.userData.part);
}

function vertex_at(node, index) {
  for (const mesh of meshes_of(node)) {
    const count = mesh.geometry.attributes.position.count;
    if (index < count) {
      return mesh.getVertexPosition(index, new THREE.Vector3()).applyMatrix4(mesh.matrixWorld).toArray();
    }
    index -= count;
  }
  return null;
}

function lit_pixels(renderer, scene, size) {
  const box = new THREE.Box3().setFromObject(scene, true);
  const centre = box.getCenter(new THREE.Vector3());
  const radius = box.getSize(new THREE.Vector3()).length() / 2;
  const camera = new THREE.PerspectiveCamera(30, 1, radius / 100, radius * 100);
  camera.position.copy(centre).add(new THREE.Vector3(0, 1, 0.6).normalize().multiplyScalar(4.2 * radius));
  camera.lookAt(centre);
  renderer.render(scene, camera);
  const pixels = new Uint8Array(4 * size * size);
  const gl = renderer.getContext();
  gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let lit = 0;
  const colours = new Set();
  for (let i = 0; i < pixels.length; i += 4) {
    if (pixels[i] + pixels[i + 1] + pixels[i + 2] > 24) {
      ++lit;
      colours.add((pixels[i] >> 4) * 256 + (pixels[i + 1] >> 4) * 16 + (pixels[i + 2] >> 4));
    }
  }
  return {lit, colours: colours.size};
}

// `wanted` is the text of what expected_positions_json wrote; `file` the GLB as base64.
window.judge = async (file, wanted) => {
  const expected = JSON.parse(wanted);
  const bytes = Uint8Array.from(atob(file), (c) => c.charCodeAt(0));
  const gltf = await new GLTFLoader().parseAsync(bytes.buffer, '');
  const size = 512;
  const renderer = new THREE.WebGLRenderer({preserveDrawingBuffer: true, antialias: false});
  renderer.setSize(size, size);
  const scene = new THREE.Scene();
  scene.add(gltf.scene, new THREE.HemisphereLight(0xffffff, 0x888888, 3));

  const organs = new Map();
  const named = new Map();
  gltf.scene.traverse((node) => {
    if (node.userData.organ !== undefined) {
      organs.set(node.userData.organ, node);
    } else if (node.userData.part === undefined && (node.userData.name !== undefined || node.name)) {
      named.set(node.userData.name ?? node.name, node);
    }
  });
  const mixer = new THREE.AnimationMixer(gltf.scene);
  for (const clip of gltf.animations) {
    const action = mixer.clipAction(clip);
    action.setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
    action.play();
  }

  const pictures = [];
  const positions = new Map();  // node -> one list of places for each time
  for (const time of expected.times_s) {
    mixer.setTime(time);
    scene.updateMatrixWorld(true);
    for (const item of [...expected.organs, ...expected.bodies]) {
      const node = item.organ === undefined ? named.get(item.name) : organs.get(item.organ);
      if (node) {
        const list = positions.get(item.name) ?? [];
        list.push(item.vertices.map((vertex) => vertex_at(node, vertex)));
        positions.set(item.name, list);
      }
    }
    pictures.push(lit_pixels(renderer, scene, size));
  }
  return {
    organ_count: organs.size,
    duration_s: gltf.animations.length > 0 ? gltf.animations[0].duration : 0,
    positions: Object.fromEntries(positions),
    pictures,
    image: renderer.domElement.toDataURL('image/png'),
  };
};
