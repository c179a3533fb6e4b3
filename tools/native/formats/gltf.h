/* glTF 2.0 in one binary file (Khronos, glTF 2.0 Specification, 3.7 to 3.11 and 4.4), which Blender and browsers open.
 * Frames with the same particles and cells are one mesh and its morph targets; where these change another mesh begins,
 * and a node shows each while it holds. Positions are single precision, relative to the middle of the first frame; y is
 * up. */
#ifndef HK_GLTF_H
#define HK_GLTF_H

#include "tools/native/formats/formats.h"

/* What stands in the lists of the file's JSON, each written to as the frames come. */
typedef enum hk_gltf_list {
  HK_GLTF_NODES,
  HK_GLTF_MESHES,
  HK_GLTF_ACCESSORS,
  HK_GLTF_VIEWS,
  HK_GLTF_SAMPLERS,
  HK_GLTF_CHANNELS,
  HK_GLTF_TARGETS, /* those of the last mesh, of its triangles */
  HK_GLTF_POINTS,  /* and of its segments and points, which have no normals */
  HK_GLTF_LISTS
} hk_gltf_list;

typedef struct hk_gltf {
  hk_whole_file file;
  struct {
    FILE *stream;
    char *text;
    size_t length, count;
  } list[HK_GLTF_LISTS];
  size_t room;  /* bytes that the JSON may take */
  size_t bytes; /* of the binary part so far */
  double origin[3];
  float *begin, *normal, *now; /* of the mesh under way: places and normals of its first frame; scratch (n x 3) */
  size_t n, frames;            /* its particles and frames; 0 frames: there is none */
  hk_frame_cells cells;        /* its own copy */
  double *time;                /* s, of all frames */
  size_t times, most, first;   /* so far; at most; that with which the mesh began */
  bool smooth;                 /* its triangles have normals */
  bool z_up;
} hk_gltf;

/* For at most so many frames; z_up: of the scene. False with a sentence in `why`. */
bool hk_gltf_open(hk_gltf *, const char *path, size_t frames, bool z_up, char *why, size_t size);
/* changed: the particles or cells are others than in the frame before. */
bool hk_gltf_add(hk_gltf *, const hk_frame_data *, bool changed, char *why, size_t size);
/* A zeroed one is allowed. Without `keep` there is no file then. */
bool hk_gltf_close(hk_gltf *, bool keep, char *why, size_t size);

#endif
