/* PC2, the point cache of 3ds Max, which Blender's modifier Mesh Cache reads: the positions of a mesh whose vertices
 * stay the same. A head of 32 bytes, then n x 3 floats per frame, all little endian:
 *
 *   "POINTCACHE2\0", int32 version = 1, int32 n, float first frame = 0, float frames per sample = 1, int32 samples */
#ifndef HK_PC2_H
#define HK_PC2_H

#include "tools/native/formats/formats.h"

typedef struct hk_pc2 {
  hk_whole_file file;
  size_t n, samples;
  uint32_t *id; /* n: the particles have to stay the same */
} hk_pc2;

/* Whether the frame has the particles of the cache. */
bool hk_pc2_fits(const hk_pc2 *, const hk_frame_data *);
/* False with a sentence in `why`. `add` is for frames that fit. */
bool hk_pc2_open(hk_pc2 *, const char *path, const hk_frame_data *first, char *why, size_t size);
bool hk_pc2_add(hk_pc2 *, const hk_frame_data *, char *why, size_t size);
/* A zeroed one is allowed. Without `keep` there is no file then. */
bool hk_pc2_close(hk_pc2 *, bool keep, char *why, size_t size);

#endif
