/* Files of one frame each, which other programs read: a sequence of them is a motion. And files that are written whole
 * or not at all, which all formats are. */
#ifndef HK_SEQUENCE_FORMATS_H
#define HK_SEQUENCE_FORMATS_H

#include "plugins/common/frame_data/frame_data.h"

#include <limits.h>
#include <stdio.h>

typedef struct hk_sequence_format {
  const char *name;                             /* "ply"; also the ending of its files */
  void (*write)(FILE *, const hk_frame_data *); /* errors are the stream's */
} hk_sequence_format;

extern const hk_sequence_format hk_sequence_ply, hk_sequence_obj, hk_sequence_vtk;

/* Writes the file. False with a sentence in `why`. */
bool hk_sequence_write(const hk_sequence_format *, const hk_frame_data *, const char *path, char *why, size_t size);

/* A file that has another name, PATH.part, until it is whole. What has the name already, a link or a pipe perhaps, is
 * neither followed nor written to: it makes room. A zeroed one may be closed. */
typedef struct hk_whole_file {
  FILE *stream; /* NULL: not open */
  int cause;    /* errno of the first write that failed */
  char path[PATH_MAX], part[PATH_MAX + 8];
} hk_whole_file;

/* False with a sentence in `why`. */
bool hk_whole_open(hk_whole_file *, const char *path, char *why, size_t size);
/* False, with the sentence of the C library for `cause`, an errno, in `why`. */
bool hk_whole_failed(int cause, char *why, size_t size);
/* After some writes, before anything else is called that sets errno: whether all went well. */
bool hk_whole_check(hk_whole_file *);
/* `keep`: under its name; otherwise, or where a write failed, there is no file. False: it failed, with a sentence in
 * `why`. */
bool hk_whole_close(hk_whole_file *, bool keep, char *why, size_t size);

/* The middle of the box about the particles; returns its diagonal, m. Both 0 without any. */
double hk_frame_middle(const hk_frame_data *, double middle[3]);

#endif
