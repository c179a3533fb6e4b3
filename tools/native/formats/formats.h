/* Files of one frame each, which other programs read: a sequence of them is a motion. */
#ifndef HK_SEQUENCE_FORMATS_H
#define HK_SEQUENCE_FORMATS_H

#include "plugins/common/frame_data/frame_data.h"

#include <stdio.h>

typedef struct hk_sequence_format {
  const char *name;                             /* "ply"; also the ending of its files */
  void (*write)(FILE *, const hk_frame_data *); /* errors are the stream's */
} hk_sequence_format;

extern const hk_sequence_format hk_sequence_ply, hk_sequence_obj, hk_sequence_vtk;

/* Writes the file, past no link. False with a sentence in `why`. */
bool hk_sequence_write(const hk_sequence_format *, const hk_frame_data *, const char *path, char *why, size_t size);

/* Opens a file to be written, past no link; NULL with errno. Closing it tells whether all is written. */
FILE *hk_sequence_file(const char *path, const char *mode);
bool hk_sequence_file_close(FILE *, char *why, size_t size);

#endif
