/* The passes of a picture: backdrop, floor with the shadow, cloth, springs; over what is read of it, particles. */
#include "plugins/common/picture/geometry.h"
#include "plugins/common/gl/gl.h"
#include "plugins/common/picture/painted.h"
#include "plugins/common/picture/shadow.h"
#include "plugins/common/volume/volume_pass.h"

#include <string.h>

typedef struct scene {
  const hk_view_setup *setup;
  hk_lens lens;
  double key[3];            /* towards the light, world axes */
  const hk_height_map *map; /* NULL: no shadows */
  float light[2][4][3];     /* key, sky, toward, between; in world axes and in the camera's */
} scene;

static int uniform(const hk_painter *p, int program, const char *name) {
  return glGetUniformLocation(p->program[program], name);
}

static void set_matrices(const hk_painter *p, int program, const float view[16], const float projection[16]) {
  glUseProgram(p->program[program]);
  glUniformMatrix4fv(uniform(p, program, "view"), 1, GL_FALSE, view);
  glUniformMatrix4fv(uniform(p, program, "projection"), 1, GL_FALSE, projection);
}

static void set_light(const hk_painter *p, int program, const float light[4][3], float plain) {
  static const char *const name[] = {"key", "sky", "toward", "between"};
  for (int k = 0; k < 4; k++) glUniform3fv(uniform(p, program, name[k]), 1, light[k]);
  glUniform1f(uniform(p, program, "plain"), plain);
}

/* Where a point is on the map: its height is the third coordinate, 0 to 1. */
static void set_shadows(const hk_painter *p, int program, const scene *s) {
  const hk_height_map *m = s->map;
  glUniform1f(uniform(p, program, "shaded"), m ? 1 : 0);
  if (!m) return;
  float lean[3] = {m->lean[0], m->lean[1], m->floor}, size = 1 / m->side, span = 1 / (m->high - m->low);
  glUniform3fv(uniform(p, program, "lean"), 1, lean);
  glUniform3f(uniform(p, program, "map_corner"), m->corner[0], m->corner[1], m->low);
  glUniform3f(uniform(p, program, "map_scale"), size, size, span);
  glUniform1f(uniform(p, program, "texel"), m->side / HK_HEIGHT_MAP_SIZE);
  glUniform3f(uniform(p, program, "sun"), (float)s->key[0], (float)s->key[1], (float)s->key[2]);
  glBindTexture(GL_TEXTURE_2D, p->heights);
}

static void normalize(double v[3]) {
  double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int c = 0; c < 3; c++) v[c] /= length;
}

/* Places the light above, to the left of and behind the eye. */
static void place_light(scene *s) {
  double axis[3][3], direction[4][3] = {{0}, {0, 0, 1}};
  hk_camera_axes(&s->setup->camera, axis[0], axis[1], axis[2]);
  for (int c = 0; c < 3; c++) s->key[c] = -0.42 * axis[0][c] + (c < 2 ? 0.3 * axis[2][c] : 1);
  s->key[2] = fmax(s->key[2], 0.5);
  normalize(s->key);
  for (int c = 0; c < 3; c++) {
    direction[0][c] = s->key[c], direction[2][c] = axis[2][c];
    direction[3][c] = s->key[c] + axis[2][c];
  }
  normalize(direction[3]);
  for (int k = 0; k < 4; k++)
    for (int c = 0; c < 3; c++) {
      const double *d = direction[k], *a = axis[c];
      s->light[0][k][c] = (float)d[c];
      s->light[1][k][c] = (float)(a[0] * d[0] + a[1] * d[1] + a[2] * d[2]);
    }
}

static scene make_scene(const hk_view_setup *setup) {
  scene s = {.setup = setup};
  hk_camera_lens(&setup->camera, &s.lens);
  place_light(&s);
  return s;
}

