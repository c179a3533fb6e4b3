/* Each frame is a collection of up to three grids over the same points: vertices, segments and triangles, whose indices
 * stand one after the other in the recording's Connectivity. */
#define _GNU_SOURCE
#include "plugins/common/recording/xdmf.h"

#include "plugins/common/frame_data/room.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct hk_xdmf {
  int file;
  off_t end; /* of the frames; the closing lines follow */
  char *h5;
  unsigned bytes;
  char *text;
  size_t length, room;
  bool full; /* no memory for the text */
};

static const char head[] = "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
                           "<Grid Name=\"hooke\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
static const char tail[] = "</Grid>\n</Domain>\n</Xdmf>\n";

static void say(hk_xdmf *x, const char *format, ...) HK_PRINTF(2, 3);

static void say(hk_xdmf *x, const char *format, ...) {
  va_list list;
  va_start(list, format);
  int length = vsnprintf(NULL, 0, format, list);
  va_end(list);
  if (length < 0 || !hk_make_room(&x->text, &x->room, x->length + (size_t)length + 1, 1)) {
    x->full = true;
    return;
  }
  va_start(list, format);
  vsnprintf(x->text + x->length, (size_t)length + 1, format, list);
  va_end(list);
  x->length += (size_t)length;
}

static void say_plain(hk_xdmf *x, const char *text) {
  for (; *text; text++) {
    const char *escape = *text == '&'   ? "&amp;"
                         : *text == '<' ? "&lt;"
                         : *text == '>' ? "&gt;"
                         : *text == '"' ? "&quot;"
                                        : NULL;
    if (escape)
      say(x, "%s", escape);
    else
      say(x, "%c", *text);
  }
}

/* Puts the text over the file's closing lines. */
static bool put_text(hk_xdmf *x, off_t keep) {
  if (x->full) errno = ENOMEM;
  if (x->full) return false;
  for (size_t at = 0; at < x->length;) {
    ssize_t count = pwrite(x->file, x->text + at, x->length - at, x->end + (off_t)at);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    at += (size_t)count;
  }
  x->end += (off_t)x->length - keep;
  x->length = 0;
  return true;
}

/* What the file is called until it is one; a device has its name. */
static char *part_of(const char *path) {
  struct stat info;
  bool device = lstat(path, &info) == 0 && (S_ISCHR(info.st_mode) || S_ISBLK(info.st_mode));
  size_t size = strlen(path) + sizeof ".part";
  char *part = malloc(size);
  if (part) snprintf(part, size, device ? "%s" : "%s.part", path);
  return part;
}

/* Writes the head and gives the file its name. */
static bool begin(hk_xdmf *x, const char *path, const char *part) {
  bool device = strcmp(part, path) == 0;
  if (!device) unlink(part);
  x->file = open(part, O_WRONLY | O_NOFOLLOW | O_CLOEXEC | (device ? 0 : O_CREAT | O_EXCL), 0666);
  say(x, "%s%s", head, tail);
  if (x->file < 0) return false;
  if (put_text(x, (off_t)strlen(tail)) && (device || rename(part, path) == 0)) return true;
  int cause = errno;
  if (!device) unlink(part);
  errno = cause;
  return false;
}

hk_xdmf *hk_xdmf_create(const char *path, const char *h5, unsigned bytes) {
  hk_xdmf *x = calloc(1, sizeof *x);
  char *part = part_of(path);
  if (x) *x = (hk_xdmf){.bytes = bytes, .file = -1, .h5 = strdup(h5)};
  bool fine = x && part && x->h5 && begin(x, path, part);
  int cause = errno;
  free(part);
  if (fine) return x;
  hk_xdmf_close(x);
  errno = cause;
  return NULL;
}

