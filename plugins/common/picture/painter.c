/* Creation and destruction of the painter: programs, vertex arrays, the shadows' textures. */
#include "plugins/common/picture/painter.h"

#include "plugins/common/gl/gl.h"
#include "plugins/common/gl/gl_program.h"
#include "plugins/common/gl/shaders.h"

static hk_status make_programs(hk_painter *p) {
  static const char *const source[HK_PROGRAMS][2] = {
      [HK_MESH] = {hk_mesh_vertex, hk_mesh_fragment},           [HK_TUBE] = {hk_tube_vertex, hk_tube_fragment},
      [HK_FLOOR] = {hk_floor_vertex, hk_floor_fragment},        [HK_SHADE] = {hk_floor_vertex, hk_shade_fragment},
      [HK_BACKDROP] = {hk_screen_vertex, hk_backdrop_fragment},
  };
  char log[512] = "";
  for (int k = 0; k < HK_PROGRAMS; k++) {
    bool lit = k <= HK_TUBE;
    hk_gl_text vertex = {lit ? hk_map_glsl : "", source[k][0]}, fragment = {lit ? hk_light_glsl : "", source[k][1]};
    p->program[k] = hk_gl_program(vertex, fragment, log, sizeof log);
    if (!p->program[k]) return p->host->fail(p->host, HK_FAILED, "OpenGL refuses a program: %s", log);
  }
  return HK_OK;
}

/* `advance` 1: one value per instance. */
static void attribute(unsigned place, int size, GLenum type, size_t stride, size_t offset, unsigned advance) {
  glEnableVertexAttribArray(place);
  glVertexAttribPointer(place, size, type, type == GL_UNSIGNED_BYTE, (GLsizei)stride, (const void *)offset);
  glVertexAttribDivisor(place, advance);
}

static void begin_instances(unsigned *array, unsigned *buffer, unsigned corners) {
  glGenVertexArrays(1, array);
  glGenBuffers(1, buffer);
  glBindVertexArray(*array);
  glBindBuffer(GL_ARRAY_BUFFER, corners);
  attribute(0, 2, GL_FLOAT, 2 * sizeof(float), 0, 0);
  glBindBuffer(GL_ARRAY_BUFFER, *buffer);
}

static void make_arrays(hk_painter *p) {
  static const float corner[2 * HK_TUBE_CORNERS] = {-1, -1, -1, 1, 0, -1, 0, 1, 1, -1, 1, 1, 2, -1, 2, 1};
  glGenVertexArrays(1, &p->nothing);
  glGenBuffers(1, &p->corner_buffer);
  glBindBuffer(GL_ARRAY_BUFFER, p->corner_buffer);
  glBufferData(GL_ARRAY_BUFFER, sizeof corner, corner, GL_STATIC_DRAW);
  begin_instances(&p->tube_array, &p->tube_buffer, p->corner_buffer);
  attribute(1, 3, GL_FLOAT, sizeof(hk_tube), offsetof(hk_tube, a), 1);
  attribute(2, 3, GL_FLOAT, sizeof(hk_tube), offsetof(hk_tube, b), 1);
  attribute(3, 4, GL_UNSIGNED_BYTE, sizeof(hk_tube), offsetof(hk_tube, colour_a), 1);
  attribute(4, 4, GL_UNSIGNED_BYTE, sizeof(hk_tube), offsetof(hk_tube, colour_b), 1);
  attribute(5, 1, GL_FLOAT, sizeof(hk_tube), offsetof(hk_tube, radius), 1);
  glGenVertexArrays(1, &p->mesh_array);
  glGenBuffers(1, &p->mesh_buffer);
  glGenBuffers(1, &p->index_buffer);
  glBindVertexArray(p->mesh_array);
  glBindBuffer(GL_ARRAY_BUFFER, p->mesh_buffer);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, p->index_buffer);
  attribute(0, 3, GL_FLOAT, sizeof(hk_vertex), offsetof(hk_vertex, x), 0);
  attribute(1, 3, GL_FLOAT, sizeof(hk_vertex), offsetof(hk_vertex, normal), 0);
  attribute(2, 4, GL_UNSIGNED_BYTE, sizeof(hk_vertex), offsetof(hk_vertex, colour), 0);
}

static void begin_texture(unsigned *texture, GLint wrap) {
  glGenTextures(1, texture);
  glBindTexture(GL_TEXTURE_2D, *texture);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
}

/* The second compares a height with those of the map; outside of it everything is in the light. */
static void make_shadows(hk_painter *p) {
  begin_texture(&p->shadow, GL_CLAMP_TO_EDGE);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, HK_SHADOW_SIZE, HK_SHADOW_SIZE, 0, GL_RED, GL_UNSIGNED_BYTE, NULL);
  begin_texture(&p->heights, GL_CLAMP_TO_BORDER);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT16, HK_HEIGHT_MAP_SIZE, HK_HEIGHT_MAP_SIZE, 0, GL_DEPTH_COMPONENT,
               GL_UNSIGNED_SHORT, NULL);
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, (const float[4]){0, 0, 0, 0});
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
}

hk_status hk_painter_open(hk_painter *p, const hk_host *host, int width, int height) {
  *p = (hk_painter){.host = host};
  hk_sprites_open(&p->sprites, host);
  if (!hk_canvas_open(&p->canvas, width, height))
    return host->fail(host, HK_NO_MEMORY, "no memory for a picture of %d x %d pixels", width, height);
  make_arrays(p);
  make_shadows(p);
  p->shade = host->allocate(host, 2 * HK_SHADOW_SIZE * HK_SHADOW_SIZE);
  p->map.height = host->allocate(host, sizeof *p->map.height * HK_HEIGHT_MAP_SIZE * HK_HEIGHT_MAP_SIZE);
  p->uploaded[1] = HK_HEIGHT_MAP_SIZE;
  if (!p->shade || !p->map.height) return host->fail(host, HK_NO_MEMORY, "no memory for the shadow");
  p->still = host->allocate(host, (size_t)width * (size_t)height * 4);
  if (!p->still) return host->fail(host, HK_NO_MEMORY, "no memory for a picture");
  return make_programs(p);
}

void hk_painter_close(hk_painter *p) {
  if (!p->host) return;
  for (int k = 0; k < HK_PROGRAMS; k++) glDeleteProgram(p->program[k]);
  glDeleteVertexArrays(3, (GLuint[]){p->mesh_array, p->tube_array, p->nothing});
  glDeleteBuffers(4, (GLuint[]){p->mesh_buffer, p->index_buffer, p->tube_buffer, p->corner_buffer});
  glDeleteTextures(2, (GLuint[]){p->shadow, p->heights});
  hk_border_free(&p->border, p->host);
  hk_water_close(&p->water);
  hk_corner_normals_free(&p->normals, p->host);
  hk_canvas_close(&p->canvas);
  hk_sprites_close(&p->sprites);
  void *all[] = {p->vertex, p->tube, p->point, p->triangle, p->shade, p->map.height, p->corner, p->still, p->share};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) p->host->release(p->host, all[k]);
  *p = (hk_painter){0};
}
