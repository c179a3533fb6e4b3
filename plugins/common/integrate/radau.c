/* See radau.h. Newton's form of the polynomial is B_0 + s (G_1 + (s - h_1)(G_2 + (s - h_2)(...))). Rows follow each
 * other in memory, and every loop goes along them. The tables are those of the nodes in 20 digits; the tests check them
 * by what they integrate. */
#include "plugins/common/integrate/radau.h"

enum { ROWS = HK_RADAU_ROWS };

const double hk_radau_node[ROWS] = {0,
                                    0.05626256053692214646565219,
                                    0.1802406917368923649875799,
                                    0.3526247171131696373739078,
                                    0.5471536263305553830014486,
                                    0.7342101772154105315232106,
                                    0.8853209468390957680903598,
                                    0.9775206135612875018911745};

typedef struct rows {
  const double *row[ROWS];
} rows;

static rows rows_of(const double *B, size_t length) {
  rows r;
  for (size_t j = 0; j < ROWS; j++) r.row[j] = B + j * length;
  return r;
}

/* to = from + drift + sum w_j B_j, smallest terms first; drift: rate times v, or nothing. `lost` is what rounding took
 * from `from`, with that of v behind it. */
static void sum_rows(double *restrict to, const double *restrict from, const double *restrict lost,
                     const double *restrict v, double rate, const double w[ROWS], const double *B, size_t length,
                     size_t begin, size_t count) {
  const rows r = rows_of(B + begin, length);
  const double *b0 = r.row[0], *b1 = r.row[1], *b2 = r.row[2], *b3 = r.row[3], *b4 = r.row[4], *b5 = r.row[5],
               *b6 = r.row[6], *b7 = r.row[7];
  for (size_t e = 0; e < count; e++) {
    double high = w[7] * b7[e] + w[6] * b6[e] + w[5] * b5[e] + w[4] * b4[e];
    double low = w[3] * b3[e] + w[2] * b2[e] + w[1] * b1[e] + w[0] * b0[e];
    double rest = (low + high) - lost[e];
    to[e] = from[e] + (v ? rate * v[e] + (rest - rate * lost[count + e]) : rest);
  }
}

/* Weights of B_j in v and x at s of a step h: h s^(j+1)/(j+1) and h^2 s^(j+2)/((j+1)(j+2)). */
static void weigh(double h, double s, double once[ROWS], double twice[ROWS]) {
  double reach = h * s;
  for (int j = 0; j < ROWS; j++, reach *= s) {
    once[j] = reach / (j + 1);
    twice[j] = h * s * reach / ((j + 1) * (j + 2));
  }
}

void hk_radau_place(const double *B, const hk_system *sys, double h, int k, const double *X, const double *lost,
                    double *to) {
  hk_radau_place_at(B, sys, h, hk_radau_node[k], X, lost, to);
}

double hk_radau_slope(const double *B, size_t length, size_t e, double s) {
  double sum = 0;
  for (size_t j = ROWS; j-- > 0;) sum = sum * s + B[j * length + e];
  return sum;
}

void hk_radau_place_at(const double *B, const hk_system *sys, double h, double s, const double *X, const double *lost,
                       double *to) {
  size_t m = 3 * sys->n, length = sys->size - m;
  double once[ROWS], twice[ROWS];
  weigh(h, s, once, twice);
  sum_rows(to, X, lost, X + m, h * s, twice, B, length, 0, m);
  sum_rows(to + m, X + m, lost + m, NULL, 0, once, B, length, 0, length); /* velocities, channels and work */
}

/* s (s - h_1) ... (s - h_(k-1)) in powers of s: power[k][j] belongs to s^(j+1), j < k. */
static const double power[ROWS][ROWS] = {
    {0},
    {1.0},
    {-0.056262560536922146466, 1.0},
    {0.010140802830063629986, -0.23650325227381451145, 1.0},
    {-0.0035758977292516175949, 0.093537695259462065896, -0.58912796938698414883, 1.0},
    {0.0019565654099472210769, -0.054755386889068686441, 0.41588120008230686169, -1.1362815957175395318, 1.0},
    {-0.0014365302363708915424, 0.042158527721268707707, -0.36009959650205681229, 1.2501507118406910259,
     -1.8704917729329500634, 1.0},
    {0.0012717903090268677493, -0.03876035791590677037, 0.36096224345284598323, -1.4668842084004269644,
     2.9061362593084293014, -2.7558127197720458314, 1.0}};