static void upload(const hk_painter *p) {
  glBindVertexArray(p->mesh_array); /* the element buffer is part of it */
  glBindBuffer(GL_ARRAY_BUFFER, p->mesh_buffer);
  if (p->triangles) {
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(p->vertices * sizeof *p->vertex), p->vertex, GL_STREAM_DRAW);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(p->triangles * sizeof *p->triangle), p->triangle,
                 GL_STREAM_DRAW);
  }
  glBindBuffer(GL_ARRAY_BUFFER, p->tube_buffer);
  glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(p->tubes * sizeof *p->tube), p->tube, GL_STREAM_DRAW);
}

enum { BOTH_SIDES = 0 };

/* Draws triangles from `begin` to end - 1 without those that show the side `hidden`, moved along their normals. */
static void draw_triangles(const hk_painter *p, size_t begin, size_t end, GLenum hidden, double offset) {
  if (begin == end) return;
  if (hidden != BOTH_SIDES) {
    glEnable(GL_CULL_FACE);
    glCullFace(hidden);
  }
  glUniform1f(uniform(p, HK_MESH, "offset"), (float)offset);
  glDrawElements(GL_TRIANGLES, (GLsizei)(3 * (end - begin)), GL_UNSIGNED_INT,
                 (const void *)(begin * sizeof *p->triangle));
  glDisable(GL_CULL_FACE);
}

/* A surface with a thickness is seen as that of its two sides, on either side of the particles. */
static void draw_cloth(const hk_painter *p, double thickness) {
  if (thickness > 0) {
    draw_triangles(p, 0, p->cloth, GL_BACK, thickness / 2);
    draw_triangles(p, 0, p->cloth, GL_FRONT, -thickness / 2);
  } else {
    draw_triangles(p, 0, p->cloth, BOTH_SIDES, 0);
  }
}

static void draw_mesh(const hk_painter *p, const scene *s) {
  if (!p->triangles) return;
  set_matrices(p, HK_MESH, s->lens.view, s->lens.projection);
  set_light(p, HK_MESH, s->light[0], 0);
  set_shadows(p, HK_MESH, s);
  glBindVertexArray(p->mesh_array);
  glUniform1f(uniform(p, HK_MESH, "solid"), 0);
  draw_cloth(p, s->setup->thickness);
  glUniform1f(uniform(p, HK_MESH, "solid"), 1);
  draw_triangles(p, p->cloth, p->bodies, BOTH_SIDES, 0);
  draw_triangles(p, p->bodies, p->opaque, GL_BACK, 0);
  draw_triangles(p, p->faded, p->planes, BOTH_SIDES, 0);
}

/* What is seen through is drawn over all else that is not nearer; it hides nothing, so that particles, which come
 * later, are seen in front of it. */
static void draw_faded(const hk_painter *p, const scene *s) {
  if (p->opaque == p->faded) return;
  set_matrices(p, HK_MESH, s->lens.view, s->lens.projection);
  set_light(p, HK_MESH, s->light[0], 0);
  set_shadows(p, HK_MESH, s);
  glBindVertexArray(p->mesh_array);
  glUniform1f(uniform(p, HK_MESH, "solid"), 1);
  glUniform1f(uniform(p, HK_MESH, "veil"), 1);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
  glDepthMask(GL_FALSE);
  draw_triangles(p, p->opaque, p->faded, GL_BACK, 0);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glUniform1f(uniform(p, HK_MESH, "veil"), 0);
}

static void draw_tubes(const hk_painter *p, const scene *s) {
  if (!p->tubes) return;
  set_matrices(p, HK_TUBE, s->lens.view, s->lens.projection);
  set_light(p, HK_TUBE, s->light[1], 0);
  glUniform1f(uniform(p, HK_TUBE, "least"), 0.75f);
  glUniform2f(uniform(p, HK_TUBE, "pixel"), 2.f / (float)p->canvas.width, 2.f / (float)p->canvas.height);
  glUniform1f(uniform(p, HK_TUBE, "cap"), 1);
  glUniform1f(uniform(p, HK_TUBE, "solid"), 1);
  set_shadows(p, HK_TUBE, s);
  glBindVertexArray(p->tube_array);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, HK_TUBE_CORNERS, (GLsizei)p->tubes);
}

