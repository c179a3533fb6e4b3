#include "plugins/common/picture/legend.h"

#include <ctype.h>
#include <string.h>

enum { STROKES = 1024, SEGMENTS = 96 };

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
                                      "12 32 43 47 38 18 07 03 12",
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
static const char signs[] = "-+.%/_^*()";
static const char *const sign[] = {
    "05 45",       "05 45  23 27", "12 22 23 13 12", "02 48  08 18 17 07 08  32 42 43 33 32",
    "02 48",       "01 41",        "06 28 46",       "13 37  05 45  17 33",
    "38 27 23 32", "18 27 23 12"};

static const char *glyph(int c) {
  const char *at = strchr(signs, c);
  if (isdigit(c)) return digit[c - '0'];
  if (c >= 'a' && c <= 'z') return letter[c - 'a'];
  if (c >= 'A' && c <= 'Z') return capital[c - 'A'];
  return at && *at ? sign[at - signs] : "";
}

typedef struct strokes {
  hk_tube tube[STROKES];
  size_t count;
  const uint8_t *colour;
} strokes;

static void add_stroke(strokes *s, double ax, double ay, double bx, double by, const uint8_t colour[4]) {
  if (s->count == STROKES) return;
  hk_tube *t = s->tube + s->count++;
  *t = (hk_tube){.a = {(float)ax, (float)ay, 0}, .b = {(float)bx, (float)by, 0}};
  memcpy(t->colour_a, colour, 4);
  memcpy(t->colour_b, colour, 4);
}

static double text_width(const char *text, double unit) { return unit * (6 * (double)strlen(text) - 2); }

/* `align` 0: x is the left end, 0.5: the middle, 1: the right end. `unit`: spacing of the glyphs' grid, pixels. */
static void add_text(strokes *s, const char *text, double x, double y, double unit, double align) {
  x -= align * text_width(text, unit);
  for (; *text; text++, x += 6 * unit) {
    const char *g = glyph((unsigned char)*text);
    for (; *g && g[2] != 0; g += 3) {
      if (g[2] == ' ' && g[3] == ' ') {
        g++; /* the pen is lifted: the next pair begins after two spaces */
        continue;
      }
      add_stroke(s, x + (g[0] - '0') * unit, y + (g[1] - '2') * unit, x + (g[3] - '0') * unit, y + (g[4] - '2') * unit,
                 s->colour);
    }
  }
}

/* An end beyond which numbers lie is pointed, as is usual (matplotlib's `extend`): strokes across the bar, half a pixel
 * apart, that become shorter. `side` -1: the left end, 1: the right one; `width`: half of a stroke's, pixels. */
static void add_point(strokes *s, const double end[2], int side, double thickness, double width) {
  double length = 1.3 * thickness;
  for (double x = 0; x < length; x += 0.5) {
    double half = fmax((thickness / 2) * (1 - x / length) - width / 2, 0);
    add_stroke(s, end[0] + side * x, end[1] - half, end[0] + side * x, end[1] + half, s->colour);
  }
}

static void draw_points(hk_painter *p, strokes *s, const hk_legend *legend, const double at[2], double length,
                        double thickness) {
  const uint8_t *text = s->colour;
  for (int k = 0; k < 2; k++) {
    double end[2] = {at[0] + k * length, at[1] + thickness / 2};
    for (int rim = legend->light; rim >= 0 && legend->beyond[k]; rim--) {
      s->count = 0;
      s->colour = rim ? text : legend->table[k * (HK_MAP_SIZE - 1)];
      add_point(s, end, 2 * k - 1, thickness + 2 * rim, 0.75);
      hk_painter_strokes(p, s->tube, s->count, 0.75);
    }
  }
  s->colour = text;
}

static void draw_bar(hk_painter *p, strokes *s, const hk_legend *legend, const double at[2], double length,
                     double thickness) {
  s->count = 0;
  if (legend->light) { /* a rim, or the dark end would not be seen */
    add_stroke(s, at[0] + thickness / 4, at[1] + thickness / 2, at[0] + length - thickness / 4, at[1] + thickness / 2,
               s->colour);
    hk_painter_strokes(p, s->tube, s->count, thickness / 2 + 1);
    s->count = 0;
  }
  for (int k = 0; k < SEGMENTS; k++) {
    double left = at[0] + length * k / SEGMENTS, right = at[0] + length * (k + 1) / SEGMENTS;
    double y = at[1] + thickness / 2;
    /* A stroke is longer than its ends by half its width on both sides. */
    add_stroke(s, left + thickness / 4, y, fmax(right - thickness / 4, left + thickness / 4), y,
               legend->table[k * HK_MAP_SIZE / SEGMENTS + HK_MAP_SIZE / SEGMENTS / 2]);
  }
  hk_painter_strokes(p, s->tube, s->count, thickness / 2);
}

static const uint8_t line_colour[2][4] = {{62, 68, 80, 255}, {206, 213, 222, 255}};

static bool has_room(const hk_painter *p, int pixels) {
  return p->canvas.width >= pixels && p->canvas.height >= pixels;
}

/* Small pictures have larger letters, as far as there is room: below 1.4 pixels between the points of a glyph they are
 * hard to read. */
static double unit_of(const hk_painter *p) {
  double height = p->canvas.height;
  return fmax(fmax(height / 420, fmin(height / 260, 1.4)), 1);
}

void hk_legend_name(hk_painter *p, const char *name, bool light) {
  if (!*name || !has_room(p, 120)) return;
  strokes s = {.colour = line_colour[light]};
  double unit = unit_of(p), margin = 0.04 * p->canvas.height;
  add_text(&s, name, margin, p->canvas.height - margin - 6 * unit, unit, 0);
  hk_painter_strokes(p, s.tube, s.count, 0.42 * unit + 0.15);
}

static double bar_thickness(const hk_painter *p) { return fmax(0.013 * p->canvas.height, 5); }

/* From below: a margin, the numbers, the bar, the label of 6 points. */
int hk_legend_height(const hk_painter *p) {
  double margin = 0.04 * p->canvas.height;
  return has_room(p, 200) ? (int)ceil(2 * margin + (11 + 5 + 6) * unit_of(p) + bar_thickness(p)) : 0;
}

void hk_legend_draw(hk_painter *p, const hk_legend *legend) {
  int width = p->canvas.width, height = p->canvas.height;
  if (!has_room(p, 200)) return;
  strokes s = {.colour = line_colour[legend->light]};
  hk_tick tick[HK_TICKS];
  double unit = unit_of(p), margin = 0.04 * height, advance = 6 * unit;
  double length = fmax(fmin(0.3 * height, 0.3 * width), advance * hk_scale_least(&legend->scale));
  double thickness = bar_thickness(p), at[2] = {margin, margin + 11 * unit};
  size_t ticks = hk_scale_ticks(&legend->scale, length / advance, tick);
  draw_points(p, &s, legend, at, length, thickness);
  draw_bar(p, &s, legend, at, length, thickness);
  s.count = 0;
  add_text(&s, legend->label, at[0], at[1] + thickness + 5 * unit, unit, 0);
  for (size_t k = 0; k < ticks; k++)
    add_text(&s, tick[k].text, at[0] + length * tick[k].place, at[1] - 11 * unit, unit, tick[k].align);
  hk_painter_strokes(p, s.tube, s.count, 0.42 * unit + 0.15);
}
