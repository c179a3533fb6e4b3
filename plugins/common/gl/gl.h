/* OpenGL's functions, linked directly: from OSMesa, or from libOpenGL beside EGL. */
#ifndef HK_GL_H
#define HK_GL_H

#define GL_GLEXT_PROTOTYPES 1
#include <GL/gl.h>
#include <GL/glext.h>

#endif
