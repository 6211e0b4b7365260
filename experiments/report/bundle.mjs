// npm run bundle: the part of three.js that space.js uses, with its licence, as one script for pages that need nothing else.
import { readFileSync } from "node:fs";
import { build } from "esbuild";

const folder = "node_modules/three";
const used = `
export {
  AmbientLight, BoxGeometry, BufferGeometry, Color, ConeGeometry, CylinderGeometry, DirectionalLight, DoubleSide, EdgesGeometry,
  Float32BufferAttribute, GridHelper, Group, Line, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshLambertMaterial,
  PerspectiveCamera, PlaneGeometry, Quaternion, Scene, SphereGeometry, Vector3, WebGLRenderer
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";`;

await build({
  stdin: { contents: used, resolveDir: "." },
  outfile: `${folder}/build/three.bundle.js`,
  bundle: true,
  minify: true,
  format: "iife",
  globalName: "THREE",
  charset: "utf8",
  legalComments: "none",
  banner: { js: `/* three.js\n${readFileSync(`${folder}/LICENSE`, "utf8").trim()}\n*/` },
});
