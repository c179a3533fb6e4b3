/* Wavefront OBJ files. The records v and f are read, the others skipped. A corner of a face is the number of a vertex,
 * from 1, or from the last one back if it is negative; texture and normal indices behind slashes are skipped. A record
 * goes on in the next line where its last character is a backslash. Memory is bounded by the longest record, and for
 * the numbers by the script's limit; errors name the line in which the record begins. */
#include "core/builders/obj_file.h"
#include "core/storage/storage.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  LONGEST = 1 << 14, /* characters of a record, its lines together */
  NUMBERS = 6        /* bytes that numbers take, at most, per byte of text: "v 0 0 0" is 24, in arrays that double */
};

typedef struct reader {
  FILE *file;
  size_t line, lines; /* in which the record begins, and behind it */
  size_t read, most;  /* characters, and how many are allowed */
  char record[LONGEST];
} reader;

/* Ends a line of the record; false: the next one belongs to it as well. */
static bool end_line(reader *r, size_t *length) {
  r->lines++;
  if (*length > 0 && r->record[*length - 1] == '\r') --*length;
  bool more = *length > 0 && r->record[*length - 1] == '\\';
  *length -= more;
  r->record[*length] = 0;
  return !more;
}

/* Reads the next record; false: there is none, or *wrong. */
static bool next_record(reader *r, const char **wrong) {
  size_t length = 0;
  int c;
  r->line = r->lines + 1;
  while ((c = getc(r->file)) != EOF && !*wrong) {
    if (c == '\n') {
      if (end_line(r, &length)) return true;
    } else if (c == 0)
      *wrong = "the line has a zero byte: this is no text";
    else if (++r->read > r->most)
      *wrong = "the file is larger than the script's memory";
    else if (length > 0 && r->record[0] == '#')
      continue;
    else if (length + 1 == LONGEST)
      *wrong = "the line is longer than 16383 characters";
    else
      r->record[length++] = (char)c;
  }
  if (ferror(r->file)) *wrong = strerror(errno);
  if (length > 0 && !*wrong) end_line(r, &length);
  return length > 0 && !*wrong;
}

static const char *read_vertex(hk_mesh *m, const char *text) {
  double x[3];
  for (int c = 0; c < 3; c++) {
    char *end;
    x[c] = strtod(text, &end);
    if (end == text || !isfinite(x[c])) return "a vertex needs three numbers";
    text = end;
  }
  return hk_mesh_add_vertex(m, x);
}

/* Reads a corner; false: there is none. */
static bool read_corner(const hk_mesh *m, const char **text, uint32_t *corner, const char **wrong) {
  char *end;
  long index = strtol(*text, &end, 10);
  if (end == *text) {
    if ((*text)[strspn(*text, " \t")]) *wrong = "a face has a corner that is no whole number";
    return false;
  }
  if (*end && !strchr(" \t/", *end)) *wrong = "a face has a corner that is no whole number";
  if (index < 0) index += (long)m->vertices + 1;
  if (index < 1 || (size_t)index > m->vertices) *wrong = "a face names a vertex that does not exist (yet)";
  *corner = (uint32_t)index - 1;
  *text = end + strcspn(end, " \t");
  return !*wrong;
}

static const char *read_face(hk_mesh *m, const char *text) {
  uint32_t corner[HK_FACE_CORNERS + 1];
  const char *wrong = NULL;
  size_t count = 0;
  while (count <= HK_FACE_CORNERS && read_corner(m, &text, &corner[count], &wrong)) count++;
  return wrong ? wrong : hk_mesh_add_face(m, corner, count);
}

static const char *read_file(reader *r, hk_mesh *m) {
  const char *wrong = NULL;
  while (!wrong && next_record(r, &wrong)) {
    const char *text = r->record;
    if (text[0] == 'v' && isspace((unsigned char)text[1]))
      wrong = read_vertex(m, text + 2);
    else if (text[0] == 'f' && isspace((unsigned char)text[1]))
      wrong = read_face(m, text + 2);
  }
  return wrong ? wrong : m->vertices ? NULL : "it has no vertices";
}

void hk_mesh_load(lua_State *L, hk_mesh *m, const char *what, const char *name) {
  hk_script *script = hk_lua_script(L);
  const char *folders[3], *path = *name == '/' ? name : lua_pushfstring(L, "%s/%s", script->folder, name);
  reader *r = lua_newuserdatauv(L, sizeof *r, 0);
  FILE *file = hk_file_read(path, hk_lua_readable(script, folders));
  if (!file) hk_lua_fail(L, HK_IO, "%s: cannot read %s: %s", what, path, hk_file_reason(errno));
  r->file = file, r->lines = r->line = r->read = 0, r->most = script->memory_limit / NUMBERS;
  const char *wrong = read_file(r, m);
  fclose(file);
  hk_lua_note_file(L, "the mesh", path, name);
  if (wrong) hk_lua_fail(L, HK_IO, "%s: %s:%d: %s", what, name, (int)r->line, wrong);
}
