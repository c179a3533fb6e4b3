/* Reading recordings (recorder.h). All that does not grow with the number of particles is read when one is opened; a
 * file whose numbers contradict each other is refused. */
#ifndef HK_RECORDING_READER_H
#define HK_RECORDING_READER_H

#include "plugins/common/frame_data/frame_data.h"
#include "plugins/common/recording/mark_series.h"
#include "plugins/common/recording/solid_series.h"

#include <hdf5.h>

typedef struct hk_recorded_array {
  char name[HK_ARRAY_NAME]; /* in the scene: of the channel, or label of the force */
  bool force;
  size_t width;
  hid_t set;
} hk_recorded_array;

typedef struct hk_recorded_series {
  bool measure;   /* of the scene */
  char name[256]; /* "kinetic", "momentum x", or the name of a measure */
  char unit[32];  /* of a measure; "": not said */
  double *value;  /* of each frame */
} hk_recorded_series;

typedef struct hk_recorded_frame {
  int64_t part, points, fixed, cells, connectivity, strain; /* the rows at which its numbers begin */
  bool changed; /* the particles, masses, pins or cells are others than in the frame before; true for the first */
} hk_recorded_frame;

typedef struct hk_recorded_part {
  int64_t n, vertices, segments, triangles;
} hk_recorded_part;

typedef struct hk_recording {
  hid_t file;
  size_t frames;
  double fps;
  int64_t every;
  char verdict[32];
  char *scene, *origin, *groups; /* groups: names, one a line; "": there is one */
  double *time;                  /* s, of each frame */
  hk_recorded_frame *frame;
  size_t parts;
  hk_recorded_part *part;
  size_t arrays;
  hk_recorded_array *array;
  uint64_t stored; /* bytes that arrays and series take in the file */
  size_t series;
  hk_recorded_series *serie;
  hid_t points, velocity, strain, id, mass, pin, group, strand_radius, connectivity,
      cell_strain; /* negative: the file has none */
  hk_recorded_solids solids;
  hk_recorded_mark_lists marks;
} hk_recording;

/* NULL with a sentence in `why`. */
hk_recording *hk_recording_open(const char *path, char *why, size_t size);
void hk_recording_close(hk_recording *);
static inline const hk_recorded_part *hk_recorded_part_of(const hk_recording *r, size_t k) {
  return &r->part[r->frame[k].part];
}

/* Rows of a frame's numbers of its particles: of points, velocity, strain or an array's set (n x width doubles). */
bool hk_recording_moving(const hk_recording *, hid_t set, size_t k, size_t width, double *to);
/* Of id (uint32_t), mass and strand_radius (double), pin (uint8_t). */
bool hk_recording_fixed(const hk_recording *, hid_t set, size_t k, hid_t type, void *to);
/* Each within the names. */
bool hk_recording_groups(const hk_recording *, size_t k, uint32_t *to);
bool hk_recording_vertices(const hk_recording *, size_t k, uint32_t *to);
bool hk_recording_segments(const hk_recording *, size_t k, uint32_t *to);  /* 2 for each */
bool hk_recording_triangles(const hk_recording *, size_t k, uint32_t *to); /* 3 for each */
bool hk_recording_cell_strain(const hk_recording *, size_t k, size_t first, size_t count, double *to);

#endif
