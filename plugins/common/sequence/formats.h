/* Files of one shot each, which other programs read: a sequence of them is a motion. */
#ifndef HK_SHOT_FORMATS_H
#define HK_SHOT_FORMATS_H

#include "plugins/common/shot/shot.h"

#include <stdio.h>

typedef struct hk_shot_format {
  const char *name;                       /* "ply"; also the ending of its files */
  void (*write)(FILE *, const hk_shot *); /* errors are the stream's */
} hk_shot_format;

extern const hk_shot_format hk_shot_ply, hk_shot_obj, hk_shot_vtk;

/* Writes the file, past no link. False with a sentence in `why`. */
bool hk_shot_write(const hk_shot_format *, const hk_shot *, const char *path, char *why, size_t size);

/* Opens a file to be written, past no link; NULL with errno. Closing it tells whether all is written. */
FILE *hk_shot_file(const char *path, const char *mode);
bool hk_shot_file_close(FILE *, char *why, size_t size);

#endif
