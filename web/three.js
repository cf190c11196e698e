// The parts of three.js that the page uses. The build bundles them into one small file of this name.
export {
  BufferAttribute,
  BufferGeometry,
  CircleGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  FloatType,
  Fog,
  Group,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  NeutralToneMapping,
  PMREMGenerator,
  PerspectiveCamera,
  Points,
  PointsMaterial,
  Scene,
  ShaderMaterial,
  ShadowMaterial,
  Sphere,
  SphereGeometry,
  Vector3,
  WebGLRenderTarget,
  WebGLRenderer,
} from 'three';
export {ConvexHull} from 'three/addons/math/ConvexHull.js';
export {RoomEnvironment} from 'three/addons/environments/RoomEnvironment.js';
export {OrbitControls} from 'three/addons/controls/OrbitControls.js';
