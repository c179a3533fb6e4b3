#include "plugins/common/gl/canvas.h"

#include "plugins/common/gl/gl.h"

#include <stddef.h>

enum { SAMPLES = 4 };
enum { DRAWN, KEPT, FLAT };

static unsigned make_buffer(int samples, GLenum format, int width, int height) {
  GLuint buffer;
  glGenRenderbuffers(1, &buffer);
  glBindRenderbuffer(GL_RENDERBUFFER, buffer);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  return buffer;
}

static bool make_target(unsigned *target, unsigned colour, unsigned depth) {
  glGenFramebuffers(1, target);
  glBindFramebuffer(GL_FRAMEBUFFER, *target);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
  return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

bool hk_canvas_open(hk_canvas *c, int width, int height) {
  *c = (hk_canvas){.width = width, .height = height};
  while (glGetError() != GL_NO_ERROR) {
  }
  for (int k = 0; k < 6; k++)
    c->buffer[k] = make_buffer(k < 4 ? SAMPLES : 0, k % 2 ? GL_DEPTH_COMPONENT24 : GL_RGBA8, width, height);
  if (glGetError() != GL_NO_ERROR) return false;
  bool ok = true;
  for (int k = 0; k < 3; k++) ok = make_target(&c->target[k], c->buffer[2 * k], c->buffer[2 * k + 1]) && ok;
  return ok;
}

void hk_canvas_close(hk_canvas *c) {
  glDeleteFramebuffers(3, c->target);
  glDeleteRenderbuffers(6, c->buffer);
}

void hk_canvas_use(const hk_canvas *c) {
  glBindFramebuffer(GL_FRAMEBUFFER, c->target[DRAWN]);
  glViewport(0, 0, c->width, c->height);
}

unsigned hk_canvas_target(const hk_canvas *c) { return c->target[DRAWN]; }

static void copy_part(const hk_canvas *c, int from, int to, GLbitfield what, int x, int y, int width, int height) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, c->target[from]);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, c->target[to]);
  glBlitFramebuffer(x, y, x + width, y + height, x, y, x + width, y + height, what, GL_NEAREST);
}

void hk_canvas_keep(const hk_canvas *c) {
  copy_part(c, DRAWN, KEPT, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, 0, 0, c->width, c->height);
  hk_canvas_use(c);
}

void hk_canvas_restore(const hk_canvas *c, int x, int y, int width, int height) {
  copy_part(c, KEPT, DRAWN, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, x, y, width, height);
  hk_canvas_use(c);
}

void hk_canvas_read(const hk_canvas *c, int x, int y, int width, int height, unsigned char *rgba) {
  copy_part(c, DRAWN, FLAT, GL_COLOR_BUFFER_BIT, x, y, width, height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, c->target[FLAT]);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ROW_LENGTH, c->width);
  glReadPixels(x, y, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba + ((size_t)y * (size_t)c->width + (size_t)x) * 4);
  glPixelStorei(GL_PACK_ROW_LENGTH, 0);
}

void hk_canvas_read_depth(const hk_canvas *c, int x, int y, int width, int height, float *depth) {
  copy_part(c, DRAWN, FLAT, GL_DEPTH_BUFFER_BIT, x, y, width, height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, c->target[FLAT]);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(x, y, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depth);
}
