/* How thick things are drawn where nobody says it: in pictures and on pages, which get the numbers as data. Lengths are
 * parts of the size of the motion, half the diagonal of its box. */
#ifndef HK_RADII_H
#define HK_RADII_H

enum { HK_TUBE_CLASSES = 3 };

typedef struct hk_drawn_radii {
  /* Of lines, by how many there are: radius[k] up to most[k], the last for all beyond. */
  double tube[HK_TUBE_CLASSES], most[HK_TUBE_CLASSES - 1];
  double on_tubes;              /* particles on lines, over the radius of these */
  double loose, least, largest; /* n particles without lines: loose/sqrt(n + 1) within the two */
  double pin, pin_on_tubes;     /* where there are lines: over the radius of their particles */
} hk_drawn_radii;

extern const hk_drawn_radii hk_drawn;

double hk_drawn_tube(double size, double lines);
double hk_drawn_loose(double size, double n);

#endif
