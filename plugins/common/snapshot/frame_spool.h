/* Snapshots stored in an unlinked file until the settings that depend on the whole motion are known: the camera, the
 * range of colours. The system removes the file with its descriptor, however the program ends. */
#ifndef HK_FRAME_SPOOL_H
#define HK_FRAME_SPOOL_H

#include "plugins/common/snapshot/point_sample.h"

typedef struct hk_frame_spool_entry {
  int64_t at, topology_at; /* offsets in the file, bytes */
  uint64_t topology;       /* as in hk_snapshot3d */
  size_t n, triangles, cloth, rigid, lines;
  bool normals;                 /* of the liquid's mesh */
  double eye[3], target[3];     /* as in hk_snapshot3d */
  float low[3], high[3], reach; /* as in hk_snapshot3d */
} hk_frame_spool_entry;

typedef struct hk_frame_spool {
  const hk_host *host;
  int file;
  int64_t end;
  size_t count, room;
  hk_frame_spool_entry *entry;
  hk_point_sample points;
} hk_frame_spool;

/* `name`: name of the file until it is unlinked, inside the run's output folder, ending in XXXXXX. */
hk_status hk_frame_spool_open(hk_frame_spool *, const hk_host *host, const char *name);
hk_status hk_frame_spool_add(hk_frame_spool *, const hk_snapshot3d *snapshot);
/* Reads snapshot k; its topology only when `snapshot` does not contain it already. */
hk_status hk_frame_spool_read(const hk_frame_spool *, size_t k, hk_snapshot3d *snapshot);
void hk_frame_spool_close(hk_frame_spool *); /* a zeroed spool is allowed */

#endif
