/* The passes: the opaque picture and its depths become textures; the way inside the liquid is summed; the nearest
 * surface and where it is left are peeled off; the second surface is drawn over the opaque picture, and the first, with
 * many samples a pixel, over both. */
#include "plugins/common/picture/water.h"

#include "plugins/common/gl/gl.h"
#include "plugins/common/gl/gl_program.h"
#include "plugins/common/gl/water_shaders.h"

/* ---- programs and textures ---- */

static hk_status make_programs(hk_water *w, const hk_host *host) {
  static const char *const fragment[HK_WATER_PROGRAMS] = {hk_thickness_fragment, hk_layer_fragment,
                                                          hk_surface_fragment};
  char log[512] = "";
  for (int k = 0; k < HK_WATER_PROGRAMS; k++) {
    w->program[k] =
        hk_gl_program((hk_gl_text){"", hk_water_vertex}, (hk_gl_text){hk_water_glsl, fragment[k]}, log, sizeof log);
    if (!w->program[k]) return host->fail(host, HK_FAILED, "OpenGL refuses a program: %s", log);
  }
  return HK_OK;
}

typedef struct texture_kind {
  GLint inside;
  GLenum format, type;
  GLint filter;
} texture_kind;

static void make_texture(hk_water *w, int k) {
  static const texture_kind kinds[HK_WATER_TEXTURES] = {
      [HK_WATER_SCENE] = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_LINEAR},
      [HK_WATER_BEHIND] = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_LINEAR},
      [HK_WATER_DEPTHS] = {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, GL_NEAREST},
      [HK_WATER_TOTAL] = {GL_R32F, GL_RED, GL_FLOAT, GL_NEAREST},
      [HK_WATER_ENTRIES] = {GL_RGBA32F, GL_RGBA, GL_FLOAT, GL_NEAREST},
      [HK_WATER_EXITS] = {GL_RGBA32F, GL_RGBA, GL_FLOAT, GL_NEAREST}};
  const texture_kind *kind = kinds + k;
  glBindTexture(GL_TEXTURE_2D, w->texture[k]);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, kind->filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, kind->filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexImage2D(GL_TEXTURE_2D, 0, kind->inside, w->width, w->height, 0, kind->format, kind->type, NULL);
}

/* The scene's target takes colours and depths of the canvas; the others have the depths of layers. */
static bool make_target(hk_water *w, int k) {
  glBindFramebuffer(GL_FRAMEBUFFER, w->target[k]);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, w->texture[k], 0);
  if (k == HK_WATER_SCENE)
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, w->texture[HK_WATER_DEPTHS], 0);
  else
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, w->depth);
  return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

static hk_status open_water(hk_water *w, const hk_host *host, const hk_canvas *canvas) {
  w->width = canvas->width, w->height = canvas->height;
  while (glGetError() != GL_NO_ERROR) {
  }
  glGenTextures(HK_WATER_TEXTURES, w->texture);
  glGenFramebuffers(HK_WATER_TEXTURES, w->target);
  glGenRenderbuffers(1, &w->depth);
  for (int k = 0; k < HK_WATER_TEXTURES; k++) make_texture(w, k);
  glBindRenderbuffer(GL_RENDERBUFFER, w->depth);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, w->width, w->height);
  bool fine = glGetError() == GL_NO_ERROR;
  for (int k = 0; k < HK_WATER_TEXTURES && fine; k++) fine = k == HK_WATER_DEPTHS || make_target(w, k);
  hk_status status = fine
                         ? make_programs(w, host)
                         : host->fail(host, HK_NO_MEMORY, "no memory for a clear liquid on a picture of %d x %d pixels",
                                      w->width, w->height);
  if (status != HK_OK) hk_water_close(w);
  return status;
}

void hk_water_close(hk_water *w) {
  if (!w->width) return;
  for (int k = 0; k < HK_WATER_PROGRAMS; k++) glDeleteProgram(w->program[k]);
  glDeleteTextures(HK_WATER_TEXTURES, w->texture);
  glDeleteFramebuffers(HK_WATER_TEXTURES, w->target);
  glDeleteRenderbuffers(1, &w->depth);
  *w = (hk_water){0};
}

/* ---- passes ---- */

static int uniform(const hk_water *w, int program, const char *name) {
  return glGetUniformLocation(w->program[program], name);
}

static void use_texture(const hk_water *w, int program, const char *name, int texture) {
  glUniform1i(uniform(w, program, name), texture);
  glActiveTexture(GL_TEXTURE0 + (GLenum)texture);
  glBindTexture(GL_TEXTURE_2D, w->texture[texture]);
  glActiveTexture(GL_TEXTURE0);
}

static void use_program(const hk_water *w, int program, const hk_water_draw *d) {
  glUseProgram(w->program[program]);
  glUniformMatrix4fv(uniform(w, program, "view"), 1, GL_FALSE, d->lens->view);
  glUniformMatrix4fv(uniform(w, program, "projection"), 1, GL_FALSE, d->lens->projection);
  glUniform2f(uniform(w, program, "range"), (float)d->setup->camera.near, (float)d->setup->camera.far);
  use_texture(w, program, "depths", HK_WATER_DEPTHS);
}

