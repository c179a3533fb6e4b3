/* What a scene was made from, as text: a line for each script, module, mesh, parameter and plugin, "what<TAB>value",
 * the value of a file being a hash of its bytes. Two of them tell what has changed. */
#include "core/engine/base/base.h"
#include "core/scene/scene/scene.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool hk_origin_add(char **text, const char *what, const char *value) {
  size_t before = *text ? strlen(*text) : 0, room = before + strlen(what) + strlen(value) + 3;
  char *grown = realloc(*text, room);
  if (!grown) return false;
  *text = grown;
  snprintf(grown + before, room - before, "%s\t%s\n", what, value);
  for (char *c = grown + before; c < grown + room - 2; c++) /* the value stays on its line */
    if (*c == '\n') *c = ' ';
  return true;
}

/* FNV-1a, 64 bits. */
static const uint64_t hash_of_nothing = 1469598103934665603u;

static uint64_t hash_on(uint64_t hash, const char *bytes, size_t count) {
  for (size_t k = 0; k < count; k++) hash = (hash ^ (unsigned char)bytes[k]) * 1099511628211u;
  return hash;
}

static bool hash_of(int file, uint64_t *hash) {
  char block[1 << 14];
  ssize_t got;
  *hash = hash_of_nothing;
  while ((got = read(file, block, sizeof block)) > 0) *hash = hash_on(*hash, block, (size_t)got);
  return got == 0;
}

static bool add_hash(char **text, const char *what, uint64_t hash) {
  char value[32];
  snprintf(value, sizeof value, "#%016llx", (unsigned long long)hash);
  return hk_origin_add(text, what, value);
}

bool hk_origin_add_text(char **text, const char *what, const char *content) {
  return add_hash(text, what, hash_on(hash_of_nothing, content, strlen(content)));
}

/* A pipe or a device, which may block or never end, is not read: what came from it is not known again. */
bool hk_origin_add_file(char **text, const char *what, const char *path) {
  struct stat info;
  uint64_t hash;
  int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  bool plain = file >= 0 && fstat(file, &info) == 0 && S_ISREG(info.st_mode), known = plain && hash_of(file, &hash);
  int cause = errno;
  if (file >= 0) close(file);
  if (!known) return hk_origin_add(text, what, file >= 0 && !plain ? "not a plain file" : strerror(cause));
  return add_hash(text, what, hash);
}

static size_t name_length(const char *line) { return strcspn(line, "\t\n"); }

/* The value of the line of that name, or NULL. */
static const char *find(const char *text, const char *name, size_t length) {
  for (const char *line = text; line && *line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL)
    if (name_length(line) == length && line[length] == '\t' && strncmp(line, name, length) == 0)
      return line + length + 1;
  return NULL;
}

static bool compare(const char *line, const char *other, char *sentence, size_t size) {
  size_t length = name_length(line);
  if (line[length] != '\t') return true;
  const char *value = line + length + 1, *found = find(other, line, length);
  int name = (int)length, then = (int)strcspn(value, "\n"), now = found ? (int)strcspn(found, "\n") : 0;
  if (found && then == now && strncmp(value, found, (size_t)then) == 0) return true;
  if (!found)
    snprintf(sentence, size, "%.*s is no longer part of it", name, line);
  else if (*value == '#')
    snprintf(sentence, size, "%.*s has changed", name, line);
  else
    snprintf(sentence, size, "%.*s was %.*s and is %.*s", name, line, then, value, now, found);
  return false;
}

/* Whether the line is that of a parameter among those. */
static bool is_parameter_of(const char *line, size_t count, const char *const *change) {
  static const char parameter[] = "the parameter ";
  size_t before = sizeof parameter - 1, length = name_length(line);
  if (length <= before || strncmp(line, parameter, before) != 0) return false;
  for (size_t k = 0; k < count; k++)
    if (strcspn(change[k], "=") == length - before && strncmp(line + before, change[k], length - before) == 0)
      return true;
  return false;
}

bool hk_origin_same(const char *then, const char *now, hk_origin_changes *changes, char *sentence, size_t size) {
  size_t used = 0;
  if (changes) *changes->said = 0;
  for (const char *line = then; line && *line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL) {
    if (compare(line, now, sentence, size)) continue;
    if (!changes || !is_parameter_of(line, changes->count, changes->change)) return false;
    int more = snprintf(changes->said + used, sizeof changes->said - used, "%s%s", used ? "; " : "", sentence);
    used = used + (size_t)more < sizeof changes->said ? used + (size_t)more : sizeof changes->said - 1;
  }
  for (const char *line = now; line && *line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL)
    if (!find(then, line, name_length(line))) {
      snprintf(sentence, size, "%.*s is new", (int)name_length(line), line);
      return false;
    }
  return true;
}
