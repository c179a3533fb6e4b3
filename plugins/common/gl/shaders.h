/* The GLSL of the pictures. Directions: `key` points to the main light, `sky` up, `toward` to the eye (at infinite
 * distance), `between` halfway between the eye and the light. These and the normals are in world axes for meshes and in
 * the camera's axes for tubes, and for particles (plugins/common/sprites/splat.c). */
#ifndef HK_SHADERS_H
#define HK_SHADERS_H

static const char hk_light_glsl[] =
    "uniform vec3 key, sky, toward, between;\n"
    "uniform float plain;\n"  /* 1: no light, the plain colour */
    "uniform float solid;\n"  /* 1: no light comes through; the surface is closed */
    "uniform float shaded;\n" /* 1: there are shadows */
    "uniform sampler2DShadow heights;\n"
    "in vec3 place;\n" /* where the light comes in; on the map */
    "float tap(float x, float y) {\n"
    "  return texture(heights, place + vec3(vec2(x, y) / vec2(textureSize(heights, 0)), 0.0));\n"
    "}\n" /* Percentage-closer filtering: each tap is a bilinear mean of four comparisons */
    "float sunlight() {\n"
    "  if (shaded == 0.0) return 1.0;\n"
    "  return (tap(-1.3, -0.5) + tap(0.5, -1.3) + tap(1.3, 0.5) + tap(-0.5, 1.3)) / 4.0;\n"
    "}\n"
    "vec3 lit(vec3 base, vec3 n) {\n"
    "  float facing = dot(n, key);\n" /* some light comes through cloth from behind */
    "  float direct = clamp((facing + 0.25) / 1.25, 0.0, 1.0) + 0.34 * (1.0 - solid) * max(-facing, 0.0);\n"
    /* Along the light the map's steps are long, and there is little light to lose. */
    "  float sun = mix(1.0, sunlight(), smoothstep(0.0, 0.3, mix(abs(facing), facing, solid)));\n"
    "  direct *= sun;\n"
    "  float above = 0.5 + 0.5 * dot(n, sky);\n"
    "  vec3 fill = mix(vec3(0.43, 0.41, 0.43), vec3(0.42, 0.45, 0.50), above);\n"
    "  float shine = max(dot(n, between), 0.0);\n"
    "  float edge = 1.0 - max(dot(n, toward), 0.0);\n"
    "  shine *= shine, shine *= shine, shine *= shine, shine *= shine, shine *= shine;\n" /* to the power 32 */
    "  vec3 colour = base * (fill + 0.20 * (1.0 - edge) + direct * vec3(0.46, 0.44, 0.40)) + 0.10 * sun * shine + 0.05 "
    "* "
    "edge * edge * edge;\n"
    "  return mix(colour, base, plain);\n"
    "}\n";

/* Where points are on the map of heights (plugins/common/picture/height_map.h). A surface would shade itself by the
 * steps of the map, so points are lifted off it by as much as these come to under the taps of the filter. */
static const char hk_map_glsl[] = "uniform vec3 lean, map_corner, map_scale, sun;\n" /* lean.z: height of the floor */
                                  "uniform float texel;\n"                           /* m */
                                  "out vec3 place;\n"
                                  "vec3 on_map(vec3 p) {\n"
                                  "  p.xy -= lean.xy * (p.z - lean.z);\n"
                                  "  return (p - map_corner) * map_scale;\n"
                                  "}\n"
                                  "vec3 lifted(vec3 normal) {\n"
                                  "  vec3 n = dot(normal, normal) > 0.0 ? normalize(normal) : sun;\n"
                                  "  float c = dot(n, sun);\n"
                                  "  return (c < 0.0 ? -n : n) * texel * (0.7 + 3.0 * sqrt(max(1.0 - c * c, 0.0)));\n"
                                  "}\n";

