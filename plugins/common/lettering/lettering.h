/* Texts as strokes, in a plain font of polylines whose bends are rounded. Lengths are in units of the glyphs' grid:
 * capitals are 6 high, small letters 4, what goes below the line 2; a digit is 4 wide, and 2 are between neighbours. */
#ifndef HK_LETTERING_H
#define HK_LETTERING_H

#include <stdbool.h>
#include <stddef.h>

typedef struct hk_letter_stroke {
  double a[2], b[2]; /* its ends, right and up from the left end of the text on the line; the same: a dot */
} hk_letter_stroke;

enum { HK_LETTER_HEIGHT = 6 };

/* Fills in the strokes of a text in UTF-8, `room` of them at most, and its width; returns how many there are. Known is
 * what ASCII has, and a few signs of units (² ³ · ° µ × ≤ ≥ −); all else is a box. */
size_t hk_letters(const char *text, hk_letter_stroke *stroke, size_t room, double *width);
/* The same of a number as printf's %g writes it, but with raised digits for a power of ten: 1.5e-07 as 1.5 · 10 to the
 * -7. It is wider by 3 at most than digits in the number of the text's letters. */
size_t hk_letters_of_number(const char *text, hk_letter_stroke *stroke, size_t room, double *width);

#endif
