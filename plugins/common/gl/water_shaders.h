/* The GLSL of clear liquids (plugins/common/picture/water.c). All vectors are in the camera's axes, with the eye at the
 * origin; distances are along the ray through a pixel, m. Light is reckoned in linear sRGB (IEC 61966-2-1). */
#ifndef HK_WATER_SHADERS_H
#define HK_WATER_SHADERS_H

static const char hk_water_vertex[] = "layout(location = 0) in vec3 position;\n"
                                      "layout(location = 1) in vec3 normal;\n"
                                      "uniform mat4 view, projection;\n"
                                      "out vec3 at, n;\n"
                                      "void main() {\n"
                                      "  vec4 seen = view * vec4(position, 1.0);\n"
                                      "  at = seen.xyz, n = mat3(view) * normal;\n"
                                      "  gl_Position = projection * seen;\n"
                                      "}\n";

/* What all passes share: `depths` of what is opaque, 1 where there is nothing. */
static const char hk_water_glsl[] =
    "in vec3 at, n;\n"
    "uniform mat4 projection;\n"
    "uniform vec2 range;\n" /* distances of the near and far plane, m */
    "uniform sampler2D depths;\n"
    "ivec2 here() { return ivec2(gl_FragCoord.xy); }\n"
    "float ahead(float depth) {\n" /* along the line of sight */
    "  return 2.0 * range.x * range.y / (range.x + range.y - (2.0 * depth - 1.0) * (range.y - range.x));\n"
    "}\n" /* the end of the ray through this pixel, along which `at` lies */
    "float limit() {\n"
    "  float depth = texelFetch(depths, here(), 0).r;\n"
    "  return depth < 1.0 ? length(at) * ahead(depth) / -at.z : 1e30;\n"
    "}\n";

/* The length of a ray within the liquid, up to what is opaque, is the sum of the distances where it leaves less those
 * where it enters, in any order. */
static const char hk_thickness_fragment[] = "out vec4 result;\n"
                                            "void main() {\n"
                                            "  float t = min(length(at), limit());\n"
                                            "  result = vec4(gl_FrontFacing ? -t : t, 0.0, 0.0, 0.0);\n"
                                            "}\n";

/* Depth peeling (Everitt 2001): the nearest surface behind the one of the layer before, with its normal. */
static const char hk_layer_fragment[] = "uniform sampler2D before;\n"
                                        "uniform float first;\n" /* 1: there is no layer before */
                                        "out vec4 result;\n"
                                        "void main() {\n"
                                        "  float t = length(at), nearest = texelFetch(before, here(), 0).w;\n"
                                        "  if (first == 0.0 && (nearest == 0.0 || t <= nearest)) discard;\n"
                                        "  result = vec4(normalize(n), t);\n"
                                        "}\n";

/* What a surface shows: the ray is bent where it enters and where it leaves (the way of Wyman 2005, "An approximate
 * image-space approach for interactive refraction"), and what it meets is looked up in the picture behind. */
static const char hk_surface_fragment[] =
    "uniform sampler2D behind, exits, total;\n"
    "uniform sampler2D entries;\n" /* with `exits`, where the ray meets the first surface and leaves it */
    "uniform float second, index, reach;\n"
    "uniform vec3 absorption, key, sky, ground, air;\n"
    "out vec4 result;\n"
    "vec3 to_linear(vec3 c) {\n"
    "  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));\n"
    "}\n"
    "vec3 to_srgb(vec3 c) {\n"
    "  c = clamp(c, 0.0, 1.0);\n"
    "  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));\n"
    "}\n" /* Fresnel's equations for unpolarised light; `cosine` of the angle in air (Cook and Torrance 1982, "A
              reflectance model for computer graphics", ACM Trans. Graphics 1, the Fresnel term) */
    "float fresnel(float cosine) {\n"
    "  float c = clamp(cosine, 0.0, 1.0), g = sqrt(index * index - 1.0 + c * c);\n"
    "  float across = (g - c) / max(g + c, 1e-6), along = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);\n"
    "  return 0.5 * across * across * (1.0 + along * along);\n"
    "}\n" /* what is mirrored: the floor below, the sky above, the lamp and its bright surroundings */
    "vec3 surroundings(vec3 d) {\n"
    "  float up = dot(d, sky), lamp = max(dot(d, key), 0.0);\n"
    "  vec3 colour = mix(ground, air, smoothstep(-0.1, 0.25, up)) * (1.0 + 0.8 * max(up, 0.0));\n"
    "  return colour + 40.0 * smoothstep(0.9965, 0.9985, lamp) + 1.6 * pow(lamp, 24.0);\n"
    "}\n"
    "vec2 on_picture(vec3 p) {\n"
    "  vec4 q = projection * vec4(p, 1.0);\n"
    "  return q.xy / max(q.w, 1e-6) * 0.5 + 0.5;\n"
    "}\n"
    "vec3 seen(vec3 p) {\n" /* what is before the surface is not seen through it */
    "  vec2 uv = clamp(on_picture(p), 0.0, 1.0);\n"
    "  float depth = texture(depths, uv).r;\n"
    "  vec2 own = gl_FragCoord.xy / vec2(textureSize(behind, 0));\n"
    "  return to_linear(texture(behind, depth < gl_FragCoord.z ? own : uv).rgb);\n"
    "}\n"
    "void main() {\n"
    "  float t = length(at), end = limit();\n"
    "  vec4 leave = texelFetch(exits, here(), 0);\n"
    "  float first_part = leave.w > 0.0 ? min(leave.w, end) : 0.0;\n"
    "  float inside = max(first_part - t, 0.0);\n"
    "  if (second == 1.0) {\n"
    "    if (leave.w == 0.0 || t <= leave.w || t >= end) discard;\n"
    "    float passed = first_part - min(texelFetch(entries, here(), 0).w, end);\n"
    "    inside = max(texelFetch(total, here(), 0).r - passed, 0.0);\n"
    "  }\n"
    "  vec3 way = at / t, normal = normalize(n);\n"
    "  float facing = clamp(-dot(way, normal), 0.0, 1.0), kept = 0.0;\n"
    "  vec3 bent = refract(way, normal, 1.0 / index), p = at + inside * bent, mirrored = vec3(0.0);\n"
    "  if (second == 0.0 && leave.w > 0.0 && leave.w < end) {\n"
    "    vec4 there = texture(exits, clamp(on_picture(p), 0.0, 1.0));\n"
    "    vec3 out_normal = normalize(there.w > 0.0 ? there.xyz : leave.xyz);\n"
    "    vec3 free = refract(bent, -out_normal, index);\n"
    "    kept = dot(free, free) > 0.0 ? fresnel(dot(free, out_normal)) : 1.0;\n"
    "    mirrored = surroundings(reflect(bent, -out_normal));\n"
    "    p += free * min(end - leave.w, reach);\n"
    "  }\n"
    "  vec3 light = mix(seen(p), mirrored, kept) * exp(-absorption * inside);\n" /* Beer and Lambert */
    "  light = mix(light, surroundings(reflect(way, normal)), fresnel(facing));\n"
    "  result = vec4(to_srgb(light), 1.0);\n"
    "}\n";

#endif