static void draw_liquid_triangles(const void *painter) {
  const hk_painter *p = painter;
  glBindVertexArray(p->mesh_array);
  glDrawElements(GL_TRIANGLES, (GLsizei)(3 * (p->triangles - p->planes)), GL_UNSIGNED_INT,
                 (const void *)(p->planes * sizeof *p->triangle));
}

static hk_status draw_liquid(hk_painter *p, const scene *s) {
  if (p->planes == p->triangles) return HK_OK;
  hk_water_draw d = {
      &p->canvas, s->setup, &s->lens, s->light[1][0], s->light[1][1], p->patch[HK_THINGS], draw_liquid_triangles, p};
  return hk_water_draw_on(&p->water, p->host, &d);
}

static void draw_backdrop(const hk_painter *p, const hk_view_setup *setup) {
  const float *b = setup->background;
  glUseProgram(p->program[HK_BACKDROP]);
  glUniform3f(uniform(p, HK_BACKDROP, "low"), 1.02f * b[0], 1.01f * b[1], b[2]);
  glUniform3f(uniform(p, HK_BACKDROP, "high"), 0.84f * b[0], 0.89f * b[1], 0.95f * b[2]);
  glBindVertexArray(p->nothing);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

/* The largest of 1, 2, 5 x 10^k below half the size. */
static double grid_spacing(double size) {
  double most = size / 2, decade = pow(10, floor(log10(most)));
  return decade * (most >= 5 * decade ? 5 : most >= 2 * decade ? 2 : 1);
}

static void draw_square(hk_painter *p, const scene *s, int program, const float square[4]) {
  set_matrices(p, program, s->lens.view, s->lens.projection);
  glUniform4fv(uniform(p, program, "square"), 1, square);
  glBindVertexArray(p->nothing);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  glDisable(GL_BLEND);
}

/* Draws the floor; the polygon offset puts it behind objects that lie on it. */
static void draw_floor(hk_painter *p, const scene *s) {
  const hk_view_setup *setup = s->setup;
  const float *b = setup->background;
  double spacing = grid_spacing(setup->size);
  float square[4] = {(float)((setup->low[0] + setup->high[0]) / 2), (float)((setup->low[1] + setup->high[1]) / 2),
                     (float)setup->height, (float)(6 * setup->size)};
  glUseProgram(p->program[HK_FLOOR]);
  glUniform3f(uniform(p, HK_FLOOR, "grid"), (float)spacing, (float)-fmod(setup->offset[0], spacing),
              (float)-fmod(setup->offset[1], spacing));
  glUniform3f(uniform(p, HK_FLOOR, "colour"), fminf(1.03f * b[0], 1), fminf(1.03f * b[1], 1), fminf(1.02f * b[2], 1));
  glUniform1f(uniform(p, HK_FLOOR, "line"), hk_is_dark(b) ? 1.6f : -0.26f);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1, 16);
  draw_square(p, s, HK_FLOOR, square);
  glDisable(GL_POLYGON_OFFSET_FILL);
}

/* Where there is nothing but particles, no one looks into the map's texture. */
static void cast_shadows(hk_painter *p, scene *s) {
  hk_shadow_cast(p, s->setup, s->key);
  s->map = &p->map;
  if (p->triangles + p->tubes == 0) return;
  const hk_height_map *m = &p->map;
  int first = m->rows[0] < p->uploaded[0] ? m->rows[0] : p->uploaded[0];
  int end = m->rows[1] > p->uploaded[1] ? m->rows[1] : p->uploaded[1];
  if (end <= first) return;
  memcpy(p->uploaded, m->rows, sizeof p->uploaded);
  glBindTexture(GL_TEXTURE_2D, p->heights);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, first, HK_HEIGHT_MAP_SIZE, end - first, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT,
                  m->height + (size_t)first * HK_HEIGHT_MAP_SIZE);
}

