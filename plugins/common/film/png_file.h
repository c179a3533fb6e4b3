/* PNG files. */
#ifndef HK_PNG_FILE_H
#define HK_PNG_FILE_H

#include <stddef.h>

/* Writes width x height pixels, 4 bytes each, of which the first three are used, the bottom row first. Returns 0, or -1
 * with the cause in `why`. */
int hk_png_write(const char *path, int width, int height, const unsigned char *rgba, char *why, size_t size);

#endif
