#include "plugins/common/lettering/lettering.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

/* A glyph is polylines on a grid of 5 x 9 points: "xy xy xy  xy xy", baseline at y = 2, capitals up to 8. */
static const char *const digit[] = {"12 32 43 47 38 18 07 03 12",
                                    "07 28 22  12 32",
                                    "07 18 38 47 46 02 42",
                                    "07 18 38 47 46 35 15  35 44 43 32 12 03",
                                    "32 38 04 44",
                                    "48 08 05 35 44 43 32 12 03",
                                    "47 38 18 07 03 12 32 43 44 35 15 04",
                                    "08 48 22",
                                    "15 06 07 18 38 47 46 35 15 04 03 12 32 43 44 35",
                                    "03 12 32 43 47 38 18 07 06 15 35 46"};
static const char *const letter[] = {"06 36 45 42  44 14 03 12 32 43",
                                     "08 02 32 43 45 36 06",
                                     "46 16 05 03 12 42",
                                     "48 42 12 03 05 16 46",
                                     "04 44 45 36 16 05 03 12 32",
                                     "12 17 28 38  06 36",
                                     "46 16 05 03 12 42  46 41 30 10",
                                     "08 02  05 16 36 45 42",
                                     "22 26  28 28",
                                     "26 21 10  28 28",
                                     "08 02  46 04 42",
                                     "28 23 32",
                                     "02 06  05 16 25 22  25 36 45 42",
                                     "02 06  05 16 36 45 42",
                                     "12 32 43 45 36 16 05 03 12",
                                     "00 06 36 45 43 32 02",
                                     "40 46 16 05 03 12 42",
                                     "02 06  05 16 36",
                                     "46 16 05 14 34 43 32 02",
                                     "18 13 22 32  06 36",
                                     "06 03 12 32 43  46 42",
                                     "06 22 46",
                                     "06 12 25 32 46",
                                     "06 42  02 46",
                                     "06 22  46 00",
                                     "06 46 02 42"};
static const char *const capital[] = {"02 28 42  14 34",
                                      "02 08 38 47 46 35 44 43 32 02  05 35",
                                      "47 38 18 07 03 12 32 43",
                                      "02 08 28 46 44 22 02",
                                      "48 08 02 42  05 35",
                                      "48 08 02  05 35",
                                      "47 38 18 07 03 12 32 43 45 25",
                                      "08 02  48 42  05 45",
                                      "18 38  28 22  12 32",
                                      "48 43 32 12 03",
                                      "08 02  48 04  15 42",
                                      "08 02 42",
                                      "02 08 25 48 42",
                                      "02 08 42 48",
                                      "22 43 47 28 07 03 22",
                                      "02 08 38 47 46 35 05",
                                      "12 32 43 47 38 18 07 03 12  24 42",
                                      "02 08 38 47 46 35 05  25 42",
                                      "47 38 18 07 06 15 35 44 43 32 12 03",
                                      "08 48  28 22",
                                      "08 03 12 32 43 48",
                                      "08 22 48",
                                      "08 12 25 32 48",
                                      "02 48  08 42",
                                      "08 25 48  25 22",
                                      "08 48 02 42"};

/* What is no letter and no digit, in UTF-8. */
static const struct {
  const char *character, *glyph;
} sign[] = {{"-", "05 45"},
            {"\u2212", "05 45"},
            {"\u2013", "05 45"},
            {"+", "05 45  23 27"},
            {".", "12 22 23 13 12"},
            {",", "23 13 12 22 23 21 10"},
            {":", "13 12 22 23 13  15 16 26 25 15"},
            {";", "23 13 12 22 23 21 10  15 16 26 25 15"},
            {"%", "02 48  08 18 17 07 08  32 42 43 33 32"},
            {"/", "02 48"},
            {"\\", "08 42"},
            {"|", "20 28"},
            {"_", "01 41"},
            {"^", "06 28 46"},
            {"*", "13 37  05 45  17 33"},
            {"(", "38 27 23 32"},
            {")", "18 27 23 12"},
            {"[", "28 08 02 22"},
            {"]", "08 28 22 02"},
            {"{", "28 18 16 05 14 12 22"},
            {"}", "08 18 16 25 14 12 02"},
            {"=", "04 44  06 46"},
            {"<", "47 05 43"},
            {">", "07 45 03"},
            {"\u2264", "48 06 44  02 42"},
            {"\u2265", "08 46 04  02 42"},
            {"~", "05 16 34 45"},
            {"#", "12 18  32 38  04 44  06 46"},
            {"&", "42 06 07 18 28 37 36 04 03 12 22 44"},
            {"@", "35 25 14 23 33 37 17 06 03 12 42"},
            {"$", "47 17 06 15 35 44 33 03  28 22"},
            {"!", "18 14  12 12"},
            {"?", "07 18 38 47 46 24  22 22"},
            {"'", "18 16"},
            {"`", "18 27"},
            {"\"", "08 06  28 26"},
            {"\u00b2", "07 18 27 05 25"},
            {"\u00b3", "08 28 17 26 15 05"},
            {"\u00b7", "14 15 25 24 14"},
            {"\u00b0", "17 18 28 27 17"},
            {"\u00b5", "00 06  03 12 22 34  36 33 42"},
            {"\u00d7", "03 47  07 43"}};

static const char unknown[] = "02 08 48 42 02"; /* a box */

enum { SPACE = 4, GAP = 2, MOST_POINTS = 96 };