void hk_radau_refine(double *B, double *G, size_t length, int k, const double *slope) {
  double *restrict g = G + (size_t)(k - 1) * length, *restrict top = B + (size_t)k * length;
  for (size_t begin = 0; begin < length; begin += 64) { /* differences of a chunk stay in registers and cache */
    double change[64];
    size_t count = length - begin < 64 ? length - begin : 64;
    for (size_t e = 0; e < count; e++) change[e] = (slope[begin + e] - B[begin + e]) / hk_radau_node[k];
    for (int j = 1; j < k; j++) {
      const double *lower = G + (size_t)(j - 1) * length + begin;
      double gap = hk_radau_node[k] - hk_radau_node[j];
      for (size_t e = 0; e < count; e++) change[e] = (change[e] - lower[e]) / gap;
    }
    for (size_t e = 0; e < count; e++) {
      double found = change[e];
      change[e] = found - g[begin + e];
      g[begin + e] = found;
      top[begin + e] += change[e];
    }
    for (int j = 0; j + 1 < k; j++) {
      double *row = B + (size_t)(j + 1) * length + begin;
      for (size_t e = 0; e < count; e++) row[e] += power[k][j] * change[e];
    }
  }
}

/* From the highest power down, G_k is what is left of B_k when the products above are taken out. */
void hk_radau_divide(const double *B, size_t length, double *G) {
  for (int k = ROWS - 1; k > 0; k--) {
    double *restrict g = G + (size_t)(k - 1) * length;
    const double *restrict b = B + (size_t)k * length;
    for (size_t e = 0; e < length; e++) g[e] = b[e];
    for (int j = k + 1; j < ROWS; j++) {
      const double *above = G + (size_t)(j - 1) * length;
      for (size_t e = 0; e < length; e++) g[e] -= power[j][k - 1] * above[e];
    }
  }
}

/* Integrals of the polynomial over the whole step, in units of h and h^2. Beyond double precision, as are the products
 * with h, so that nothing is rounded but x and v, whose rounding is kept: in double precision these roundings alone are
 * twice what the forces leave in an orbit of eccentricity 0.99. */
static long double integral(const rows *r, size_t e) {
  long double sum = 0;
  for (int j = 7; j >= 0; j--) sum += (long double)r->row[j][e] / (j + 1);
  return sum;
}

static long double second_integral(const rows *r, size_t e) {
  long double sum = 0;
  for (int j = 7; j >= 0; j--) sum += (long double)r->row[j][e] / ((j + 1) * (j + 2));
  return sum;
}

/* x += d with what rounding takes kept in `lost`. */
static void add_compensated(double *x, double *lost, long double d) {
  long double y = d - *lost;
  double t = (double)(*x + y);
  *lost = (double)(((long double)t - *x) - y);
  *x = t;
}

void hk_radau_finish(const double *B, const hk_system *sys, double h, double *X, double *lost) {
  size_t m = 3 * sys->n, length = sys->size - m;
  const rows r = rows_of(B, length);
  for (size_t e = 0; e < m; e++)
    add_compensated(X + e, lost + e, h * ((long double)X[m + e] - lost[m + e] + h * second_integral(&r, e)));
  for (size_t e = 0; e < length; e++) add_compensated(X + m + e, lost + m + e, h * integral(&r, e));
}

void hk_radau_foretell(const double *last, size_t length, double q, double *B) {
  double ratio = 1, binomial[ROWS] = {1, 1, 1, 1, 1, 1, 1, 1}; /* of k over j, for k = 0 .. 7 */
  for (int j = 1; j < ROWS; j++) {
    double *restrict b = B + (size_t)j * length;
    ratio *= q;
    for (int k = ROWS - 1; k >= j; k--) binomial[k] = binomial[k] * (k - j + 1) / j;
    for (size_t e = 0; e < length; e++) b[e] = 0;
    for (int k = ROWS - 1; k >= j; k--) {
      const double *from = last + (size_t)(k - 1) * length;
      double w = ratio * binomial[k];
      for (size_t e = 0; e < length; e++) b[e] += w * from[e];
    }
  }
}
