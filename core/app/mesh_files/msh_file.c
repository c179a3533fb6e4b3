/* The tetrahedra of Gmsh's text format MSH, version 2.2: lines `number x y z` of the section $Nodes, and of $Elements
 * lines `number type tags tag ... node ...`, type 4 for tetrahedra. Elements of fewer dimensions are skipped, other
 * solids refused; nodes that no tetrahedron has are left out, since Gmsh writes those that drawings need as well.
 * https://gmsh.info/doc/texinfo/gmsh.html, Legacy formats. */
#include "core/app/mesh_files/mesh_files.h"

#include <stdlib.h>
#include <string.h>

typedef struct nodes {
  size_t capacity;
  long *number; /* of the vertices, rising */
} nodes;

enum { OTHER, FORMAT, NODES, ELEMENTS }; /* sections */

/* Whether elements of that type have fewer than three dimensions: points, lines, triangles, quadrangles. */
static bool is_skipped(long type) {
  static const long FLAT[] = {1, 2, 3, 8, 9, 10, 15, 16, 20, 21, 22, 23, 24, 25, 26, 27, 28};
  for (size_t k = 0; k < sizeof FLAT / sizeof *FLAT; k++)
    if (type == FLAT[k]) return true;
  return false;
}

static bool read_whole(const char **text, long *value) {
  char *end;
  *value = strtol(*text, &end, 10);
  if (end == *text || (*end && !strchr(" \t", *end))) return false;
  *text = end;
  return true;
}

static const char *read_node(hk_mesh *m, nodes *n, const char *text) {
  long number;
  double x[3];
  if (!read_whole(&text, &number)) return "a node needs a number and three coordinates";
  for (int c = 0; c < 3; c++) {
    char *end;
    x[c] = strtod(text, &end);
    if (end == text || !isfinite(x[c])) return "a node needs a number and three coordinates";
    text = end;
  }
  if (m->vertices > 0 && number <= n->number[m->vertices - 1]) return "the numbers of nodes have to rise";
  if (!hk_mesh_grow(&n->number, &n->capacity, m->vertices + 1, sizeof *n->number)) return "no memory";
  n->number[m->vertices] = number;
  return hk_mesh_add_vertex(m, x);
}

/* The vertex of a node's number; m->vertices: there is none. */
static size_t find_node(const hk_mesh *m, const nodes *n, long number) {
  size_t low = 0, high = m->vertices;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (n->number[middle] < number)
      low = middle + 1;
    else
      high = middle;
  }
  return low < m->vertices && n->number[low] == number ? low : m->vertices;
}

static const char *read_element(hk_mesh *m, const nodes *n, const char *text) {
  long number, type, tags, tag, node;
  uint32_t corner[4];
  if (!read_whole(&text, &number) || !read_whole(&text, &type) || !read_whole(&text, &tags) || tags < 0)
    return "an element needs a number, a type and the number of its tags";
  if (is_skipped(type)) return NULL;
  if (type != 4) return "a solid that is no tetrahedron of four nodes: mesh it with those of first order";
  for (; tags > 0; tags--)
    if (!read_whole(&text, &tag)) return "an element has fewer tags than it says";
  for (int k = 0; k < 4; k++) {
    if (!read_whole(&text, &node)) return "a tetrahedron needs four nodes";
    size_t vertex = find_node(m, n, node);
    if (vertex == m->vertices) return "a tetrahedron names a node that does not exist";
    corner[k] = (uint32_t)vertex;
  }
  return hk_mesh_add_tetrahedron(m, corner);
}

static const char *read_format(const char *text) {
  char *end;
  double version = strtod(text, &end);
  if (!(version >= 2 && version < 3)) return "expected version 2.2 of the format: save it with `gmsh -format msh22`";
  return strtol(end, NULL, 10) == 0 ? NULL : "the file is binary: save it as text";
}

typedef struct reader {
  nodes nodes;
  int section;
  long left; /* records of the section that are still to come; -1: the line that counts them is */
} reader;

static const char *begin_section(reader *r, const char *name) {
  static const char *const NAMES[] = {"", "$MeshFormat", "$Nodes", "$Elements"};
  if ((r->section == NODES || r->section == ELEMENTS) && r->left != 0)
    return "the section has not as many records as it says";
  r->section = OTHER;
  for (int k = FORMAT; k <= ELEMENTS; k++)
    if (strcmp(name, NAMES[k]) == 0) r->section = k;
  r->left = -1;
  return NULL;
}

static const char *read_record(reader *r, hk_mesh *m, const char *text) {
  if (text[0] == '$') return begin_section(r, text);
  if (r->section == OTHER || text[0] == 0) return NULL;
  if (r->section == FORMAT) return read_format(text);
  if (r->left == -1) return read_whole(&text, &r->left) && r->left >= 0 ? NULL : "expected the number of records";
  if (r->left-- == 0) return "the section has more records than it says";
  return r->section == NODES ? read_node(m, &r->nodes, text) : read_element(m, &r->nodes, text);
}

static const char *read_msh(hk_records *records, hk_mesh *m) {
  reader r = {.section = OTHER};
  const char *wrong = NULL;
  while (!wrong && hk_records_next(records, &wrong)) wrong = read_record(&r, m, records->record);
  if (!wrong) wrong = begin_section(&r, "");
  free(r.nodes.number);
  if (wrong) return wrong;
  return m->tetrahedra == 0 ? "it has no tetrahedra" : hk_mesh_drop_loose(m);
}

void hk_mesh_load_msh(lua_State *L, hk_mesh *m, const char *what, const char *name) {
  hk_mesh_read(L, m, what, name, read_msh);
}
