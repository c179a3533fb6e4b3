/* scene:mesh{ file = "name.obj" }: vertices become particles, faces become triangles, and their sides become edges.
 * scene:surface{ file = "name.obj" }: the numbers alone, for plugins that take them. Of the Wavefront OBJ format the
 * records v and f are read; f may have texture and normal indices, which are skipped, and negative ones. */
#include "core/builders/builders.h"
#include "core/storage/storage.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct mesh {
  size_t vertices, vertex_capacity, triangles, triangle_capacity;
  double *vertex;          /* vertices x 3 */
  uint32_t (*triangle)[3]; /* from 0 */
  size_t line;
} mesh;

static void clear(mesh *m) {
  free(m->vertex);
  free(m->triangle);
  *m = (mesh){0};
}

/* The mesh is a userdata, so that an error during reading frees it. */
static int mesh_gc(lua_State *L) {
  clear(lua_touserdata(L, 1));
  return 0;
}

static mesh *new_mesh(lua_State *L) {
  mesh *m = lua_newuserdatauv(L, sizeof *m, 0);
  *m = (mesh){0};
  lua_createtable(L, 0, 1);
  lua_pushcfunction(L, mesh_gc);
  lua_setfield(L, -2, "__gc");
  lua_setmetatable(L, -2);
  return m;
}

static bool grow(void *array, size_t *capacity, size_t count, size_t size) {
  void *memory;
  memcpy(&memory, array, sizeof memory);
  if (count < *capacity) return true;
  void *bigger = realloc(memory, (2 * count + 256) * size);
  if (!bigger) return false;
  memcpy(array, &bigger, sizeof bigger);
  *capacity = 2 * count + 256;
  return true;
}

static const char *read_vertex(mesh *m, const char *text) {
  char *end;
  if (!grow(&m->vertex, &m->vertex_capacity, m->vertices, 3 * sizeof *m->vertex)) return "no memory";
  for (int c = 0; c < 3; c++) {
    m->vertex[3 * m->vertices + c] = strtod(text, &end);
    if (end == text) return "a vertex needs three numbers";
    text = end;
  }
  m->vertices++;
  return NULL;
}

static const char *read_face(mesh *m, const char *text) {
  uint32_t corner[3] = {0};
  for (int count = 0;; count++) {
    char *end;
    long index = strtol(text, &end, 10);
    if (end == text) return count < 3 ? "a face needs three corners" : NULL;
    if (index < 0) index += (long)m->vertices + 1;
    if (index < 1 || (size_t)index > m->vertices) return "a face names a vertex that does not exist (yet)";
    text = end + strcspn(end, " \t\r\n");
    if (count > 0 && (uint32_t)index - 1 == corner[count > 1]) return "a face names a vertex twice";
    if (count >= 2) {
      if ((uint32_t)index - 1 == corner[0]) return "a face names a vertex twice";
      if (!grow(&m->triangle, &m->triangle_capacity, m->triangles, sizeof *m->triangle)) return "no memory";
      corner[2] = (uint32_t)index - 1;
      memcpy(m->triangle[m->triangles++], corner, sizeof corner);
      corner[1] = corner[2];
    } else
      corner[count] = (uint32_t)index - 1;
  }
}

static const char *read_file(mesh *m, FILE *file) {
  char line[1024];
  const char *wrong = NULL;
  for (m->line = 1; !wrong && fgets(line, sizeof line, file); m->line++) {
    if (!strchr(line, '\n') && !feof(file)) return "the line is too long";
    if (line[0] == 'v' && isspace((unsigned char)line[1]))
      wrong = read_vertex(m, line + 2);
    else if (line[0] == 'f' && isspace((unsigned char)line[1]))
      wrong = read_face(m, line + 2);
  }
  m->line--;
  if (ferror(file)) return strerror(errno);
  return wrong ? wrong : m->vertices ? NULL : "it has no vertices";
}

/* A side of a triangle, with the lower id first, and the opposite corner. */
typedef struct side {
  uint32_t a, b, opposite;
} side;

static int by_ends(const void *left, const void *right) {
  const side *s = left, *t = right;
  if (s->a != t->a) return s->a < t->a ? -1 : 1;
  if (s->b != t->b) return s->b < t->b ? -1 : 1;
  return (s->opposite > t->opposite) - (s->opposite < t->opposite);
}

/* The sides of all triangles, sorted, as a block on the stack. */
static side *push_sides(lua_State *L, const mesh *m, uint32_t first) {
  side *list = lua_newuserdatauv(L, (3 * m->triangles + 1) * sizeof *list, 0);
  for (size_t k = 0; k < 3 * m->triangles; k++) {
    const uint32_t *corner = m->triangle[k / 3];
    uint32_t a = corner[k % 3], b = corner[(k + 1) % 3], c = corner[(k + 2) % 3];
    list[k] = (side){first + (a < b ? a : b), first + (a < b ? b : a), first + c};
  }
  qsort(list, 3 * m->triangles, sizeof *list, by_ends);
  return list;
}

/* Pushes each side once, or, for flexion, the pairs of corners opposite to a common side. */
static hk_lua_edges *push_pairs(lua_State *L, const side *list, size_t sides, bool facing) {
  hk_lua_edges *edges = hk_lua_new_edges(L, sides); /* upper bound of the number */
  edges->count = 0;
  for (size_t k = 0; k < sides; k++) {
    bool again = k > 0 && list[k].a == list[k - 1].a && list[k].b == list[k - 1].b;
    if (again != facing || (again && list[k].opposite == list[k - 1].opposite)) continue;
    uint32_t *pair = edges->pair[edges->count++];
    pair[0] = facing ? list[k - 1].opposite : list[k].a;
    pair[1] = facing ? list[k].opposite : list[k].b;
  }
  return edges;
}

