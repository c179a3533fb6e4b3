/* An OpenGL context (3.3 or later) without a window or a display. Callers draw to a frame buffer object: the context's
 * own surface is not used. Only gl_context.c depends on the source of the context. */
#ifndef HK_GL_CONTEXT_H
#define HK_GL_CONTEXT_H

typedef struct hk_gl_context hk_gl_context;

/* NULL with `why` (a static text): no context is available. The new context is current on the calling thread. */
hk_gl_context *hk_gl_context_create(const char **why);
/* Makes the context current on the calling thread; false when that fails. */
int hk_gl_context_use(hk_gl_context *);
void hk_gl_context_destroy(hk_gl_context *); /* NULL is allowed */

#endif
