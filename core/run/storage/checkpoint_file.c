/* The file of a checkpoint: it begins with a line that names it and its version, the words of the command line and
 * where its scene is from, and ends with a checksum. What is damaged is not gone on from. */
#include "core/run/storage/walk.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

const char hk_checkpoint_magic[] = "hooke checkpoint 9\n";

bool hk_checkpoint_put_text(hk_walk *w, const char *text, size_t bytes) {
  uint64_t length = bytes;
  return hk_walk_put(w, &length, sizeof length) && hk_walk_put(w, text, bytes);
}

/* The length of a list of words, each with its 0, that an empty one ends. */
static size_t list_length(const char *words) {
  const char *end = words;
  while (end && *end) end += strlen(end) + 1;
  return words ? (size_t)(end - words) + 1 : 0;
}

bool hk_checkpoint_begin(hk_walk *w, const char *words, const char *origin) {
  return hk_walk_put(w, hk_checkpoint_magic, strlen(hk_checkpoint_magic)) &&
         hk_checkpoint_put_text(w, words, list_length(words)) &&
         hk_checkpoint_put_text(w, origin, origin ? strlen(origin) + 1 : 0);
}

static bool body(FILE *file, const void *what) {
  const hk_checkpoint *c = what;
  return fwrite(c->byte, 1, c->count, file) == c->count;
}

hk_status hk_checkpoint_write(const hk_checkpoint *c, const char *path, hk_error *error) {
  return hk_write_file(path, body, c, error);
}

void hk_checkpoint_free(hk_checkpoint *c) {
  free(c->byte);
  *c = (hk_checkpoint){0};
}

hk_status hk_checkpoint_damaged(hk_error *error, const char *path) {
  return hk_error_set(error, HK_IO, "%s is cut short or damaged: it cannot be gone on from", path);
}

/* The text at the walk, in the checkpoint's own memory; NULL: an empty one. False: it is damaged. */
static bool read_text(hk_walk *w, const char **text) {
  uint64_t length = 0;
  if (!hk_walk_get(w, &length, sizeof length) || length > w->left) return false;
  *text = length ? (const char *)w->at : NULL;
  return (length == 0 || w->at[length - 1] == 0) && hk_walk_skip(w, (size_t)length);
}

/* A list of words, which an empty one ends. */
static bool read_list(hk_walk *w, const char **words) {
  return read_text(w, words) && (!*words || (const char *)w->at == *words + 1 || w->at[-2] == 0);
}

hk_status hk_checkpoint_open(hk_checkpoint *c, hk_walk *w, const char *path, const char **words, const char **origin,
                             hk_error *error) {
  size_t first = strlen(hk_checkpoint_magic);
  errno = 0;
  if (!hk_walk_read_file(c, path)) return hk_io_error(error, "read", path);
  if (c->count < first || memcmp(c->byte, hk_checkpoint_magic, first - 2) != 0 || c->byte[first - 1] != '\n')
    return hk_error_set(error, HK_IO, "%s is no checkpoint, such as scene:output(\"checkpoint\") writes", path);
  if (c->byte[first - 2] != hk_checkpoint_magic[first - 2])
    return hk_error_set(error, HK_IO, "%s is a checkpoint of another version of hooke: write it again", path);
  if (!hk_walk_open(w, c, first) || !read_list(w, words) || !read_text(w, origin))
    return hk_checkpoint_damaged(error, path);
  return HK_OK;
}

hk_status hk_checkpoint_words(const char *path, char **words, hk_error *error) {
  hk_checkpoint c = {0};
  hk_walk w;
  const char *found = NULL, *origin = NULL;
  *words = NULL;
  hk_status status = hk_checkpoint_open(&c, &w, path, &found, &origin, error);
  size_t length = status == HK_OK ? list_length(found) : 0;
  if (status == HK_OK && length == 0)
    status = hk_error_set(error, HK_BAD_PARAM, "%s was not written by hooke run: name its scene", path);
  if (status == HK_OK && !(*words = malloc(length)))
    status = hk_error_set(error, HK_NO_MEMORY, "no memory for the words of %s", path);
  if (status == HK_OK) memcpy(*words, found, length);
  hk_checkpoint_free(&c);
  return status;
}