static void draw_shadow(hk_painter *p, const scene *s) {
  static const float colours[2][3] = {{0.09f, 0.11f, 0.17f}, {0, 0, 0}}; /* by day, by night */
  const hk_height_map *m = s->map;
  glBindTexture(GL_TEXTURE_2D, p->shadow);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, HK_SHADOW_SIZE, HK_SHADOW_SIZE, GL_RED, GL_UNSIGNED_BYTE, p->shade);
  const float *colour = colours[hk_is_dark(s->setup->background)];
  glUseProgram(p->program[HK_SHADE]);
  glUniform3fv(uniform(p, HK_SHADE, "colour"), 1, colour);
  glDepthMask(GL_FALSE);
  draw_square(p, s, HK_SHADE, (float[]){m->corner[0] + m->side / 2, m->corner[1] + m->side / 2, m->floor, m->side / 2});
  glDepthMask(GL_TRUE);
}

static void restore(hk_painter *p) {
  hk_canvas_use(&p->canvas);
  for (int k = 0; k < HK_SPRITES; k++) {
    const hk_patch *at = p->patch + k;
    if (!hk_patch_is_empty(at)) hk_canvas_restore(&p->canvas, at->left, at->bottom, at->width, at->height);
  }
}

/* Backdrop, floor and overlay are the same for all pictures of a camera. What strokes cover stays theirs: nothing is
 * nearer. */
static void draw_surroundings(hk_painter *p, const scene *s) {
  hk_canvas *c = &p->canvas;
  if (p->kept && memcmp(&p->kept_for, &s->setup->camera, sizeof p->kept_for) == 0) {
    restore(p);
    return;
  }
  hk_canvas_use(c);
  glDepthMask(GL_TRUE);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glDisable(GL_DEPTH_TEST);
  draw_backdrop(p, s->setup);
  glEnable(GL_DEPTH_TEST);
  if (s->setup->floor) draw_floor(p, s);
  if (p->overlay) p->overlay(p, p->overlay_context);
  hk_canvas_keep(c);
  hk_canvas_read(c, 0, 0, c->width, c->height, p->still);
  hk_canvas_use(c);
  p->kept = p->fresh = true, p->kept_for = s->setup->camera;
}

static void draw_shadows(hk_painter *p, scene *s) {
  cast_shadows(p, s);
  if (!s->setup->floor) return;
  hk_shadow_shade(p, s->setup);
  hk_patch at = p->patch[HK_SHADOWS] = hk_shadow_patch(p, &s->lens);
  if (hk_patch_is_empty(&at)) return;
  glEnable(GL_SCISSOR_TEST);
  glScissor(at.left, at.bottom, at.width, at.height);
  draw_shadow(p, s);
  glDisable(GL_SCISSOR_TEST);
}

hk_status hk_painter_draw(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *snapshot,
                          uint8_t (*colour)[4]) {
  hk_status status = hk_geometry_fill(p, setup, snapshot, colour);
  if (status != HK_OK) return status;
  scene s = make_scene(setup);
  upload(p);
  draw_surroundings(p, &s);
  memset(p->patch, 0, sizeof p->patch);
  p->patch[HK_THINGS] = hk_things_patch(p, setup, &s.lens);
  glEnable(GL_DEPTH_TEST);
  if (setup->shadows) draw_shadows(p, &s);
  draw_mesh(p, &s);
  draw_tubes(p, &s);
  status = draw_liquid(p, &s);
  if (status == HK_OK) draw_faded(p, &s);
  return status;
}

void hk_painter_strokes(hk_painter *p, const hk_tube *stroke, size_t count, double half_width) {
  float w = 2.f / (float)p->canvas.width, h = 2.f / (float)p->canvas.height;
  float view[16] = {[0] = 1, [5] = 1, [10] = 1, [15] = 1};
  static const float unlit[4][3] = {{0}};
  float projection[16] = {[0] = w, [5] = h, [12] = -1, [13] = -1, [14] = -1, [15] = 1}; /* nearer than all else */
  glDepthFunc(GL_ALWAYS);
  glBindBuffer(GL_ARRAY_BUFFER, p->tube_buffer);
  glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(count * sizeof *stroke), stroke, GL_STREAM_DRAW);
  set_matrices(p, HK_TUBE, view, projection);
  set_light(p, HK_TUBE, unlit, 1);
  glUniform1f(uniform(p, HK_TUBE, "cap"), 0.5f);
  glUniform1f(uniform(p, HK_TUBE, "shaded"), 0);
  glUniform1f(uniform(p, HK_TUBE, "least"), (float)half_width);
  glUniform2f(uniform(p, HK_TUBE, "pixel"), w, h);
  glBindVertexArray(p->tube_array);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, HK_TUBE_CORNERS, (GLsizei)count);
  glDepthFunc(GL_LESS);
}

