import * as THREE from 'three';
import { colourRow, type ColourMapName } from './colour-map';

/**
 * The look of tissue: a three.js material with a few lines of its own. Skin is mottled and finely bumpy, where the noise is
 * fixed to the rest shape and so moves with the tissue; faces that a cut laid open are paler and rawer; seared ones are dark
 * and dull, with an ochre edge. While values are shown, their colours take the place of all that, and shine less.
 *
 * Attributes of the geometry: `rest` (rest position, m), `value` (0 to 1, the place in the colour map), `mark` (seared 0 to 1,
 * inner 0 or 1).
 */
export interface TissueLook {
  readonly material: THREE.MeshStandardMaterial;
  /** Shows `value` in colours of this map, or the tissue itself. */
  showValues(map: ColourMapName | null): void;
}

const RAMP_TEXELS = 128;

const VERTEX_HEAD = /* glsl */ `
attribute vec3 rest;
attribute float value;
attribute vec2 mark;
varying vec3 vRest;
varying float vValue;
varying vec2 vMark;
`;

const VERTEX_BODY = /* glsl */ `
vRest = rest;
vValue = value;
vMark = mark;
`;

const FRAGMENT_HEAD = /* glsl */ `
varying vec3 vRest;
varying float vValue;
varying vec2 vMark;
uniform sampler2D ramp;
uniform float valuesShown;
uniform float grain;
uniform vec3 skinColour;

float tissueHash(vec3 cell) {
  cell = fract(cell * vec3(0.1031, 0.1130, 0.0973));
  cell += dot(cell, cell.yxz + 33.33);
  return fract((cell.x + cell.y) * cell.z);
}

// Value noise and its gradient in one go: (value, ∂x, ∂y, ∂z).
vec4 tissueNoise(vec3 place) {
  vec3 cell = floor(place);
  vec3 w = fract(place);
  vec3 u = w * w * w * (w * (w * 6.0 - 15.0) + 10.0);
  vec3 du = 30.0 * w * w * (w * (w - 2.0) + 1.0);
  float a = tissueHash(cell);
  float b = tissueHash(cell + vec3(1, 0, 0));
  float c = tissueHash(cell + vec3(0, 1, 0));
  float d = tissueHash(cell + vec3(1, 1, 0));
  float e = tissueHash(cell + vec3(0, 0, 1));
  float f = tissueHash(cell + vec3(1, 0, 1));
  float g = tissueHash(cell + vec3(0, 1, 1));
  float h = tissueHash(cell + vec3(1, 1, 1));
  float k1 = b - a, k2 = c - a, k3 = e - a;
  float k4 = a - b - c + d, k5 = a - c - e + g, k6 = a - b - e + f;
  float k7 = -a + b + c - d + e - f - g + h;
  float v = a + k1 * u.x + k2 * u.y + k3 * u.z + k4 * u.x * u.y + k5 * u.y * u.z + k6 * u.z * u.x + k7 * u.x * u.y * u.z;
  return vec4(v, du * vec3(
    k1 + k4 * u.y + k6 * u.z + k7 * u.y * u.z,
    k2 + k5 * u.z + k4 * u.x + k7 * u.z * u.x,
    k3 + k6 * u.x + k5 * u.y + k7 * u.x * u.y));
}
`;

const FRAGMENT_COLOUR = /* glsl */ `
float seared = smoothstep(0.25, 0.9, vMark.x);
float scorched = smoothstep(0.02, 0.35, vMark.x) * (1.0 - seared);
float inner = smoothstep(0.3, 0.7, vMark.y);
#ifdef TISSUE_GRAIN
  vec4 coarse = tissueNoise(vRest * grain);
  vec4 fine = tissueNoise(vRest * grain * 5.3 + 7.0);
#else
  vec4 coarse = vec4(0.5, 0.0, 0.0, 0.0);
  vec4 fine = coarse;
#endif
vec3 skin = skinColour * (0.82 + 0.30 * coarse.x + 0.12 * fine.x);
skin = mix(skin, skin * vec3(0.78, 0.60, 0.72), smoothstep(0.55, 0.9, coarse.x) * 0.6);
vec3 raw = mix(vec3(0.4, 0.07, 0.055), vec3(0.52, 0.14, 0.1), fine.x);
vec3 flesh = mix(skin, raw, inner);
flesh = mix(flesh, vec3(0.34, 0.15, 0.055), 0.85 * scorched);
flesh = mix(flesh, vec3(0.022, 0.014, 0.011) + 0.035 * fine.x, seared);
vec3 shown = texture2D(ramp, vec2(vValue, 0.5)).rgb;
diffuseColor.rgb = mix(flesh, mix(shown, shown * 0.35, seared), valuesShown);
float dull = max(seared, 0.7 * valuesShown);
`;