static void push_triangles(lua_State *L, const mesh *m) {
  lua_createtable(L, (int)m->triangles, 0);
  for (size_t t = 0; t < m->triangles; t++) {
    lua_createtable(L, 3, 0);
    for (int c = 0; c < 3; c++) {
      lua_pushinteger(L, m->triangle[t][c]);
      lua_rawseti(L, -2, c + 1);
    }
    lua_rawseti(L, -2, (lua_Integer)t + 1);
  }
}

/* Bytes that the numbers of a file take, at most, per byte of its text: "v 0 0 0" is 24, in arrays that double. */
enum { NUMBERS = 6 };

static void load(lua_State *L, mesh *m, const char *name) {
  const char *folder = hk_lua_script(L)->folder, *folders[3];
  const char *path = *name == '/' ? name : lua_pushfstring(L, "%s/%s", folder, name);
  FILE *file = hk_file_read(path, hk_lua_readable(hk_lua_script(L), folders));
  if (!file) hk_lua_fail(L, HK_IO, "mesh: cannot read %s: %s", path, hk_file_reason(errno));
  struct stat info = {0};
  if (fstat(fileno(file), &info) != 0 || (double)info.st_size * NUMBERS > (double)hk_lua_script(L)->memory_limit) {
    fclose(file);
    hk_lua_fail(L, HK_IO, "mesh: %s: the file is larger than the script's memory", name);
  }
  const char *wrong = read_file(m, file);
  fclose(file);
  hk_lua_note_file(L, "the mesh", path, name);
  if (wrong) hk_lua_fail(L, HK_IO, "mesh: %s:%d: %s", name, (int)m->line, wrong);
}

int hk_build_mesh(lua_State *L) {
  static const char *const keys[] = {"file", "mass", "scale", "origin", "group", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_error error = {0};
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "mesh", keys);
  if (hk_lua_field(L, 2, "file") != LUA_TSTRING)
    return hk_lua_fail(L, HK_BAD_PARAM, "mesh: file is required, an OBJ file");
  mesh *m = new_mesh(L);
  load(L, m, lua_tostring(L, 3));
  double scale = hk_lua_field_number(L, 2, "mesh", "scale", 1), mass = hk_lua_field_number(L, 2, "mesh", "mass", 1),
         origin[3] = {0};
  hk_lua_field_vector(L, 2, "mesh", "origin", origin);
  for (size_t k = 0; k < 3 * m->vertices; k++) m->vertex[k] = origin[k % 3] + scale * m->vertex[k];
  hk_lua_handle h = {0, (uint32_t)m->vertices, (uint32_t)m->vertices, 1, false, false};
  h.first = hk_lua_add(L, scene, "mesh", m->vertices, m->vertex, NULL, NULL, mass / (double)m->vertices,
                       hk_lua_group(L, scene, 2, "mesh"));
  hk_lua_push_handle(L, h);
  int handle = lua_gettop(L);
  const side *list = push_sides(L, m, h.first);
  const hk_lua_edges *edges = push_pairs(L, list, 3 * m->triangles, false);
  hk_limits_take(L, edges->count * sizeof *edges->pair + m->triangles * sizeof *m->triangle);
  hk_status status = hk_scene_add_edges(scene, edges->count, (const uint32_t(*)[2])edges->pair, &error);
  lua_setiuservalue(L, handle, 1);
  push_pairs(L, list, 3 * m->triangles, true);
  lua_setiuservalue(L, handle, 3);
  lua_settop(L, handle);
  for (size_t k = 0; k < 3 * m->triangles; k++) m->triangle[k / 3][k % 3] += h.first;
  if (status == HK_OK) status = hk_scene_add_triangles(scene, m->triangles, (const uint32_t(*)[3])m->triangle, &error);
  if (status != HK_OK) return hk_lua_raise(L, &error);
  push_triangles(L, m);
  lua_setiuservalue(L, -2, 2);
  clear(m);
  return 1;
}

static void push_corners(lua_State *L, const mesh *m) {
  lua_createtable(L, (int)(3 * m->triangles), 0);
  for (size_t k = 0; k < 3 * m->triangles; k++) {
    lua_pushinteger(L, (lua_Integer)m->triangle[k / 3][k % 3] + 1);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

/* { vertices = { x1, y1, z1, x2, ... }, faces = { three vertices a triangle, from 1 }, file = } */
int hk_build_surface(lua_State *L) {
  static const char *const keys[] = {"file", "scale", "origin", NULL};
  hk_lua_scene(L, 1);
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "surface", keys);
  if (hk_lua_field(L, 2, "file") != LUA_TSTRING)
    return hk_lua_fail(L, HK_BAD_PARAM, "surface: file is required, an OBJ file");
  mesh *m = new_mesh(L);
  load(L, m, lua_tostring(L, 3));
  double scale = hk_lua_field_number(L, 2, "surface", "scale", 1), origin[3] = {0};
  hk_lua_field_vector(L, 2, "surface", "origin", origin);
  lua_createtable(L, 0, 3);
  lua_pushvalue(L, 3);
  lua_setfield(L, -2, "file");
  lua_createtable(L, (int)(3 * m->vertices), 0);
  for (size_t k = 0; k < 3 * m->vertices; k++) {
    lua_pushnumber(L, origin[k % 3] + scale * m->vertex[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, -2, "vertices");
  push_corners(L, m);
  lua_setfield(L, -2, "faces");
  clear(m);
  return 1;
}