/* Rows [at, at + count) of a dataset; width 0: of numbers without a second dimension. */
static void say_rows(hk_xdmf *x, const char *path, const char *type, unsigned bytes, uint64_t at, uint64_t count,
                     size_t width, uint64_t rows) {
  const char *second = width > 1 ? " " : "";
  char w[24] = "";
  if (width > 1) snprintf(w, sizeof w, "%zu", width);
  say(x, "<DataItem ItemType=\"HyperSlab\" Dimensions=\"%" PRIu64 "%s%s\">\n", count, second, w);
  if (width > 1)
    say(x, "<DataItem Dimensions=\"3 2\" Format=\"XML\">%" PRIu64 " 0 1 1 %" PRIu64 " %zu</DataItem>\n", at, count,
        width);
  else
    say(x, "<DataItem Dimensions=\"3 1\" Format=\"XML\">%" PRIu64 " 1 %" PRIu64 "</DataItem>\n", at, count);
  say(x, "<DataItem Dimensions=\"%" PRIu64 "%s%s\" NumberType=\"%s\" Precision=\"%u\" Format=\"HDF\">", rows, second, w,
      type, bytes);
  say_plain(x, x->h5);
  say(x, ":/");
  say_plain(x, path);
  say(x, "</DataItem>\n</DataItem>\n");
}

static void say_array(hk_xdmf *x, const hk_xdmf_frame *f, const hk_xdmf_array *a) {
  const char *kind = a->width == 1 ? "Scalar" : a->width == 3 ? "Vector" : "Matrix";
  bool id = strcmp(a->name, "id") == 0, pin = strcmp(a->name, "pin") == 0;
  say(x, "<Attribute Name=\"");
  say_plain(x, a->name);
  say(x, "\" AttributeType=\"%s\" Center=\"Node\">\n", kind);
  if (a->fixed)
    say_rows(x, a->path, id ? "UInt" : pin ? "UChar" : "Float", id ? 4 : pin ? 1 : 8, f->fixed, f->n, 0, f->fixed_rows);
  else
    say_rows(x, a->path, "Float", x->bytes, f->points, f->n, a->width, f->points_rows);
  say(x, "</Attribute>\n");
}

static void say_grid(hk_xdmf *x, const hk_xdmf_frame *f, const hk_xdmf_array *array, size_t arrays, const char *name,
                     const char *topology, unsigned nodes, uint64_t at, uint64_t count) {
  if (count == 0) return;
  say(x, "<Grid Name=\"%s\" GridType=\"Uniform\">\n<Time Value=\"%.17g\"/>\n", name, f->t);
  say(x, "<Topology TopologyType=\"%s\" NodesPerElement=\"%u\" NumberOfElements=\"%" PRIu64 "\">\n", topology, nodes,
      count);
  say_rows(x, "VTKHDF/Connectivity", "Int", 8, f->connectivity + at, nodes * count, 0, f->connectivity_rows);
  say(x, "</Topology>\n<Geometry GeometryType=\"XYZ\">\n");
  say_rows(x, "VTKHDF/Points", "Float", x->bytes, f->points, f->n, 3, f->points_rows);
  say(x, "</Geometry>\n");
  for (size_t k = 0; k < arrays; k++) say_array(x, f, &array[k]);
  say(x, "</Grid>\n");
}

bool hk_xdmf_add(hk_xdmf *x, const hk_xdmf_frame *f, const hk_xdmf_array *array, size_t arrays) {
  uint64_t segments = f->vertices, triangles = segments + 2 * f->segments;
  say(x, "<Grid Name=\"frame\" GridType=\"Collection\" CollectionType=\"Spatial\">\n<Time Value=\"%.17g\"/>\n", f->t);
  say_grid(x, f, array, arrays, "particles", "Polyvertex", 1, 0, f->vertices);
  say_grid(x, f, array, arrays, "edges", "Polyline", 2, segments, f->segments);
  say_grid(x, f, array, arrays, "triangles", "Triangle", 3, triangles, f->triangles);
  say(x, "</Grid>\n%s", tail);
  return put_text(x, (off_t)strlen(tail));
}

bool hk_xdmf_close(hk_xdmf *x) {
  if (!x) return true;
  bool fine = x->file < 0 || close(x->file) == 0;
  free(x->h5);
  free(x->text);
  free(x);
  return fine;
}