/* Directs drawing to a texture of which the patch is empty. */
static void begin_texture(const hk_water *w, int texture) {
  glBindFramebuffer(GL_FRAMEBUFFER, w->target[texture]);
  glViewport(0, 0, w->width, w->height);
  glClearBufferfv(GL_COLOR, 0, (const float[4]){0, 0, 0, 0});
  glClear(GL_DEPTH_BUFFER_BIT);
}

static void copy_picture(unsigned from, unsigned to, GLbitfield what, const hk_patch *p) {
  int right = p->left + p->width, top = p->bottom + p->height;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, from);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
  glBlitFramebuffer(p->left, p->bottom, right, top, p->left, p->bottom, right, top, what, GL_NEAREST);
}

static void draw_side(const hk_water_draw *d, GLenum hidden) {
  glEnable(GL_CULL_FACE);
  glCullFace(hidden);
  d->triangles(d->context);
  glDisable(GL_CULL_FACE);
}

static void sum_thickness(const hk_water *w, const hk_water_draw *d) {
  begin_texture(w, HK_WATER_TOTAL);
  use_program(w, HK_WATER_THICKNESS, d);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  d->triangles(d->context);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

static void peel(const hk_water *w, const hk_water_draw *d, int layer) {
  bool first = layer == HK_WATER_ENTRIES;
  begin_texture(w, layer);
  use_program(w, HK_WATER_LAYER, d);
  use_texture(w, HK_WATER_LAYER, "before", first ? HK_WATER_TOTAL : HK_WATER_ENTRIES);
  glUniform1f(uniform(w, HK_WATER_LAYER, "first"), first ? 1 : 0);
  draw_side(d, first ? GL_BACK : GL_FRONT);
}

static float linear(float c) { return c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f); }

/* What is mirrored has the colours of the background, by night as by day: the floor darker, the sky lighter. */
static void set_look(const hk_water *w, const hk_water_draw *d) {
  const hk_water_optics *optics = &d->setup->water;
  float ground[3], air[3];
  for (int c = 0; c < 3; c++) {
    float colour = linear(fminf(d->setup->background[c], 1));
    ground[c] = 0.8f * colour, air[c] = 1.5f * colour;
  }
  glUniform3fv(uniform(w, HK_WATER_SURFACE, "ground"), 1, ground);
  glUniform3fv(uniform(w, HK_WATER_SURFACE, "air"), 1, air);
  glUniform3fv(uniform(w, HK_WATER_SURFACE, "key"), 1, d->key);
  glUniform3fv(uniform(w, HK_WATER_SURFACE, "sky"), 1, d->sky);
  glUniform3fv(uniform(w, HK_WATER_SURFACE, "absorption"), 1, optics->absorption);
  glUniform1f(uniform(w, HK_WATER_SURFACE, "index"), optics->index);
  glUniform1f(uniform(w, HK_WATER_SURFACE, "reach"), (float)d->setup->size);
  use_texture(w, HK_WATER_SURFACE, "total", HK_WATER_TOTAL);
  use_texture(w, HK_WATER_SURFACE, "entries", HK_WATER_ENTRIES);
  use_texture(w, HK_WATER_SURFACE, "exits", HK_WATER_EXITS);
}

static void draw_surface(const hk_water *w, const hk_water_draw *d, bool second) {
  use_texture(w, HK_WATER_SURFACE, "behind", second ? HK_WATER_SCENE : HK_WATER_BEHIND);
  glUniform1f(uniform(w, HK_WATER_SURFACE, "second"), second ? 1 : 0);
  draw_side(d, GL_BACK);
}

/* The second surface is hidden by what is opaque in its shader: its target has the depths of layers. */
hk_status hk_water_draw_on(hk_water *w, const hk_host *host, const hk_water_draw *d) {
  hk_status status = w->width ? HK_OK : open_water(w, host, d->canvas);
  if (status != HK_OK || hk_patch_is_empty(&d->patch)) {
    hk_canvas_use(d->canvas);
    return status;
  }
  hk_patch all = {0, 0, w->width, w->height};
  copy_picture(hk_canvas_target(d->canvas), w->target[HK_WATER_SCENE], GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, &all);
  copy_picture(w->target[HK_WATER_SCENE], w->target[HK_WATER_BEHIND], GL_COLOR_BUFFER_BIT, &all);
  glEnable(GL_SCISSOR_TEST);
  glScissor(d->patch.left, d->patch.bottom, d->patch.width, d->patch.height);
  sum_thickness(w, d);
  peel(w, d, HK_WATER_ENTRIES);
  peel(w, d, HK_WATER_EXITS);
  use_program(w, HK_WATER_SURFACE, d);
  set_look(w, d);
  glBindFramebuffer(GL_FRAMEBUFFER, w->target[HK_WATER_BEHIND]);
  glClear(GL_DEPTH_BUFFER_BIT);
  draw_surface(w, d, true);
  hk_canvas_use(d->canvas);
  draw_surface(w, d, false);
  glDisable(GL_SCISSOR_TEST);
  return HK_OK;
}
