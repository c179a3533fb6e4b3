/* Sheets of triangles for the tests of forces that bend surfaces. */
#ifndef HK_TEST_SHEETS_H
#define HK_TEST_SHEETS_H

#include "tests/support/engine.h"

typedef enum sheet_kind {
  SHEET_ONE_WAY,     /* squares, all diagonals along x = y */
  SHEET_ALTERNATING, /* squares, diagonals from cell to cell the other way */
  SHEET_EQUILATERAL,
  SHEET_IRREGULAR /* squares whose inner corners are displaced by up to 0.3 of a side, with the shorter diagonal */
} sheet_kind;

typedef struct sheet {
  size_t particles, triangles;
  double (*x)[3], area;
  uint32_t *corner; /* ids: triangles x 3 */
} sheet;

/* cells x cells squares of side 1/cells from the origin, or rows of as many equilateral triangles of that side, every
 * other row shifted; z = (xx x^2 + yy y^2)/2 + xy x y with h = {xx, xy, yy}. */
sheet sheet_make(sheet_kind, size_t cells, const double h[3]);
void sheet_free(sheet *);
/* Adds the particles, of mass 1, and the force with its triangles; other parameters are to be set. */
hk_plugin_spec *sheet_add(test_engine *, const sheet *, const char *force);

#endif
