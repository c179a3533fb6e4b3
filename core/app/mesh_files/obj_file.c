/* Wavefront OBJ files. The records v and f are read, the others skipped. A corner of a face is the number of a vertex,
 * from 1, or from the last one back if it is negative; texture and normal indices behind slashes are skipped. Memory is
 * bounded by the longest record, and for the numbers by the script's limit; errors name the line in which the record
 * begins. */
#include "core/app/mesh_files/mesh_files.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBERS = 6 }; /* bytes that numbers take, at most, per byte of text: "v 0 0 0" is 24, in arrays that double */

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

static const char *read_obj(hk_records *r, hk_mesh *m) {
  const char *wrong = NULL;
  while (!wrong && hk_records_next(r, &wrong)) {
    const char *text = r->record;
    if (text[0] == 'v' && isspace((unsigned char)text[1]))
      wrong = read_vertex(m, text + 2);
    else if (text[0] == 'f' && isspace((unsigned char)text[1]))
      wrong = read_face(m, text + 2);
  }
  return wrong ? wrong : m->vertices ? NULL : "it has no vertices";
}

void hk_mesh_read(lua_State *L, hk_mesh *m, const char *what, const char *name,
                  const char *(*read)(hk_records *, hk_mesh *)) {
  hk_script *script = hk_lua_script(L);
  const char *folders[3], *path = *name == '/' ? name : lua_pushfstring(L, "%s/%s", script->folder, name);
  hk_records *r = lua_newuserdatauv(L, sizeof *r, 0);
  FILE *file = hk_file_read(path, hk_lua_readable(script, folders));
  if (!file) hk_lua_fail(L, HK_IO, "%s: cannot read %s: %s", what, path, hk_file_reason(errno));
  hk_records_begin(r, file, script->memory_limit / NUMBERS);
  const char *wrong = read(r, m);
  fclose(file);
  hk_lua_note_file(L, "the mesh", path, name);
  if (wrong) hk_lua_fail(L, HK_IO, "%s: %s:%d: %s", what, name, (int)r->line, wrong);
}

void hk_mesh_load(lua_State *L, hk_mesh *m, const char *what, const char *name) {
  hk_mesh_read(L, m, what, name, read_obj);
}
