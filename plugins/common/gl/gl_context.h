/* An OpenGL context (3.3 or later) without a window or a display. Whoever draws makes a frame buffer object: the
 * context's own surface is not used. This file alone knows where the context comes from. */
#ifndef HK_GL_CONTEXT_H
#define HK_GL_CONTEXT_H

typedef struct hk_gl_context hk_gl_context;

/* NULL with `why` (a static text) when there is none to be had. The new context is current on the calling thread. */
hk_gl_context *hk_gl_context_create(const char **why);
/* Makes it current on the calling thread; false when that fails. */
int hk_gl_context_use(hk_gl_context *);
void hk_gl_context_destroy(hk_gl_context *); /* NULL is fine */

#endif
