/* GLSL programs. */
#ifndef HK_GL_PROGRAM_H
#define HK_GL_PROGRAM_H

#include <stddef.h>

/* One kind of shader: its text, and what is put before it. */
typedef struct hk_gl_text {
  const char *shared, *text;
} hk_gl_text;

/* Compiles and links. Returns 0 with the compiler's message in `log` when it
 * fails. Attributes are bound by `layout` qualifiers. */
unsigned hk_gl_program(hk_gl_text vertex, hk_gl_text fragment, char *log, size_t size);

#endif