static hk_sprite_shading shading_of(const scene *s) {
  hk_sprite_shading shading = s->setup->sprites;
  memcpy(shading.light, s->light[1], sizeof shading.light);
  return shading;
}

/* Four fifths of the pixels that shine come to at most 2/(1 + 2) of the strongest light. */
hk_status hk_painter_expose(hk_painter *p, hk_view_setup *setup, const hk_snapshot3d *snapshot, uint8_t (*colour)[4]) {
  setup->sprites.opacity = 1;
  hk_status status = hk_geometry_fill(p, setup, snapshot, colour);
  if (status != HK_OK) return status;
  scene s = make_scene(setup);
  hk_sprite_shading shading = shading_of(&s);
  status = hk_sprites_place(&p->sprites, &s.lens, &shading, p->canvas.width, p->canvas.height, p->point, p->points);
  if (status != HK_OK) return status;
  double level = hk_sprites_level(&p->sprites, &shading, 0.8);
  if (level > 0) setup->sprites.opacity = 2 / level;
  return HK_OK;
}

static void copy_still(const hk_painter *p, const hk_patch *at, unsigned char *rgba) {
  size_t row = (size_t)p->canvas.width * 4;
  size_t from = (size_t)at->bottom * row + (size_t)at->left * 4;
  for (int y = 0; y < at->height; y++, from += row) memcpy(rgba + from, p->still + from, (size_t)at->width * 4);
}

/* Everything but the particles. */
static void read_patches(hk_painter *p, unsigned char *rgba) {
  hk_patch all = {0, 0, p->canvas.width, p->canvas.height};
  if (p->fresh) copy_still(p, &all, rgba);
  for (int k = 0; k < HK_PATCHES && !p->fresh; k++) copy_still(p, p->old + k, rgba);
  for (int k = 0; k < HK_SPRITES; k++) {
    const hk_patch *at = p->patch + k;
    if (!hk_patch_is_empty(at)) hk_canvas_read(&p->canvas, at->left, at->bottom, at->width, at->height, rgba);
  }
  p->fresh = false;
}

static hk_status draw_volumes(hk_painter *p, const scene *s, unsigned char *rgba) {
  if (!p->volumes) return HK_OK;
  hk_volume_draw like = {.host = p->host,
                         .optics = &p->volume_optics,
                         .setup = s->setup,
                         .width = p->canvas.width,
                         .height = p->canvas.height};
  memcpy(like.origin, p->volume_origin, sizeof like.origin);
  memcpy(like.key, s->key, sizeof like.key);
  return hk_volume_pass(p->volumes, &like, &p->canvas, &s->lens, &p->patch[HK_VOLUMES_PATCH], rgba);
}

hk_status hk_painter_read(hk_painter *p, const hk_view_setup *setup, unsigned char *rgba) {
  scene s = make_scene(setup);
  hk_sprites *sprites = &p->sprites;
  hk_sprite_shading shading = shading_of(&s);
  read_patches(p, rgba);
  hk_status status = draw_volumes(p, &s, rgba);
  if (status == HK_OK)
    status = hk_sprites_place(sprites, &s.lens, &shading, p->canvas.width, p->canvas.height, p->point, p->points);
  const hk_light_image *image = &sprites->image;
  p->patch[HK_SPRITES] = (hk_patch){image->left, image->bottom, image->width, image->height};
  memcpy(p->old, p->patch, sizeof p->old);
  if (status != HK_OK || image->width * image->height == 0) return status;
  hk_canvas_read_depth(&p->canvas, image->left, image->bottom, image->width, image->height, sprites->distance);
  hk_camera_distances(&setup->camera, (size_t)image->width * (size_t)image->height, sprites->distance);
  hk_sprites_draw(sprites, &shading, rgba, p->canvas.width);
  return HK_OK;
}
