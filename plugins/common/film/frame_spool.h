/* Shots waiting in an unlinked file for what must be known of the whole motion: the camera, the range of colours. The
 * file vanishes with its descriptor, however the program ends. */
#ifndef HK_FRAME_SPOOL_H
#define HK_FRAME_SPOOL_H

#include "plugins/common/picture/snapshot3d.h"

typedef struct hk_frame_spool_entry {
  int64_t at, topology_at; /* bytes into the file */
  uint64_t topology;       /* as in hk_snapshot3d */
  size_t n, triangles, lines;
  float low[3], high[3], reach; /* as in hk_snapshot3d */
} hk_frame_spool_entry;

typedef struct hk_frame_spool {
  const hk_host *host;
  int file;
  int64_t end;
  size_t count, room;
  hk_frame_spool_entry *entry;
} hk_frame_spool;

/* `name`: of the file while it has one, inside the run's output folder, ending in XXXXXX. */
hk_status hk_frame_spool_open(hk_frame_spool *, const hk_host *host, const char *name);
hk_status hk_frame_spool_add(hk_frame_spool *, const hk_snapshot3d *shot);
/* Reads shot k; what joins the particles only when `shot` does not hold it already. */
hk_status hk_frame_spool_read(const hk_frame_spool *, size_t k, hk_snapshot3d *shot);
void hk_frame_spool_close(hk_frame_spool *); /* also of a zeroed one */

#endif
