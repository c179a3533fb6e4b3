#include "plugins/common/picture/legend.h"

#include "plugins/common/lettering/lettering.h"

#include <string.h>

enum { STROKES = 4096, SEGMENTS = 96 };

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

/* `unit`: spacing of the glyphs' grid, pixels. */
static void place_text(strokes *s, const hk_letter_stroke *letter, size_t count, double x, double y, double unit) {
  for (size_t k = 0; k < count; k++)
    add_stroke(s, x + unit * letter[k].a[0], y + unit * letter[k].a[1], x + unit * letter[k].b[0],
               y + unit * letter[k].b[1], s->colour);
}

static void add_text(strokes *s, const char *text, double x, double y, double unit) {
  hk_letter_stroke letter[STROKES];
  double width;
  place_text(s, letter, hk_letters(text, letter, STROKES, &width), x, y, unit);
}

/* `align` 0: x is the left end, 0.5: the middle, 1: the right end. */
static void add_number(strokes *s, const char *text, double x, double y, double unit, double align) {
  hk_letter_stroke letter[STROKES];
  double width;
  size_t count = hk_letters_of_number(text, letter, STROKES, &width);
  place_text(s, letter, count, x - align * unit * width, y, unit);
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
  add_text(&s, name, margin, p->canvas.height - margin - 6 * unit, unit);
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
  add_text(&s, legend->label, at[0], at[1] + thickness + 5 * unit, unit);
  for (size_t k = 0; k < ticks; k++)
    add_number(&s, tick[k].text, at[0] + length * tick[k].place, at[1] - 11 * unit, unit, tick[k].align);
  hk_painter_strokes(p, s.tube, s.count, 0.42 * unit + 0.15);
}
