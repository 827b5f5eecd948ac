// Loads the GLBs named on the command line with three.js, as a page does but without a screen.
// One JSON line each: {file, triangles, box, error}; the box is that of all scenes, its lowest corner and its highest. Images are not decoded here (Node has no decoder), but
// their bytes must be there and begin as their media type says.
import { readFileSync } from "node:fs";
import { Box3, Texture } from "three";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

globalThis.self = globalThis;
globalThis.ProgressEvent ??= class ProgressEvent extends Event {};

const SIGNATURES = { "image/png": [0x89, 0x50, 0x4e, 0x47], "image/jpeg": [0xff, 0xd8, 0xff], "image/webp": [0x52, 0x49, 0x46, 0x46] };

// Stands in for the decoder: checks the bytes of a texture's image.
const imageCheck = (parser) => ({
  name: "image_check",
  async loadTexture(index) {
    const image = parser.json.images[parser.json.textures[index].source];
    const bytes = new Uint8Array(
      image.bufferView === undefined ? await (await fetch(image.uri)).arrayBuffer() : await parser.getDependency("bufferView", image.bufferView),
    );
    const type = image.mimeType ?? image.uri.slice("data:".length, image.uri.indexOf(";"));
    const signature = SIGNATURES[type];
    if (!signature) throw new Error(`texture ${index}: media type '${type}' is none that a page decodes`);
    if (signature.some((byte, i) => bytes[i] !== byte)) throw new Error(`texture ${index}: the bytes are not ${type}`);
    return new Texture();
  },
});

const trianglesOf = (object) => {
  const { geometry } = object;
  const positions = geometry.attributes.position;
  for (let i = 0; i < positions.count; i++) {
    const vertex = [positions.getX(i), positions.getY(i), positions.getZ(i)];
    if (!vertex.every(Number.isFinite)) throw new Error(`${object.name}: vertex ${i} is ${vertex}`);
  }
  const corners = geometry.index ? geometry.index.count : positions.count;
  for (let i = 0; geometry.index && i < corners; i++) {
    if (geometry.index.getX(i) >= positions.count) throw new Error(`${object.name}: index ${i} is outside the vertices`);
  }
  return corners / 3;
};

async function load(file) {
  const bytes = readFileSync(file);
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).register(imageCheck);
  const gltf = await loader.parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), "");
  let triangles = 0;
  const box = new Box3();
  for (const scene of gltf.scenes) {
    scene.updateMatrixWorld(true);
    box.expandByObject(scene);
    scene.traverse((object) => {
      if (object.isMesh) triangles += trianglesOf(object);
    });
  }
  return { triangles, box: box.isEmpty() ? undefined : [box.min.toArray(), box.max.toArray()] };
}

// three.js warns of what it cannot show; the table is about what it cannot load.
console.warn = () => {};
for (const file of process.argv.slice(2)) {
  try {
    console.log(JSON.stringify({ file, ...(await load(file)) }));
  } catch (error) {
    console.log(JSON.stringify({ file, error: String(error) }));
  }
}
