/* Surfaces that are flat at rest resist bending, for deformations that keep lengths: per hinge, two triangles that
 * share an edge, the energy 1/2 k |C|^2 is a quadratic function of the positions, so that the Jacobian is constant. C
 * is the jump of slope across the edge of the two triangles laid flat, C = (x_c - (1 - s) x_a - s x_b)/h_c + (x_d - (1
 * - t) x_a - t x_b)/h_d, s, t the feet and h_c, h_d the heights of c and d over the edge at rest: a vector, three
 * numbers C of an element. While lengths keep, |C| = 2 sin(theta/2), theta the angle of the hinge. k comes from numbers
 * of the material; plugins/common/shells/bending.c says how, and which plate that is. E = 1/2 x^T Q x, and Q x = 0
 * where the surface lies flat, also where it is turned, and only up to rounding: no other rest shape can be had this
 * way. When triangles are stretched by a factor the angles seem larger by it. */
#include "plugins/common/shells/bending.h"

typedef struct quadratic_bending {
  hk_bending bending; /* first member */
  hk_bending_params given;
} quadratic_bending;

/* clang-format off */
static const hk_param params[] = {
    HK_BENDING_PARAMS(quadratic_bending, given),
    {0},
};
/* clang-format on */

static void evaluate(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  const quadratic_bending *b = self;
  for (size_t k = begin; k < end; k++) {
    const uint32_t *member = hk_tuple(&b->bending.element.acting.node, k);
    const double *weight = b->bending.weight[b->bending.number[k]], *x0 = x + 3 * (size_t)member[0];
    for (int r = 0; r < 3; r++, C++, dC += 4) {
      *C = 0;
      for (int m = 0; m < 4; m++) {
        *C += weight[m] * (x[3 * (size_t)member[m] + (size_t)r] - x0[r]);
        for (int c = 0; c < 3; c++) dC[m][c] = r == c ? weight[m] : 0;
      }
    }
  }
}

static hk_status weigh(quadratic_bending *b, const hk_host *host) {
  b->bending.weight = host->allocate(host, (b->bending.count + 1) * sizeof *b->bending.weight);
  if (!b->bending.weight) return host->fail(host, HK_NO_MEMORY, "no memory for %zu hinges", b->bending.count);
  for (size_t k = 0; k < b->bending.count; k++) {
    const hk_hinge_shape *s = &b->bending.shape[k];
    double *w = b->bending.weight[k], p = s->length / (2 * s->area[0]),
           q = s->length / (2 * s->area[1]); /* 1/heights */
    w[1] = -s->foot[0] * p - s->foot[1] * q;
    w[2] = p;
    w[3] = q;
    w[0] = -w[1] - w[2] - w[3];
  }
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  quadratic_bending *b = self;
  b->bending.element = (hk_element_force){.acting = {.values = 3, .evaluate = evaluate, .self = b}};
  hk_status status = hk_bending_create(&b->bending, view, &b->given);
  return status == HK_OK ? weigh(b, host) : status;
}

static hk_status transposed(void *self, const hk_view *view, const double *u, const hk_transposed *into) {
  const quadratic_bending *b = self;
  hk_bending_transposed(&b->bending, view, &b->given, u, into);
  return HK_OK;
}

static hk_status along(void *self, const hk_view *view, const hk_tangent *directions, size_t count) {
  const quadratic_bending *b = self;
  hk_bending_along(&b->bending, view, &b->given, directions, count);
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_POWER |
             HK_SYMMETRIC_JACOBIAN,
    .add = hk_bending_add,
    .add_part = hk_bending_add_part,
    .energy = hk_bending_energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = hk_bending_pattern, .jacobian = hk_bending_jacobian,
                                          .transposed = transposed, .of_start = true, .along = along),
                        HK_BOUNDS_FACET(.stiffness_bound = hk_bending_stiffness_bound),
                        HK_ELEMENTS_FACET(.list = hk_bending_elements), HK_PARTS_FACET(.touch = hk_bending_parts)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "quadratic_bending",
    .summary = "flat surfaces resist bending, E = 1/2 k |jump of slope|^2, k from a rigidity",
    .reference =
        "Bergou, Wardetzky, Harmon, Zorin and Grinspun 2006, A quadratic bending model for inextensible surfaces",
    .instance_size = sizeof(quadratic_bending),
    .params = params,
    .create = create,
    .topology = hk_bending_topology,
    .force = &force,
};
