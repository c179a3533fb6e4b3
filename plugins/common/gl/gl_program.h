/* GLSL programs. */
#ifndef HK_GL_PROGRAM_H
#define HK_GL_PROGRAM_H

#include <stddef.h>

/* Compiles and links; `shared` is put before the fragment text. Returns 0 with the compiler's message in `log` when it
 * fails. Attributes are bound by `layout` qualifiers. */
unsigned hk_gl_program(const char *vertex, const char *shared, const char *fragment, char *log, size_t size);

#endif