const FRAGMENT_ROUGHNESS = /* glsl */ `
roughnessFactor = mix(roughnessFactor + 0.14 * (fine.x - 0.5), 0.85, dull);
`;

// The bumps lean the normal against the gradient of the noise, taken as if the tissue had not turned: it is noise all the same.
const FRAGMENT_NORMAL = /* glsl */ `
#ifdef TISSUE_GRAIN
  vec3 slope = (0.055 * coarse.yzw + 0.05 * fine.yzw) * (1.0 - 0.9 * valuesShown) + 0.12 * seared * fine.yzw;
  slope = (viewMatrix * vec4(slope, 0.0)).xyz;
  normal = normalize(normal - (slope - dot(slope, normal) * normal));
#endif
`;

const FRAGMENT_COAT = /* glsl */ `
#ifdef USE_CLEARCOAT
  material.clearcoat *= 1.0 - dull;
#endif
`;

// Values have to be readable on the dark side as well: a part of their colour shines by itself.
const FRAGMENT_EMISSION = /* glsl */ `
totalEmissiveRadiance += 0.4 * valuesShown * diffuseColor.rgb;
diffuseColor.rgb *= 1.0 - 0.35 * valuesShown;
`;

export const LIVER_SKIN = new THREE.Color(0.2, 0.034, 0.029);

/** `size`: largest extent of the body [m], which sets how fine its grain is. */
export function tissueLook(size: number, coat: boolean, skin: THREE.Color = LIVER_SKIN): TissueLook {
  const ramp = new THREE.DataTexture(colourRow('sequential', RAMP_TEXELS), RAMP_TEXELS, 1);
  ramp.colorSpace = THREE.SRGBColorSpace;
  ramp.minFilter = THREE.LinearFilter;
  ramp.magFilter = THREE.LinearFilter;
  ramp.needsUpdate = true;
  const uniforms = {
    ramp: { value: ramp },
    valuesShown: { value: 0 },
    grain: { value: size > 0 ? 26 / size : 1 },
    skinColour: { value: skin },
  };
  const material = coat
    ? new THREE.MeshPhysicalMaterial({ roughness: 0.46, clearcoat: 0.75, clearcoatRoughness: 0.16, ior: 1.4 })
    : new THREE.MeshStandardMaterial({ roughness: 0.38 });
  // A cut may leave the surface open to its inside for a step; without the back faces one would see through.
  material.side = THREE.DoubleSide;
  material.shadowSide = THREE.FrontSide;
  if (coat) material.defines = { ...material.defines, TISSUE_GRAIN: '' };
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader =
      VERTEX_HEAD +
      shader.vertexShader.replace('#include <begin_vertex>', `#include <begin_vertex>${VERTEX_BODY}`);
    shader.fragmentShader =
      FRAGMENT_HEAD +
      shader.fragmentShader
        .replace('#include <color_fragment>', `#include <color_fragment>${FRAGMENT_COLOUR}`)
        .replace('#include <roughnessmap_fragment>', `#include <roughnessmap_fragment>${FRAGMENT_ROUGHNESS}`)
        .replace('#include <normal_fragment_maps>', `#include <normal_fragment_maps>${FRAGMENT_NORMAL}`)
        .replace('#include <emissivemap_fragment>', `#include <emissivemap_fragment>${FRAGMENT_EMISSION}`)
        .replace(
          '#include <lights_physical_fragment>',
          `#include <lights_physical_fragment>${FRAGMENT_COAT}`,
        );
  };
  material.addEventListener('dispose', () => ramp.dispose());
  return {
    material,
    showValues(map) {
      uniforms.valuesShown.value = map ? 1 : 0;
      if (!map) return;
      ramp.image.data?.set(colourRow(map, RAMP_TEXELS));
      ramp.minFilter = ramp.magFilter = map === 'binary' ? THREE.NearestFilter : THREE.LinearFilter;
      ramp.needsUpdate = true;
    },
  };
}