/* The glyph of the character at `text`, and how many bytes that has. */
static const char *glyph_at(const char *text, size_t *bytes) {
  unsigned char c = (unsigned char)*text;
  *bytes = 1;
  if (isdigit(c)) return digit[c - '0'];
  if (c >= 'a' && c <= 'z') return letter[c - 'a'];
  if (c >= 'A' && c <= 'Z') return capital[c - 'A'];
  for (size_t k = 0; k < sizeof sign / sizeof *sign; k++) {
    size_t length = strlen(sign[k].character);
    if (strncmp(text, sign[k].character, length) != 0) continue;
    *bytes = length;
    return sign[k].glyph;
  }
  while (((unsigned char)text[*bytes] & 0xc0) == 0x80) ++*bytes;
  return unknown;
}

typedef struct line { /* points of a polyline */
  double at[MOST_POINTS][2];
  size_t points;
} line;

/* Reads up to where the pen is lifted; the rest of the glyph, or NULL. */
static const char *read_line(const char *g, line *l) {
  for (l->points = 0; *g && l->points < MOST_POINTS; l->points++) {
    l->at[l->points][0] = g[0] - '0', l->at[l->points][1] = g[1] - '2';
    g += 2;
    if (*g == ' ' && g[1] == ' ') return l->points++, g + 2;
    if (*g == ' ') g++;
  }
  return NULL;
}

/* Whether the line bends there by 64 degrees at most: sharper corners are meant. */
static bool is_bend(const double a[2], const double b[2], const double c[2]) {
  double ux = b[0] - a[0], uy = b[1] - a[1], vx = c[0] - b[0], vy = c[1] - b[1];
  double along = ux * vx + uy * vy, lengths = sqrt((ux * ux + uy * uy) * (vx * vx + vy * vy));
  return along >= 0.44 * lengths && along < (1 - 1e-9) * lengths;
}

static void put(line *l, const double a[2], const double b[2], double share) {
  if (l->points == MOST_POINTS) return;
  for (int c = 0; c < 2; c++) l->at[l->points][c] = a[c] + share * (b[c] - a[c]);
  l->points++;
}

/* One round of cutting corners at a quarter of their sides (Chaikin 1974), which becomes a quadratic spline. */
static void round_off(line *l) {
  line old = *l;
  size_t last = old.points - 1;
  bool closed = last > 2 && memcmp(old.at[0], old.at[last], sizeof old.at[0]) == 0;
  if (last < 1) return;
  l->points = 0;
  for (size_t k = 0; k <= last; k++) {
    bool end = k == 0 || k == last;
    const double *a = old.at[k > 0 ? k - 1 : last - 1], *b = old.at[k], *c = old.at[k < last ? k + 1 : 1];
    if ((end && !closed) || !is_bend(a, b, c)) {
      put(l, b, b, 0);
      continue;
    }
    if (k > 0) put(l, b, a, 0.25);
    if (k < last) put(l, b, c, 0.25);
  }
  if (closed) put(l, l->at[0], l->at[0], 0);
}

typedef struct pen {
  double x, y, size;
  hk_letter_stroke *stroke;
  size_t room, count;
} pen;

static void draw_line(pen *p, line *l, double left) {
  for (int k = 0; k < 2; k++) round_off(l);
  for (size_t k = 0; k + 1 < l->points || (k == 0 && l->points == 1); k++) {
    const double *a = l->at[k], *b = l->at[k + 1 < l->points ? k + 1 : k];
    if (p->count < p->room)
      p->stroke[p->count] = (hk_letter_stroke){{p->x + p->size * (a[0] - left), p->y + p->size * a[1]},
                                               {p->x + p->size * (b[0] - left), p->y + p->size * b[1]}};
    p->count++;
  }
}

/* Digits are as wide as each other; all else is as wide as it is drawn. */
static void draw_glyph(pen *p, const char *glyph, bool fixed) {
  double left = fixed ? 0 : 4, right = fixed ? 4 : 0;
  for (const char *g = glyph; *g; g += g[1] ? 2 : 1) {
    while (*g == ' ') g++;
    left = fmin(left, g[0] - '0'), right = fmax(right, g[0] - '0');
  }
  line l;
  for (const char *g = glyph; g;) {
    g = read_line(g, &l);
    draw_line(p, &l, left);
  }
  p->x += p->size * (right - left + GAP);
}

static void draw_text(pen *p, const char *text, size_t length) {
  for (const char *end = text + length; text < end;) {
    size_t bytes = 1;
    if (*text == ' ')
      p->x += p->size * SPACE;
    else
      draw_glyph(p, glyph_at(text, &bytes), isdigit((unsigned char)*text));
    text += bytes;
  }
}

static size_t finish(const pen *p, double *width) {
  *width = fmax(p->x - GAP * p->size, 0);
  return p->count < p->room ? p->count : p->room;
}

size_t hk_letters(const char *text, hk_letter_stroke *stroke, size_t room, double *width) {
  pen p = {.size = 1, .stroke = stroke, .room = room};
  draw_text(&p, text, strlen(text));
  return finish(&p, width);
}

size_t hk_letters_of_number(const char *text, hk_letter_stroke *stroke, size_t room, double *width) {
  const char *e = strchr(text, 'e'), *power = e ? e + 1 : NULL;
  pen p = {.size = 1, .stroke = stroke, .room = room};
  draw_text(&p, text, e ? (size_t)(e - text) : strlen(text));
  if (!e) return finish(&p, width);
  draw_text(&p,
            "\u00b7"
            "10",
            4);
  p.x -= 0.5, p.y = 4, p.size = 0.6;
  if (*power == '-') draw_text(&p, power, 1);
  power += strspn(power, "+-0");
  draw_text(&p, *power ? power : "0", *power ? strlen(power) : 1);
  return finish(&p, width);
}
