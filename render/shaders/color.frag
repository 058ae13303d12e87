#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "material.glsl"

layout(set = 0, binding = 3) uniform sampler2DShadow shadow_map;

layout(location = 0) in vec3 in_world;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_tangent;
layout(location = 3) in vec4 in_color;
layout(location = 4) in vec4 in_uv01;
layout(location = 5) in vec4 in_uv23;
layout(location = 6) in vec2 in_uv4;
layout(location = 7) in vec3 in_to_eye;
layout(location = 8) flat in vec4 in_factors;   // metallic, roughness, strength of the normal and occlusion maps
layout(location = 9) flat in vec4 in_emissive;  // w: alpha cutoff
layout(location = 10) flat in uint in_flags;

layout(location = 0) out vec4 out_color;

layout(constant_id = 3) const bool kShadows = true;

const float kPi = 3.14159265358979;

// Irradiance over pi of a surface that looks up and of one that looks down.
const vec3 kLightAbove = kSkyShare * mix(kSkyHorizon, kSkyZenith, 0.4);
const vec3 kLightBelow = kSkyShare * kGround;

struct Surface {
  vec3 normal;
  vec3 flat_normal;
  vec3 diffuse;
  vec3 f0;
  float roughness;
  float occlusion;
};

// Normal from the map; without tangents in the file, from derivatives (Schüler 2013, "Followup: Normal mapping
// without precomputed tangents").
vec3 mapped_normal(vec3 n) {
  vec2 uv = in_uv23.xy;
  vec3 texel = texture(textures[kTextureNormal], uv).xyz * 2.0 - 1.0;
  texel.xy *= in_factors.z;
  if ((kTextureMask & kTangents) != 0) {
    vec3 t = normalize(in_tangent.xyz - n * dot(in_tangent.xyz, n));
    vec3 b = cross(n, t) * in_tangent.w;
    return dot(in_tangent.xyz, in_tangent.xyz) > 0.0 ? normalize(mat3(t, b, n) * texel) : n;
  }
  vec3 dpx = dFdx(in_world);
  vec3 dpy = dFdy(in_world);
  vec2 dux = dFdx(uv);
  vec2 duy = dFdy(uv);
  // Screen coordinates run down, and the surface may be seen from behind: either turns the frame over.
  float turned = dot(cross(dpx, dpy), n) < 0.0 ? -1.0 : 1.0;
  vec3 px = cross(dpy, n) * turned;
  vec3 py = cross(n, dpx) * turned;
  vec3 t = px * dux.x + py * duy.x;
  // glTF: +v runs down the picture and the green channel up it, so the bitangent is against v.
  vec3 b = -(px * dux.y + py * duy.y);
  float largest = max(dot(t, t), dot(b, b));
  return largest > 0.0 ? normalize(mat3(t * inversesqrt(largest), b * inversesqrt(largest), n) * texel) : n;
}

// Share of the sun that arrives: four bilinear comparisons, a texel and a half apart.
float sunlight(vec3 normal) {
  if (!kShadows) return 1.0;
  // Away from the surface by about a texel, more at grazing light: no surface shadows itself.
  float slope = 1.0 - clamp(dot(normal, kToSun), 0.0, 1.0);
  vec3 p = in_world + normal * (camera.shadow_texel.x * (1.2 + 2.0 * slope));
  vec4 q = camera.shadow_from_world * vec4(p, 1.0);
  vec2 uv = q.xy * 0.5 + 0.5;
  if (any(lessThan(uv, vec2(0.0))) || any(greaterThan(uv, vec2(1.0)))) return 1.0;
  float texel = camera.shadow_texel.y;
  float sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec2 offset = vec2((i & 1) != 0 ? 0.75 : -0.75, (i & 2) != 0 ? 0.75 : -0.75);
    // No implicit derivatives: control flow is not uniform here.
    sum += textureLod(shadow_map, vec3(uv + offset * texel, q.z), 0.0);
  }
  return sum / 4.0;
}