static const char hk_mesh_vertex[] = "layout(location = 0) in vec3 position;\n"
                                     "layout(location = 1) in vec3 normal;\n"
                                     "layout(location = 2) in vec4 colour;\n"
                                     "uniform mat4 view, projection;\n"
                                     "uniform float offset;\n" /* m, along the normal */
                                     "out vec3 n, base;\n"
                                     "out float opacity;\n"
                                     "void main() {\n"
                                     "  n = normal, base = colour.rgb, opacity = colour.a;\n"
                                     "  place = on_map(position + lifted(normal));\n"
                                     "  vec3 at = dot(n, n) > 0.0 ? position + offset * normalize(n) : position;\n"
                                     "  gl_Position = projection * view * vec4(at, 1.0);\n"
                                     "}\n";

static const char hk_mesh_fragment[] = "in vec3 n, base;\n"
                                       "in float opacity;\n"
                                       "uniform float veil;\n" /* 1: what is seen through, 0: all else */
                                       "out vec4 result;\n"
                                       "void main() {\n"
                                       "  float front = gl_FrontFacing ? 1.0 : -1.0;\n"
                                       "  vec3 unit = dot(n, n) > 0.0 ? normalize(n) * front : key;\n"
                                       "  vec3 tint = gl_FrontFacing ? vec3(1.0) : vec3(0.74, 0.76, 0.84);\n"
                                       "  result = vec4(lit(base * tint, unit), mix(1.0, opacity, veil));\n"
                                       "}\n";

/* Lines as ribbons that face the eye and are lit like cylinders with round ends: `corner` is (-1 to 2 along, -1 or 1
 * across), where the ends go from -1 to 0 and from 1 to 2. They fall away from the eye, behind the next tube of a
 * chain. */
static const char hk_tube_vertex[] =
    "layout(location = 0) in vec2 corner;\n"
    "layout(location = 1) in vec3 a;\n"
    "layout(location = 2) in vec3 b;\n"
    "layout(location = 3) in vec4 colour_a;\n"
    "layout(location = 4) in vec4 colour_b;\n"
    "layout(location = 5) in float radius;\n" /* m */
    "uniform mat4 view, projection;\n"
    "uniform float least, cap;\n" /* pixels; by how much of its half width a ribbon is longer at both ends */
    "uniform vec2 pixel;\n"       /* 2 / size of the picture */
    "out vec3 side, ahead, base;\n"
    "out vec3 reach;\n" /* half widths: from the line, along it, and its length */
    "void main() {\n"
    "  vec4 ends[2];\n"
    "  ends[0] = projection * view * vec4(a, 1.0);\n"
    "  ends[1] = projection * view * vec4(b, 1.0);\n"
    "  vec2 d = (ends[1].xy / max(ends[1].w, 1e-6) - ends[0].xy / max(ends[0].w, 1e-6)) / pixel;\n"
    "  float length = sqrt(dot(d, d));\n" /* pixels */
    "  d = length > 1e-6 ? d / length : vec2(1.0, 0.0);\n"
    "  int which = corner.x < 0.5 ? 0 : 1;\n"
    "  float beyond = corner.x - float(which);\n" /* -1, 0 or 1 */
    "  vec4 p = ends[which];\n"
    "  vec3 along = mat3(view) * (b - a);\n" /* a tube that leads away from the eye is nearer to it by 1 / sine */
    "  float slope = min(abs(along.z) / max(sqrt(dot(along.xy, along.xy)), 1e-9), 6.0);\n"
    "  float raise = radius * sqrt(1.0 + slope * slope) * (1.0 - abs(beyond));\n"
    "  vec4 raised = projection * (view * vec4(which == 0 ? a : b, 1.0) + vec4(0.0, 0.0, raise, 0.0));\n"
    "  float half_width = max(radius * projection[1][1] / max(p.w, 1e-6) / pixel.y, least);\n"
    "  vec2 normal = vec2(-d.y, d.x);\n"
    "  p.xy += (normal * corner.y + d * beyond * cap) * half_width * pixel * p.w;\n"
    "  p.z = raised.z / max(raised.w, 1e-6) * p.w;\n"
    "  gl_Position = p;\n"
    "  side = vec3(normal, 0.0), ahead = vec3(d, 0.0);\n"
    "  length /= half_width;\n"
    "  reach = vec3(corner.y, float(which) * length + beyond * cap, length);\n"
    "  base = which == 0 ? colour_a.rgb : colour_b.rgb;\n"
    "  place = on_map((which == 0 ? a : b) + sun * (1.3 * radius + 1.5 * texel));\n"
    "}\n";

