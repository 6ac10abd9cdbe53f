// veins_three.mjs FILE.glb MOMENT.ply ...: plays growing veins with three.js and compares what shows at each moment with
// the tubes of a PLY of that moment, which three.js reads too: as many triangles, the same box, the same area of each
// kind. Exits 1 on any fault.
import {readFileSync} from 'node:fs';
import process from 'node:process';
import * as THREE from 'three';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import {PLYLoader} from 'three/addons/loaders/PLYLoader.js';

const KINDS = ['floret', 'abaxial', 'adaxial'];  // in the order of the PLY's numbers
const TOLERANCE_MM = 1e-4;

const buffer_of = (path) => {
  const bytes = readFileSync(path);
  return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
};

/// Adds a mesh, in millimetres with +Z up: `place` takes its vertices there, `kind_of` names the kind of one of them.
function measure(geometry, place, kind_of, into) {
  const position = geometry.attributes.position;
  const corner = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
  for (let i = 0; i < (geometry.index?.count ?? 0); i += 3) {
    const vertices = [0, 1, 2].map((c) => geometry.index.getX(i + c));
    vertices.forEach((vertex, c) => {
      place(corner[c].fromBufferAttribute(position, vertex));
      into.box.expandByPoint(corner[c]);
    });
    const kind = kind_of(vertices[0]);
    into.area_mm2[kind] = (into.area_mm2[kind] ?? 0) + new THREE.Triangle(...corner).getArea();
    ++into.triangles;
  }
}
const nothing = () => ({triangles: 0, box: new THREE.Box3(), area_mm2: {}});

function of_ply(path) {
  const loader = new PLYLoader();
  loader.setCustomPropertyNameMapping({kind: ['kind']});
  const geometry = loader.parse(buffer_of(path));
  const found = nothing();
  measure(geometry, (point) => point, (vertex) => KINDS[geometry.attributes.kind.getX(vertex)], found);
  return found;
}

function of_scene(scene) {
  const found = nothing();
  scene.updateMatrixWorld(true);
  scene.traverse((node) => {
    const kind = node.isMesh ? node.material.name : '';
    if (KINDS.includes(kind) && node.matrixWorld.determinant() !== 0) {
      // Metres with +Y up to millimetres with +Z up.
      const to_mm = (point) => {
        const {x, y, z} = point.applyMatrix4(node.matrixWorld);
        return point.set(1000 * x, -1000 * z, 1000 * y);
      };
      measure(node.geometry, to_mm, () => kind, found);
    }
  });
  return found;
}

const [glb_path, ...ply_paths] = process.argv.slice(2);
if (ply_paths.length === 0) {
  console.error('usage: node veins_three.mjs FILE.glb MOMENT.ply ...');
  process.exit(2);
}
const gltf = await new GLTFLoader().parseAsync(buffer_of(glb_path), '');
const faults = [];
const triangles = [];
const clip = gltf.animations[0];
if (gltf.animations.length !== 1 || clip.name !== 'development') {
  faults.push(`must have one animation, "development", has ${gltf.animations.length}`);
} else {
  const mixer = new THREE.AnimationMixer(gltf.scene);
  mixer.clipAction(clip).play();
  ply_paths.forEach((path, moment) => {
    mixer.setTime((moment + 0.5) / ply_paths.length * clip.duration);  // each moment shows equally long
    const wanted = of_ply(path);
    const found = of_scene(gltf.scene);
    if (found.triangles !== wanted.triangles) {
      faults.push(`${path} has ${wanted.triangles} triangles, the GLB shows ${found.triangles}`);
    }
    for (const corner of wanted.triangles > 0 ? ['min', 'max'] : []) {
      const gap_mm = found.box[corner].distanceTo(wanted.box[corner]);
      if (!(gap_mm <= TOLERANCE_MM)) {
        faults.push(`${path}: a corner of the box is ${gap_mm} mm off`);
      }
    }
    for (const kind of KINDS) {
      const [a, b] = [found.area_mm2[kind] ?? 0, wanted.area_mm2[kind] ?? 0];
      if (!(Math.abs(a - b) <= 1e-4 * b)) {
        faults.push(`${path}: ${kind} strands have ${b} mm2, the GLB shows ${a}`);
      }
    }
    triangles.push(found.triangles);
  });
}
console.log(`three.js ${THREE.REVISION}: ${glb_path} shows ${triangles.join(', ')} triangles of veins, ${faults.length} faults`);
faults.forEach((fault) => console.log(`  ${fault}`));
process.exit(faults.length > 0 ? 1 : 0);
