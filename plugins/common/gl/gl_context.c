/* The OpenGL context: OSMesa (HK_GL_OSMESA), or Mesa's EGL without a surface (HK_GL_EGL). */
#include "plugins/common/gl/gl_context.h"

#include <stdlib.h>

#if defined(HK_GL_EGL)

#include <EGL/egl.h>
#include <EGL/eglext.h>

struct hk_gl_context {
  EGLDisplay display;
  EGLContext context;
};

static EGLDisplay open_display(void) {
  PFNEGLGETPLATFORMDISPLAYEXTPROC get = (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
  return get ? get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL) : EGL_NO_DISPLAY;
}

static const char *open_context(hk_gl_context *gl) {
  static const EGLint config_wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                         EGL_NONE};
  static const EGLint context_wanted[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
  EGLConfig config;
  EGLint count = 0;
  gl->display = open_display();
  if (gl->display == EGL_NO_DISPLAY || !eglInitialize(gl->display, NULL, NULL)) return "EGL has no surfaceless display";
  if (!eglBindAPI(EGL_OPENGL_API)) return "EGL offers no OpenGL";
  if (!eglChooseConfig(gl->display, config_wanted, &config, 1, &count) || count == 0) return "EGL has no configuration";
  gl->context = eglCreateContext(gl->display, config, EGL_NO_CONTEXT, context_wanted);
  if (gl->context == EGL_NO_CONTEXT) return "EGL cannot create an OpenGL 3.3 context";
  return hk_gl_context_use(gl) ? NULL : "EGL cannot make the context current without a surface";
}

/* The display is shared by the whole process and stays initialized. */
static void close_context(hk_gl_context *gl) {
  if (gl->context == EGL_NO_CONTEXT) return;
  eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(gl->display, gl->context);
}

int hk_gl_context_use(hk_gl_context *gl) {
  return eglBindAPI(EGL_OPENGL_API) && eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, gl->context);
}

#else

#include <GL/osmesa.h>

enum { SURFACE = 16 };

struct hk_gl_context {
  OSMesaContext context;
  unsigned char surface[SURFACE * SURFACE * 4]; /* required by OSMesa; drawing goes to frame buffer objects */
};

static const char *open_context(hk_gl_context *gl) {
  static const int wanted[] = {OSMESA_FORMAT,
                               OSMESA_RGBA,
                               OSMESA_DEPTH_BITS,
                               24,
                               OSMESA_PROFILE,
                               OSMESA_COMPAT_PROFILE,
                               OSMESA_CONTEXT_MAJOR_VERSION,
                               3,
                               OSMESA_CONTEXT_MINOR_VERSION,
                               3,
                               0};
  gl->context = OSMesaCreateContextAttribs(wanted, NULL);
  if (!gl->context) return "OSMesa cannot create an OpenGL 3.3 context";
  return hk_gl_context_use(gl) ? NULL : "OSMesa cannot make the context current";
}

static void close_context(hk_gl_context *gl) {
  if (gl->context) OSMesaDestroyContext(gl->context);
}

int hk_gl_context_use(hk_gl_context *gl) {
  return OSMesaMakeCurrent(gl->context, gl->surface, 0x1401 /* GL_UNSIGNED_BYTE */, SURFACE, SURFACE);
}

#endif

hk_gl_context *hk_gl_context_create(const char **why) {
  hk_gl_context *gl = calloc(1, sizeof *gl);
  *why = gl ? open_context(gl) : "no memory for the OpenGL context";
  if (!*why) return gl;
  hk_gl_context_destroy(gl);
  return NULL;
}

void hk_gl_context_destroy(hk_gl_context *gl) {
  if (gl) close_context(gl);
  free(gl);
}