// glTF 2.0 appendix B: Lambert and GGX with Smith's correlated visibility and Schlick's Fresnel.
void sun_light(Surface s, vec3 view, out vec3 diffuse, out vec3 specular) {
  float nl = dot(s.normal, kToSun);
  diffuse = specular = vec3(0.0);
  if (nl <= 0.0 || dot(s.flat_normal, kToSun) <= 0.0) return;
  // Of the half vector (kToSun + view) / |kToSun + view| only two cosines are needed.
  float lv = dot(kToSun, view);
  float n_view = dot(s.normal, view);
  float per_half = inversesqrt(max(2.0 + 2.0 * lv, 1e-6));
  float nh = clamp((nl + n_view) * per_half, 0.0, 1.0);
  float vh = min((1.0 + lv) * per_half, 1.0);
  float nv = max(n_view, 1e-4);
  float a = s.roughness * s.roughness;
  float a2 = a * a;
  float k = nh * nh * (a2 - 1.0) + 1.0;
  float smith = nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2);
  float away = 1.0 - vh;
  float away2 = away * away;
  vec3 fresnel = s.f0 + (1.0 - s.f0) * (away2 * away2 * away);
  vec3 light = kSunRadiance * nl * sunlight(s.flat_normal);
  diffuse = (1.0 - fresnel) * s.diffuse / kPi * light;
  specular = fresnel * (0.5 * a2 / (kPi * k * k * smith)) * light;
}

// Sky and ground as a hemisphere light; its mirror image with the split sum's fit of Karis 2014, "Physically
// based shading on mobile".
void sky_light(Surface s, vec3 view, out vec3 diffuse, out vec3 specular) {
  vec3 irradiance = mix(kLightBelow, kLightAbove, 0.5 + 0.5 * s.normal.y);
  float nv = clamp(dot(s.normal, view), 0.0, 1.0);
  vec4 r = s.roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
  vec2 ab = vec2(-1.04, 1.04) * a + r.zw;
  vec3 mirrored = reflect(-view, s.normal);
  vec3 seen = mix(sky_radiance(mirrored), irradiance, s.roughness * s.roughness);
  diffuse = s.diffuse * irradiance * s.occlusion;
  specular = seen * (s.f0 * ab.x + ab.y) * s.occlusion;
}

void main() {
  vec4 base = in_color;
  if (has_texture(kTextureBaseColor)) base *= texture(textures[kTextureBaseColor], in_uv01.xy);
  vec3 emissive = in_emissive.rgb;
  float metallic = in_factors.x;
  float roughness = in_factors.y;
  float occlusion = 1.0;
  vec3 flat_normal = normalize(gl_FrontFacing ? in_normal : -in_normal);
  vec3 normal = flat_normal;
  // The branches are on constants, so all derivatives are in uniform control flow, before any discard.
  if (has_texture(kTextureMetallicRoughness)) {
    vec4 mr = texture(textures[kTextureMetallicRoughness], in_uv01.zw);
    metallic *= mr.b;
    roughness *= mr.g;
  }
  if (has_texture(kTextureNormal)) normal = mapped_normal(flat_normal);
  if (has_texture(kTextureOcclusion)) {
    float ao = texture(textures[kTextureOcclusion], in_uv23.zw).r;
    occlusion = 1.0 + in_factors.w * (ao - 1.0);
  }
  if (has_texture(kTextureEmissive))
    emissive *= texture(textures[kTextureEmissive], in_uv4).rgb;
  if (kAlphaMode == 1 && base.a < in_emissive.w) discard;
  float alpha = kAlphaMode == 2 ? base.a : 1.0;

  if ((in_flags & kMaterialUnlit) != 0 || dot(in_normal, in_normal) == 0.0) {
    out_color = vec4(base.rgb * alpha, alpha);  // a colour for the screen: neither exposed nor tone-mapped
    return;
  }
  vec3 view = normalize(in_to_eye);
  Surface s;
  s.normal = normal;
  s.flat_normal = flat_normal;
  s.diffuse = base.rgb * (1.0 - metallic);
  s.f0 = mix(vec3(0.04), base.rgb, metallic);
  s.roughness = clamp(roughness, 0.045, 1.0);
  s.occlusion = occlusion;
  vec3 sun_diffuse, sun_specular, sky_diffuse, sky_specular;
  sun_light(s, view, sun_diffuse, sun_specular);
  sky_light(s, view, sky_diffuse, sky_specular);
  // A blended surface keeps its reflections (premultiplied alpha): glass shows the sky.
  vec3 color = (sun_diffuse + sky_diffuse + emissive) * alpha + sun_specular + sky_specular;
  if (kAlphaMode == 2) {
    vec3 reflection = sky_specular + sun_specular;
    alpha = clamp(alpha + 0.5 * max(reflection.r, max(reflection.g, reflection.b)) * (1.0 - alpha), 0.0, 1.0);
  }
  out_color = vec4(tone_map(color * kExposure), alpha);
}
