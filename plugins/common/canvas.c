#include "plugins/common/canvas.h"

#include "plugins/common/gl.h"

enum { SAMPLES = 4 };

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
  if (depth) glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
  return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

bool hk_canvas_open(hk_canvas *c, int width, int height) {
  *c = (hk_canvas){.width = width, .height = height};
  while (glGetError() != GL_NO_ERROR) {}
  c->colour = make_buffer(SAMPLES, GL_RGBA8, width, height);
  c->depth = make_buffer(SAMPLES, GL_DEPTH_COMPONENT24, width, height);
  c->flat = make_buffer(0, GL_RGBA8, width, height);
  if (glGetError() != GL_NO_ERROR) return false;
  return make_target(&c->drawn, c->colour, c->depth) && make_target(&c->resolved, c->flat, 0);
}

void hk_canvas_close(hk_canvas *c) {
  glDeleteFramebuffers(2, (GLuint[]){c->drawn, c->resolved});
  glDeleteRenderbuffers(3, (GLuint[]){c->colour, c->depth, c->flat});
}

void hk_canvas_use(const hk_canvas *c) {
  glBindFramebuffer(GL_FRAMEBUFFER, c->drawn);
  glViewport(0, 0, c->width, c->height);
}

void hk_canvas_read(const hk_canvas *c, unsigned char *rgba) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, c->drawn);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, c->resolved);
  glBlitFramebuffer(0, 0, c->width, c->height, 0, 0, c->width, c->height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, c->resolved);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, c->width, c->height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}