static const char hk_tube_fragment[] =
    "in vec3 side, ahead, base, reach;\n"
    "out vec4 result;\n"
    "void main() {\n"
    "  float s = clamp(reach.x, -1.0, 1.0), u = reach.y - clamp(reach.y, 0.0, reach.z), left = 1.0 - s * s - u * u;\n"
    "  if (left < 0.0 && plain == 0.0) discard;\n"
    "  result = vec4(lit(base, side * s + ahead * u + toward * sqrt(max(left, 0.0))), 1.0);\n"
    "}\n";

/* The whole picture from one triangle. */
static const char hk_screen_vertex[] = "out vec2 uv;\n"
                                       "void main() {\n"
                                       "  uv = vec2((gl_VertexID & 1) * 2, gl_VertexID & 2);\n"
                                       "  gl_Position = vec4(2.0 * uv - 1.0, 1.0, 1.0);\n"
                                       "}\n";

static const char hk_backdrop_fragment[] = "in vec2 uv;\n"
                                           "uniform vec3 low, high;\n"
                                           "out vec4 result;\n"
                                           "void main() {\n"
                                           "  vec2 off = (uv - vec2(0.5, 0.55)) * vec2(1.0, 0.8);\n"
                                           "  vec3 colour = mix(low, high, smoothstep(0.0, 1.0, uv.y));\n"
                                           "  result = vec4(colour * (1.03 - 0.22 * dot(off, off)), 1.0);\n"
                                           "}\n";

/* A square in a horizontal plane. */
static const char hk_floor_vertex[] = "uniform mat4 view, projection;\n"
                                      "uniform vec4 square;\n" /* centre x, y, z; half side */
                                      "out vec2 at, place;\n"  /* m; -1..1 */
                                      "void main() {\n"
                                      "  place = vec2(float(gl_VertexID & 1), float(gl_VertexID / 2)) * 2.0 - 1.0;\n"
                                      "  at = square.xy + place * square.w;\n"
                                      "  gl_Position = projection * view * vec4(at, square.z, 1.0);\n"
                                      "}\n";

static const char hk_floor_fragment[] =
    "in vec2 at, place;\n"
    "uniform vec3 grid;\n" /* spacing; where a line passes, x and y */
    "uniform vec3 colour;\n"
    "uniform float line;\n" /* how much lighter the lines are */
    "out vec4 result;\n"
    "void main() {\n"
    "  vec2 cell = (at - grid.yz) / grid.x, width = fwidth(cell);\n"
    "  vec2 near = abs(fract(cell - 0.5) - 0.5) / max(width, 1e-6);\n"
    "  vec2 on = clamp(1.1 - near, 0.0, 1.0) * clamp(0.7 - 2.0 * width, 0.0, 1.0);\n"
    "  float fade = 1.0 - smoothstep(0.25, 1.0, length(place));\n"
    "  result = vec4(colour * (1.0 + line * max(on.x, on.y)), fade);\n"
    "}\n";

static const char hk_shade_fragment[] = "in vec2 at, place;\n"
                                        "uniform sampler2D shadow;\n"
                                        "uniform vec3 colour;\n"
                                        "out vec4 result;\n"
                                        "void main() {\n"
                                        "  result = vec4(colour, 0.40 * texture(shadow, 0.5 + 0.5 * place).r);\n"
                                        "}\n";

#endif
