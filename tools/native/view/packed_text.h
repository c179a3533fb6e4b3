/* Bytes as text for a page: deflated (RFC 1950) and then in base64 (RFC 4648). */
#ifndef HK_PACKED_TEXT_H
#define HK_PACKED_TEXT_H

#include <stddef.h>

/* To be freed, ended by 0; NULL: no memory. */
char *hk_packed_text(const void *byte, size_t bytes, size_t *length);

#endif
