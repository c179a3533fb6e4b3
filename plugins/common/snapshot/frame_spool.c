#include "plugins/common/snapshot/frame_spool.h"

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
  hk_status status = hk_point_sample_open(&s->points, host);
  if (status == HK_OK) status = host->path(host, name, path, sizeof path);
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
  hk_point_sample_close(&s->points, s->host);
  *s = (hk_frame_spool){0};
}

static bool append_bytes(hk_frame_spool *s, const void *data, size_t bytes) {
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

static bool append_extras(hk_frame_spool *s, const hk_snapshot3d *snapshot) {
  bool ok = true;
  for (int k = 0; k < HK_EXTRAS; k++) {
    size_t width = hk_snapshot3d_extra_width(snapshot, k);
    ok = ok && append_bytes(s, snapshot->extra[k], snapshot->n * width * sizeof(float));
  }
  return ok;
}

static bool get_extras(const hk_frame_spool *s, int64_t *at, size_t n, hk_snapshot3d *snapshot) {
  bool ok = true;
  for (int k = 0; k < HK_EXTRAS; k++) {
    size_t width = hk_snapshot3d_extra_width(snapshot, k);
    ok = ok && get(s, at, snapshot->extra[k], n * width * sizeof(float));
  }
  return ok;
}

/* The mesh of the liquid follows the solids, whose last says how large it is. */
static bool append_liquid(hk_frame_spool *s, const hk_snapshot3d *snapshot) {
  if (!snapshot->liquid) return true;
  const hk_frame_solid *mesh = snapshot->solid + snapshot->solids - 1;
  size_t bytes = 3 * mesh->vertices * sizeof(double);
  return append_bytes(s, mesh->vertex, bytes) && append_bytes(s, snapshot->normal, snapshot->normal ? bytes : 0) &&
         append_bytes(s, mesh->face, mesh->faces * sizeof *mesh->face);
}

static hk_status reserve_liquid(hk_snapshot3d *s, size_t vertices, size_t faces) {
  const hk_host *host = s->host;
  if (vertices >= s->mesh_room) {
    s->mesh_room = vertices + vertices / 2 + 1;
    host->release(host, s->mesh);
    s->mesh = host->allocate(host, 6 * s->mesh_room * sizeof *s->mesh);
  }
  if (faces >= s->face_room) {
    s->face_room = faces + faces / 2 + 1;
    host->release(host, s->mesh_face);
    s->mesh_face = host->allocate(host, s->face_room * sizeof *s->mesh_face);
  }
  if (s->mesh && s->mesh_face) return HK_OK;
  s->mesh_room = s->face_room = 0;
  return host->fail(host, HK_NO_MEMORY, "no memory for a liquid's surface of %zu vertices", vertices);
}

static hk_status get_liquid(const hk_frame_spool *s, int64_t *at, bool normals, hk_snapshot3d *snapshot) {
  if (!snapshot->liquid) return HK_OK;
  hk_frame_solid *mesh = snapshot->solid + snapshot->solids - 1;
  size_t vertices = mesh->vertices, bytes = 3 * vertices * sizeof(double);
  hk_status status = reserve_liquid(snapshot, vertices, mesh->faces);
  if (status != HK_OK) return status;
  double *normal = snapshot->mesh + 3 * vertices;
  mesh->vertex = snapshot->mesh, mesh->face = (const uint32_t(*)[3])snapshot->mesh_face;
  snapshot->normal = normals ? normal : NULL;
  bool ok = get(s, at, snapshot->mesh, bytes) && get(s, at, normal, normals ? bytes : 0) &&
            get(s, at, snapshot->mesh_face, mesh->faces * sizeof *mesh->face);
  return ok ? HK_OK : io_error(s, "read");
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

hk_status hk_frame_spool_add(hk_frame_spool *s, const hk_snapshot3d *snapshot) {
  hk_status status = make_room(s);
  if (status != HK_OK) return status;
  hk_frame_spool_entry *e = s->entry + s->count;
  int64_t end = s->end;
  bool same = s->count && e[-1].topology == snapshot->topology;
  *e = (hk_frame_spool_entry){.n = snapshot->n,
                              .triangles = snapshot->triangles,
                              .cloth = snapshot->cloth,
                              .rigid = snapshot->rigid,
                              .lines = snapshot->lines,
                              .normals = snapshot->normal != NULL,
                              .reach = snapshot->reach,
                              .topology = snapshot->topology};
  memcpy(e->eye, snapshot->eye, sizeof e->eye);
  memcpy(e->target, snapshot->target, sizeof e->target);
  memcpy(e->low, snapshot->low, sizeof e->low);
  memcpy(e->high, snapshot->high, sizeof e->high);
  e->topology_at = same ? e[-1].topology_at : s->end;
  bool ok = same || (append_bytes(s, snapshot->mark, snapshot->n) &&
                     append_bytes(s, snapshot->triangle, snapshot->triangles * sizeof *snapshot->triangle) &&
                     append_bytes(s, snapshot->line, snapshot->lines * sizeof *snapshot->line));
  e->at = s->end;
  ok = ok && append_bytes(s, snapshot->x, snapshot->n * sizeof *snapshot->x) &&
       append_bytes(s, snapshot->colour, snapshot->n * sizeof *snapshot->colour) &&
       append_bytes(s, snapshot->solid, snapshot->solids * sizeof *snapshot->solid) && append_extras(s, snapshot) &&
       append_liquid(s, snapshot);
  if (!ok) {
    s->end = end;
    return io_error(s, "write");
  }
  hk_point_sample_add(&s->points, snapshot, (uint32_t)s->count++);
  return HK_OK;
}

hk_status hk_frame_spool_read(const hk_frame_spool *s, size_t k, hk_snapshot3d *snapshot) {
  const hk_frame_spool_entry *e = s->entry + k;
  hk_status status = hk_snapshot3d_reserve(snapshot, e->n, e->triangles, e->lines);
  if (status != HK_OK) return status;
  int64_t at = e->topology_at;
  bool ok = true;
  if (snapshot->stale || snapshot->topology != e->topology)
    ok = get(s, &at, snapshot->mark, e->n) &&
         get(s, &at, snapshot->triangle, e->triangles * sizeof *snapshot->triangle) &&
         get(s, &at, snapshot->line, e->lines * sizeof *snapshot->line);
  at = e->at;
  ok = ok && get(s, &at, snapshot->x, e->n * sizeof *snapshot->x) &&
       get(s, &at, snapshot->colour, e->n * sizeof *snapshot->colour) &&
       get(s, &at, snapshot->solid, snapshot->solids * sizeof *snapshot->solid) && get_extras(s, &at, e->n, snapshot);
  snapshot->stale = !ok;
  if (!ok) return io_error(s, "read");
  status = get_liquid(s, &at, e->normals, snapshot);
  if (status != HK_OK) return status;
  snapshot->n = e->n, snapshot->triangles = e->triangles, snapshot->lines = e->lines;
  snapshot->cloth = e->cloth, snapshot->rigid = e->rigid;
  snapshot->topology = e->topology;
  memcpy(snapshot->eye, e->eye, sizeof e->eye);
  memcpy(snapshot->target, e->target, sizeof e->target);
  memcpy(snapshot->low, e->low, sizeof e->low);
  memcpy(snapshot->high, e->high, sizeof e->high);
  snapshot->reach = e->reach;
  return HK_OK;
}
