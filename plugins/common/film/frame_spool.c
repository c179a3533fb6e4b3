#include "plugins/common/film/frame_spool.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static hk_status io_error(const hk_frame_spool *s, const char *doing) {
  return s->host->fail(s->host, HK_IO, "cannot %s the frames that wait to be drawn: %s", doing, strerror(errno));
}

hk_status hk_frame_spool_open(hk_frame_spool *s, const hk_host *host, const char *name) {
  char path[PATH_MAX];
  *s = (hk_frame_spool){.host = host, .file = -1};
  hk_status status = host->path(host, name, path, sizeof path);
  if (status != HK_OK) return status;
  s->file = mkstemp(path);
  if (s->file < 0) return host->fail(host, HK_IO, "cannot create %s: %s", path, strerror(errno));
  fcntl(s->file, F_SETFD, FD_CLOEXEC);
  unlink(path);
  return HK_OK;
}

void hk_frame_spool_close(hk_frame_spool *s) {
  if (!s->host) return;
  if (s->file >= 0) close(s->file);
  s->host->release(s->host, s->entry);
  *s = (hk_frame_spool){0};
}

static bool put(hk_frame_spool *s, const void *data, size_t bytes) {
  for (const char *from = data; bytes;) {
    ssize_t done = pwrite(s->file, from, bytes, (off_t)s->end);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    from += done, bytes -= (size_t)done, s->end += done;
  }
  return true;
}

static bool get(const hk_frame_spool *s, int64_t *at, void *data, size_t bytes) {
  for (char *to = data; bytes;) {
    ssize_t done = pread(s->file, to, bytes, (off_t)*at);
    if (done < 0 && errno == EINTR) continue;
    if (done == 0) errno = EIO;
    if (done <= 0) return false;
    to += done, bytes -= (size_t)done, *at += done;
  }
  return true;
}

static hk_status make_room(hk_frame_spool *s) {
  if (s->count < s->room) return HK_OK;
  size_t room = 2 * s->room + 64;
  hk_frame_spool_entry *entry = s->host->allocate(s->host, room * sizeof *entry);
  if (!entry) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the list of %zu frames", room);
  if (s->count) memcpy(entry, s->entry, s->count * sizeof *entry);
  s->host->release(s->host, s->entry);
  s->entry = entry, s->room = room;
  return HK_OK;
}

hk_status hk_frame_spool_add(hk_frame_spool *s, const hk_snapshot3d *shot) {
  hk_status status = make_room(s);
  if (status != HK_OK) return status;
  hk_frame_spool_entry *e = s->entry + s->count;
  int64_t end = s->end;
  bool same = s->count && e[-1].topology == shot->topology;
  *e = (hk_frame_spool_entry){.n = shot->n,
                              .triangles = shot->triangles,
                              .lines = shot->lines,
                              .reach = shot->reach,
                              .topology = shot->topology};
  memcpy(e->low, shot->low, sizeof e->low);
  memcpy(e->high, shot->high, sizeof e->high);
  e->topology_at = same ? e[-1].topology_at : s->end;
  bool ok = same || (put(s, shot->mark, shot->n) && put(s, shot->triangle, shot->triangles * sizeof *shot->triangle) &&
                     put(s, shot->line, shot->lines * sizeof *shot->line));
  e->at = s->end;
  ok = ok && put(s, shot->x, shot->n * sizeof *shot->x) && put(s, shot->ink, shot->n * sizeof *shot->ink);
  if (!ok) {
    s->end = end;
    return io_error(s, "write");
  }
  s->count++;
  return HK_OK;
}

hk_status hk_frame_spool_read(const hk_frame_spool *s, size_t k, hk_snapshot3d *shot) {
  const hk_frame_spool_entry *e = s->entry + k;
  hk_status status = hk_snapshot3d_reserve(shot, e->n, e->triangles, e->lines);
  if (status != HK_OK) return status;
  int64_t at = e->topology_at;
  bool ok = true;
  if (shot->stale || shot->topology != e->topology)
    ok = get(s, &at, shot->mark, e->n) && get(s, &at, shot->triangle, e->triangles * sizeof *shot->triangle) &&
         get(s, &at, shot->line, e->lines * sizeof *shot->line);
  at = e->at;
  ok = ok && get(s, &at, shot->x, e->n * sizeof *shot->x) && get(s, &at, shot->ink, e->n * sizeof *shot->ink);
  shot->stale = !ok;
  if (!ok) return io_error(s, "read");
  shot->n = e->n, shot->triangles = e->triangles, shot->lines = e->lines;
  shot->topology = e->topology;
  memcpy(shot->low, e->low, sizeof e->low);
  memcpy(shot->high, e->high, sizeof e->high);
  shot->reach = e->reach;
  return HK_OK;
}
